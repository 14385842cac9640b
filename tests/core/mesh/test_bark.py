import cv2
import numpy as np
import pytest

from treestroke.core.appearance import StemPixels
from treestroke.core.mesh.bark import TEXTURE_SIZE, BarkParams, bark_texture
from treestroke.core.mesh.bark_pattern import BarkForm, bark_pattern

BROWN = np.array([120.0, 90.0, 70.0])


def photo_of_a_trunk(radius: float, shaded: bool = False, seed: int = 0) -> np.ndarray:
    """A brown, rough trunk around x = 150 before a green lawn, 300 x 400."""
    rng = np.random.default_rng(seed)
    photo = np.tile(np.array([60.0, 150.0, 40.0]), (400, 300, 1))
    x = (np.arange(300) + 0.5 - 150.0) / radius
    bark = BROWN * (1.0 + 0.15 * rng.standard_normal((400, 300, 1)))
    light = np.clip(1.0 - 0.6 * x, 0.3, 1.7)[None, :, None] if shaded else 1.0
    trunk = np.abs(x) < 1
    photo[:, trunk] = (bark * light)[:, trunk]
    return np.clip(photo, 0, 255).astype(np.uint8)


def texture_of(photo: np.ndarray, radius: float) -> np.ndarray:
    trunk = np.array([[150.0, 390.0], [150.0, 200.0], [150.0, 20.0]])
    return bark_texture(photo, StemPixels(trunk, np.full(3, radius)), BarkParams(), np.random.default_rng(0))


@pytest.mark.parametrize("radius", [5.0, 20.0, 60.0])
def test_bark_has_the_trunk_s_mean_colour(radius: float) -> None:
    texture = texture_of(photo_of_a_trunk(radius), radius)
    assert texture.shape == (*TEXTURE_SIZE, 3)
    assert texture.reshape(-1, 3).mean(axis=0) == pytest.approx(BROWN, rel=0.08)


def test_the_light_of_a_lit_side_is_taken_out() -> None:
    texture = texture_of(photo_of_a_trunk(40.0, shaded=True), 40.0).astype(np.float64)
    halves = texture[:, :128].mean(), texture[:, 128:].mean()
    assert halves[0] == pytest.approx(halves[1], rel=0.1)


def test_bark_repeats_without_seam() -> None:
    grey = texture_of(photo_of_a_trunk(30.0), 30.0).astype(np.float64).mean(axis=2)
    for lines in (grey, grey.T):
        step = np.abs(np.diff(lines, axis=0)).mean(axis=1)
        assert np.abs(lines[0] - lines[-1]).mean() < 1.5 * step.max()


def test_leaves_before_the_trunk_do_not_colour_it() -> None:
    photo = photo_of_a_trunk(30.0)
    for x, y in ((140, 80), (160, 140), (150, 60)):
        cv2.circle(photo, (x, y), 12, (60, 170, 40), -1)
    texture = texture_of(photo, 30.0).reshape(-1, 3).astype(np.float64)
    assert (texture[:, 1] > texture[:, 0]).mean() < 0.02


def test_a_thin_trunk_gets_fissures_finer_than_a_photo_pixel() -> None:
    smooth = cv2.GaussianBlur(photo_of_a_trunk(6.0), (0, 0), 2.0)
    grey = texture_of(smooth, 6.0).astype(np.float64).mean(axis=2)
    assert grey.std() > 0.1 * grey.mean()
    assert np.abs(np.diff(grey, axis=1)).mean() > 1.0


def test_a_hidden_trunk_is_procedural_in_the_given_colour() -> None:
    photo = photo_of_a_trunk(30.0)
    stem = StemPixels(np.array([[150.0, 390.0], [150.0, 20.0]]), np.zeros(2))
    hidden = bark_texture(photo, stem, BarkParams(), np.random.default_rng(0))
    assert hidden.reshape(-1, 3).mean(axis=0) == pytest.approx(BarkParams().hidden_colour, rel=0.06)
    assert hidden.std() > 5


def test_a_silhouette_is_lifted_from_black() -> None:
    texture = texture_of(np.full((400, 300, 3), 3, np.uint8), 30.0)
    assert 30 < texture.mean() < 60


def test_equal_seeds_give_equal_bark() -> None:
    photo = photo_of_a_trunk(30.0)
    assert np.array_equal(texture_of(photo, 30.0), texture_of(photo, 30.0))


def test_a_trunk_at_the_photo_s_edge_is_read_without_a_stop() -> None:
    photo = photo_of_a_trunk(30.0)
    edge = np.array([[1.0, 405.0], [-3.0, 200.0]])
    assert bark_texture(photo, StemPixels(edge, np.full(2, 30.0)), BarkParams(), np.random.default_rng(0)).shape == (
        512,
        256,
        3,
    )


def test_a_long_trunk_that_is_seen_at_its_tip_alone_gets_the_hidden_colour() -> None:
    trunk, radii = np.array([[150.0, 390.0], [150.0, 200.0], [150.0, 20.0]]), np.array([0.0, 0.0, 2.5])
    texture = bark_texture(photo_of_a_trunk(2.5), StemPixels(trunk, radii), BarkParams(), np.random.default_rng(0))
    assert texture.reshape(-1, 3).mean(axis=0) == pytest.approx(np.array(BarkParams().hidden_colour), rel=0.1)


def test_a_known_form_shapes_the_bark_of_a_hidden_trunk_and_mildly_that_of_a_seen_one() -> None:
    trunk = np.array([[150.0, 390.0], [150.0, 200.0], [150.0, 20.0]])
    plates = bark_pattern(TEXTURE_SIZE, np.random.default_rng(5), "plated")

    def similarity(radius: float) -> float:
        params, rng = BarkParams(form="plated"), np.random.default_rng(0)
        texture = bark_texture(photo_of_a_trunk(30.0), StemPixels(trunk, np.full(3, radius)), params, rng, plates)
        return float(np.corrcoef(texture.mean(axis=2).ravel(), plates.ravel())[0, 1])

    assert similarity(0.0) > 0.9
    assert 0.15 < similarity(30.0) < 0.7


def test_smooth_bark_has_less_contrast_than_furrowed() -> None:
    def contrast(form: BarkForm) -> float:
        trunk, params = np.array([[150.0, 390.0], [150.0, 20.0]]), BarkParams(form=form)
        texture = bark_texture(photo_of_a_trunk(30.0), StemPixels(trunk, np.zeros(2)), params, np.random.default_rng(0))
        return float(texture.mean(axis=2).std())

    assert contrast("smooth") < 0.5 * contrast("furrowed")
