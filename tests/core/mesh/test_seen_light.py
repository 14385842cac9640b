"""Bark has the light and dark of the wood that a picture shows."""

import numpy as np
import pytest

from treestroke.core.appearance import StemPixels, View
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import Surface
from treestroke.core.mesh.seen_light import lit_as_seen, shaded_like
from treestroke.core.mesh.tubes import tubes
from treestroke.core.skeleton.skeleton import Skeleton

CAMERA = OrthographicCamera(100, 200, 0.05, (50.0, 195.0))
STEM = Skeleton(
    np.column_stack([0.1 * (-1.0) ** np.arange(20), np.linspace(0.0, 9.0, 20), np.zeros(20)]),
    np.full(20, 0.25),
    np.arange(-1, 19),
)
BARK = Surface(tubes(STEM), np.full((8, 8, 3), 90, dtype=np.uint8))


def view(upper: int, lower: int, shown: bool = True) -> View:
    """A stem 10 px wide, of one grey above row 100 and of another below it."""
    wood = np.zeros((200, 100), dtype=bool)
    wood[15:195, 45:55] = shown
    picture = np.full((200, 100, 3), 255, dtype=np.uint8)
    picture[:100][wood[:100]], picture[100:][wood[100:]] = upper, lower
    depth = np.where(wood, 0.0, np.inf).astype(np.float32)
    stem = StemPixels(np.array([(50.0, 195.0), (50.0, 15.0)]), np.array([5.0, 5.0]))
    return View(CAMERA, picture, depth, wood.astype(np.float32), wood, wood, stem)


def halves(surface: Surface) -> tuple[float, float]:
    """Median shade of the upper and of the lower half."""
    assert surface.mesh.shades is not None
    height = surface.mesh.positions[:, 1]
    return float(np.median(surface.mesh.shades[height > 5.5])), float(np.median(surface.mesh.shades[height < 4.0]))


def test_the_darker_half_is_darker_and_shades_only_darken() -> None:
    lit = lit_as_seen(BARK, view(60, 120))
    upper, lower = halves(lit)
    assert upper < 0.6 * lower
    assert lit.mesh.shades is not None
    assert 0 < lit.mesh.shades.min() <= lit.mesh.shades.max() <= 1
    assert lit.texture.mean() >= BARK.texture.mean()


def test_an_evenly_lit_stem_keeps_its_texture() -> None:
    lit = lit_as_seen(BARK, view(90, 90))
    assert halves(lit) == pytest.approx((1.0, 1.0), abs=0.02)
    assert np.abs(lit.texture.astype(int) - 90).max() <= 1


def test_where_no_wood_is_seen_bark_stays_as_it_is() -> None:
    assert lit_as_seen(BARK, view(60, 120, shown=False)) is BARK


def test_a_mesh_of_lower_detail_has_the_same_shades() -> None:
    lit = lit_as_seen(BARK, view(60, 120))
    again = shaded_like(tubes(STEM), lit.mesh)
    assert halves(Surface(again, lit.texture)) == pytest.approx(halves(lit), abs=0.05)
    assert shaded_like(BARK.mesh, BARK.mesh) is BARK.mesh
