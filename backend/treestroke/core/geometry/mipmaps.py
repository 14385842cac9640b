"""Mipmaps: the copies of a texture, each half as large, that a viewer reads where the texture is drawn small."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import ALPHA_CUT, Surface
from treestroke.core.geometry.raster import planes
from treestroke.core.types import Floats, Indices


class MipLevels:
    """The mipmap level of each triangle, by the size at which it is drawn, and the texels that it shows."""

    def __init__(self, surface: Surface, corners_px: Floats) -> None:
        """Choose the levels for triangles drawn at corners (t, 3, 2), px."""
        height, width, channels = surface.texture.shape
        self.repeats = channels == 3
        uvs = surface.mesh.uvs[surface.mesh.triangles].astype(np.float64)
        self.coordinates = planes(corners_px, uvs * (width, height))
        steps = [np.hypot(*along) for along in (self.coordinates.along_x, self.coordinates.along_y)]
        count = int(np.log2(min(height, width))) + 1
        level = np.rint(np.log2(np.maximum(np.maximum(*steps), 1e-9))).astype(np.int64)
        self.level = np.clip(level, 0, count - 1)
        self.sizes = np.array([(height >> step, width >> step) for step in range(count)])
        self.start = np.cumsum(np.append(0, self.sizes.prod(axis=1)))

    def texels(self, triangle: Indices, x: Floats, y: Floats) -> Indices:
        """Find the row index (m,) in `mip_texels` that points x, y (m,), px, of triangles with index (m,) show."""
        level = self.level[triangle]
        u, v = self.coordinates.at(triangle, x, y)
        height, width = self.sizes[level].T
        column, row = np.floor(u).astype(np.int64) >> level, np.floor(v).astype(np.int64) >> level
        if self.repeats:
            column, row = column % width, row % height
        else:
            column, row = np.clip(column, 0, width - 1), np.clip(row, 0, height - 1)
        return np.asarray(self.start[level] + row * width + column)


def mip_texels(pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    """Average pixels (h, w, c), any unit, sides powers of two, to half the size until a side is 1: all texels (n, c).

    Notes
    -----
    Williams, "Pyramidal Parametrics", 1983.
    """
    copies = [pixels]
    while min(copies[-1].shape[:2]) > 1:
        last = copies[-1]
        fourfold = last[::2, ::2] + last[1::2, ::2] + last[::2, 1::2] + last[1::2, 1::2]
        copies.append(fourfold / np.float32(4))
    return np.concatenate([copy.reshape(-1, pixels.shape[2]) for copy in copies])


class Cutout:
    """Alpha test at `ALPHA_CUT` of textured triangles, at the size at which they are drawn."""

    def __init__(self, surface: Surface, corners_px: Floats) -> None:
        """Prepare the test for triangles drawn at corners (t, 3, 2), px."""
        self.levels = None if surface.texture.shape[2] == 3 else MipLevels(surface, corners_px)
        if self.levels is not None:
            self.opaque = mip_texels(surface.texture[:, :, 3:].astype(np.float32))[:, 0] >= 255 * ALPHA_CUT

    def __call__(self, triangle: Indices, x: Floats, y: Floats) -> NDArray[np.bool_]:
        """Return the mask (m,) of the points x, y, px, of triangles with index (m,) that pass."""
        if self.levels is None:
            return np.ones(len(triangle), dtype=bool)
        return np.asarray(self.opaque[self.levels.texels(triangle, x, y)])
