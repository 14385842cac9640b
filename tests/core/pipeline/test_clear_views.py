import numpy as np
import pytest

from treestroke.core.appearance import Appearance, StemPixels, View
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.imaging.light import LEAST_LIGHTNESS, LIT
from treestroke.core.paint.palette import lab_from_rgb
from treestroke.core.pipeline.clear_views import clear_views


def view_of(photo: np.ndarray, opacity: np.ndarray, wood: np.ndarray) -> View:
    """A view whose foliage is half covered at least, and that shows wood beside it."""
    foliage = (opacity >= 0.5) & ~wood
    depth = np.where(foliage, -np.inf, np.inf).astype(np.float32)
    camera = OrthographicCamera(300, 400, 10 / 360, (150.0, 390.0))
    stem = StemPixels(np.array([[150.0, 390.0], [150.0, 280.0]]), np.full(2, 8.0))
    return View(camera, photo, depth, opacity, foliage, foliage | wood, stem)


@pytest.fixture
def wood(mask: np.ndarray) -> np.ndarray:
    row, column = np.indices(mask.shape)
    return (np.abs(column - 150) < 8) & (row > 260) & (row < 390)


def test_leaves_before_the_sky_lose_its_blue(photo, mask, wood):
    opacity = np.where(np.indices(mask.shape)[1] % 4 < 2, 1.0, 0.6).astype(np.float32) * mask
    share = opacity[..., None]
    mixed = (share * photo + (1 - share) * np.array([110, 160, 230])).astype(np.uint8)
    thin = mask & (opacity < 1)
    clear = clear_views(Appearance((view_of(mixed, opacity, wood),), True), "photo").views[0].picture
    own, before, after = (lab_from_rgb(picture[thin]).mean(axis=0) for picture in (photo, mixed, clear))
    assert before[2] < own[2] - 15
    assert after[2] == pytest.approx(own[2], abs=5)


def test_a_tree_at_dusk_can_be_seen_its_wood_by_the_same_gain(photo, mask, wood):
    photo = photo.copy()
    photo[wood] = (90, 70, 60)
    dark = (photo * 0.25).astype(np.uint8)
    clear = clear_views(Appearance((view_of(dark, mask.astype(np.float32), wood),), True), "photo").views[0].picture
    assert np.quantile(lab_from_rgb(clear[mask | wood])[:, 0], LIT) == pytest.approx(LEAST_LIGHTNESS, abs=2)
    gains = [clear[part].mean() / dark[part].mean() for part in (mask, wood)]
    assert gains[1] == pytest.approx(gains[0], rel=0.2)


def test_even_light_has_no_sunny_side(photo, mask, wood):
    sun = np.linspace(0.5, 1.3, 300)[None, :, None]
    lit = np.clip(photo * sun, 0, 255).astype(np.uint8)
    appearance = Appearance((view_of(lit, mask.astype(np.float32), wood),), True)
    spread = {}
    for light in ("photo", "even"):
        clear = lab_from_rgb(clear_views(appearance, light).views[0].picture)[..., 0]
        spread[light] = clear[:, 180:][mask[:, 180:]].mean() - clear[:, :120][mask[:, :120]].mean()
    assert spread["photo"] > 12
    assert abs(spread["even"]) < 3
