import numpy as np
import pytest

from treestroke.core.geometry.mesh import Mesh, Surface
from treestroke.core.geometry.mipmaps import MipLevels, mip_texels


def square(channels: int, reach: float = 1.0) -> Surface:
    """Lay an 8 x 8 texture ``reach`` times over a square of 1 m."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    uvs = corners[:, :2] * np.float32(reach)
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    texture = np.zeros((8, 8, channels), np.uint8)
    return Surface(Mesh(corners, np.tile(np.array([0, 0, 1], np.float32), (4, 1)), uvs, triangles), texture)


def texel(surface: Surface, side_px: float, x: float, y: float) -> int:
    corners_px = surface.mesh.positions[surface.mesh.triangles][..., :2].astype(np.float64) * side_px
    triangle = np.array([0 if x > y else 1])
    return int(MipLevels(surface, corners_px).texels(triangle, np.array([x]), np.array([y]))[0])


def test_mipmap_levels_follow_each_other_down_to_one_texel() -> None:
    pixels = np.random.default_rng(0).random((8, 8, 2)).astype(np.float32)
    copies = mip_texels(pixels)
    assert len(copies) == 64 + 16 + 4 + 1
    assert copies[64] == pytest.approx(pixels[:2, :2].mean(axis=(0, 1)))
    assert copies[-1] == pytest.approx(pixels.mean(axis=(0, 1)))


@pytest.mark.parametrize(("side_px", "wanted"), [(8.0, 3 * 8 + 5), (4.0, 64 + 1 * 4 + 2), (1.0, 84)])
def test_the_mipmap_level_fits_the_size_on_the_picture(side_px: float, wanted: int) -> None:
    assert texel(square(4), side_px, 5.5 / 8 * side_px, 3.5 / 8 * side_px) == wanted


def test_an_opaque_texture_repeats_and_one_with_alpha_ends() -> None:
    assert texel(square(3, reach=2.0), 16.0, 13.5, 3.5) == 3 * 8 + 5
    assert texel(square(4, reach=2.0), 16.0, 13.5, 3.5) == 3 * 8 + 7
