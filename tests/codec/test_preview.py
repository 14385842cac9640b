import time

import numpy as np
import pytest

from treestroke.codec.preview import draw_preview
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import Mesh, Surface

CAMERA = OrthographicCamera(200, 300, 0.04, (100.0, 290.0))
GREEN = np.full((8, 8, 4), (20, 220, 30, 255), dtype=np.uint8)
BROWN = np.full((8, 8, 3), (120, 60, 30), dtype=np.uint8)


def cards(centres: np.ndarray, half: float) -> Mesh:
    """Upright squares that face the camera."""
    corner = half * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    positions = (centres[:, None] + corner).reshape(-1, 3)
    uvs = np.tile([[0, 1], [1, 1], [1, 0], [0, 0]], (len(centres), 1))
    triangles = (4 * np.arange(len(centres))[:, None, None] + [[0, 1, 2], [0, 2, 3]]).reshape(-1, 3)
    normals = np.tile([0.0, 0.0, 1.0], (len(positions), 1))
    return Mesh(*(a.astype(np.float32) for a in (positions, normals, uvs)), triangles.astype(np.uint32))


TRUNK = Surface(cards(np.array([[0.0, 2.0, 0.0]]), 0.5), BROWN)
CROWN = Surface(cards(np.array([[0.0, 8.0, 0.0]]), 2.0), GREEN)


def is_green(picture: np.ndarray) -> np.ndarray:
    red, green, blue = picture.astype(int).transpose(2, 0, 1)
    return (green > 1.5 * red) & (green > 1.5 * blue)


def test_the_front_view_stands_where_the_photo_has_the_tree() -> None:
    picture = draw_preview(TRUNK, CROWN, CAMERA)
    scale = 620 / 300
    rows, columns = np.nonzero(is_green(picture[:, : int(200 * scale)]))
    expected = CAMERA.pixels_from_world(np.array([[-2.0, 10.0, 0.0], [2.0, 6.0, 0.0]])) * scale
    assert np.allclose([[columns.min(), rows.min()], [columns.max() + 1, rows.max() + 1]], expected, atol=2)


def test_both_views_show_the_leaves() -> None:
    green = is_green(draw_preview(TRUNK, CROWN, CAMERA))
    assert green[:, :413].any()
    assert green[:, 419:].any()


def test_what_the_alpha_cuts_is_not_drawn() -> None:
    clear = Surface(CROWN.mesh, np.where(np.arange(4) == 3, 0, GREEN).astype(np.uint8))
    assert not is_green(draw_preview(TRUNK, clear, CAMERA)).any()


def test_a_bare_tree_is_drawn_without_leaves() -> None:
    picture = draw_preview(TRUNK, None, CAMERA)
    assert picture.dtype == np.uint8
    assert picture.shape[0] == 620


def test_shades_darken() -> None:
    dark = Mesh(
        CROWN.mesh.positions, CROWN.mesh.normals, CROWN.mesh.uvs, CROWN.mesh.triangles, np.full(4, 0.3, np.float32)
    )
    bright, shaded = (draw_preview(TRUNK, Surface(mesh, GREEN), CAMERA) for mesh in (CROWN.mesh, dark))
    assert shaded[150, 206, 1] < 0.8 * bright[150, 206, 1]


def test_the_same_tree_gives_the_same_picture() -> None:
    assert np.array_equal(draw_preview(TRUNK, CROWN, CAMERA), draw_preview(TRUNK, CROWN, CAMERA))


@pytest.mark.parametrize(("width", "height"), [(4000, 64), (64, 4000)])
def test_a_very_wide_or_tall_photo_keeps_its_root_in_the_picture(width: int, height: int) -> None:
    camera = OrthographicCamera(width, height, 12.0 / height, (width / 2, height - 1.0))
    picture = draw_preview(TRUNK, CROWN, camera)
    assert picture.shape[1] < 2000
    assert is_green(picture[:, :300]).any() or is_green(picture[:, :930]).any()


def test_a_full_tree_is_drawn_within_seconds() -> None:
    rng = np.random.default_rng(0)
    leaves = Surface(cards(rng.normal((0, 7, 0), (1.5, 1.2, 1.5), (25_000, 3)), 0.1), GREEN)
    start = time.process_time()
    draw_preview(TRUNK, leaves, CAMERA)
    assert time.process_time() - start < 5.0
