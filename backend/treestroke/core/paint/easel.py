"""What sprays are painted on."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.paint.palette import rgb_from_lab
from treestroke.core.types import Floats, Indices, Picture

MARGIN = 0.035
"""Transparent border, share of the square's side, so that mip levels of neighbours do not mix."""
SUBPIXEL_BITS = 4
"""cv2 draws at 1/16 px."""
SHADES = np.array([-14.0, -7.0, -3.0, 0.0, 3.0, 7.0])
"""Lightness steps, CIE Lab, that one piece is painted in: heart, edge, dark half, plain, light half, midrib."""
HEART, EDGE, DARK, PLAIN, LIGHT, RIB = range(6)
LIGHT_SCATTER = 4.0
"""Standard deviation of the pieces' lightness, CIE Lab: leaves turn to the light each in its own way."""
FULL = 0.52
"""Share of the square at which a spray has leaves enough."""


class Easel:
    """A square canvas drawn at twice its size; positions are 0 to 1, x right, y down.

    Holds the paints (p, 6, 3): one pixel of the photo a piece, in the six steps of SHADES. The clear ground has
    the mean colour, so that edges and mip levels show no halo.
    """

    def __init__(self, side: int, members: Floats, pieces: int, rng: np.random.Generator) -> None:
        self.side = 2 * side
        mean = members.mean(axis=0)
        picked = 0.7 * members[rng.integers(len(members), size=pieces)] + 0.3 * mean
        picked[:, 0] += rng.normal(0, LIGHT_SCATTER, pieces)
        self.paints = rgb_from_lab(picked[:, None, :] + SHADES[:, None] * np.array([1.0, 0.0, 0.0]))
        wood = np.array([0.6 * mean[0], 0.5 * mean[1] + 4.0, 0.5 * mean[2] + 6.0])
        ground, self.wood = rgb_from_lab(np.stack([mean, wood]))
        self.canvas = np.empty((self.side, self.side, 4), dtype=np.uint8)
        self.canvas[:] = (*ground.tolist(), 0)

    def _corners(self, points: Floats) -> NDArray[np.int32]:
        """Points (..., 2) in cv2's fixed point."""
        return np.asarray(np.rint(points * (self.side << SUBPIXEL_BITS)), dtype=np.int32)

    def polygon(self, points: Floats, paint: Picture) -> None:
        """Fill a polygon (n, 2)."""
        cv2.fillPoly(self.canvas, [self._corners(points)], (*paint.tolist(), 255), cv2.LINE_8, SUBPIXEL_BITS)

    def lines(self, polylines: Floats, paint: Picture, width: float) -> None:
        """Draw polylines (m, n, 2), their width a share of the square's side."""
        colour, thickness = (*paint.tolist(), 255), max(1, round(width * self.side))
        cv2.polylines(self.canvas, list(self._corners(polylines)), False, colour, thickness, cv2.LINE_8, SUBPIXEL_BITS)

    def cells(self, points: Floats) -> Indices:
        """Canvas cells of points (..., 2), which lie inside the square."""
        column_row = (points * self.side).astype(np.int64)
        return np.asarray(column_row[..., 1] * self.side + column_row[..., 0])

    def taken(self, cells: Indices) -> float:
        """Share of the cells that are painted already."""
        return float(np.count_nonzero(self.canvas.reshape(-1, 4)[cells, 3])) / cells.size

    def is_full(self) -> bool:
        """Tell whether a spray has leaves enough."""
        return float(np.count_nonzero(self.canvas[::4, ::4, 3])) * 16 / self.side**2 >= FULL

    def tile(self) -> Picture:
        """Shrink to (side, side, 4), straight alpha, the margin clear."""
        half = (self.side // 2, self.side // 2)
        tile = np.asarray(cv2.resize(self.canvas, half, interpolation=cv2.INTER_AREA), dtype=np.uint8)
        edge = round(MARGIN * half[0])
        for border in (tile[:edge], tile[-edge:], tile[:, :edge], tile[:, -edge:]):
            border[..., 3] = 0
        return tile


def inside(points: Floats) -> NDArray[np.bool_]:
    """Which pieces (p, n, 2) lie wholly in the rounded square that a spray fills (p,)."""
    reach = np.abs(points - 0.5) * 2
    return np.asarray((reach**3).sum(axis=2).max(axis=1) <= (1 - 2 * MARGIN) ** 3)
