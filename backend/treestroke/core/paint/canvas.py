"""The square canvas that a spray is painted on."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.paint.palette import rgb_from_lab
from treestroke.core.types import Floats, Indices, Mask, Picture

MARGIN = 0.035
"""Width of the transparent border, a share of the canvas's side: keeps mip levels of neighbouring tiles apart."""
SUBPIXEL_BITS = 4
"""cv2 draws at 1/16 px."""
SHADES = np.array([-14.0, -7.0, -3.0, 0.0, 3.0, 7.0])
"""Lightness added to a piece's colour, CIE Lab, for each shade: heart, edge, dark half, plain, light half, midrib."""
HEART, EDGE, DARK, PLAIN, LIGHT, RIB = range(6)
LIGHT_SCATTER = 4.0
"""Standard deviation of lightness between pieces, CIE Lab: each leaf faces the light at its own angle."""
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
"""Step of a sequence that fills 0 to 1 evenly from its beginning on."""
FULL = 0.52
"""Share of the canvas that leaves cover when a spray is complete."""


class Canvas:
    """A square canvas of twice a tile's side; positions on it are 0 to 1, x right, y down.

    ``paints`` (p, 6, 3) sRGB holds a colour for each piece (a leaf, needle or flower), drawn from the photo's pixels,
    in the shades of SHADES. The transparent ground has the mean colour, so that edges and mip levels show no halo.
    """

    def __init__(self, side: int, colours: Floats, pieces: int, rng: np.random.Generator) -> None:
        """Prepare a canvas for a tile ``side`` px wide and paints for the pieces, from colours (m, 3), CIE Lab."""
        self.side = 2 * side
        mean = colours.mean(axis=0)
        picked = _light_and_dark(colours, pieces, rng)
        picked[:, 0] += rng.normal(0, LIGHT_SCATTER, pieces)
        self.paints = rgb_from_lab(picked[:, None, :] + SHADES[:, None] * np.array([1.0, 0.0, 0.0]))
        wood = np.array([0.6 * mean[0], 0.5 * mean[1] + 4.0, 0.5 * mean[2] + 6.0])
        ground, self.wood = rgb_from_lab(np.stack([mean, wood]))
        pixel = np.array([*ground.tolist(), 0], dtype=np.uint8).view(np.uint32)
        self.pixels = np.full((self.side, self.side), pixel).view(np.uint8).reshape(self.side, self.side, 4)

    def _fixed_point(self, points: Floats) -> NDArray[np.int32]:
        """Convert points (..., 2) to cv2's fixed-point pixels."""
        return np.asarray(np.rint(points * (self.side << SUBPIXEL_BITS)), dtype=np.int32)

    def polygon(self, points: Floats, paint: Picture) -> None:
        """Fill a polygon (n, 2), shares of the side, with a colour (3,), sRGB."""
        colour = (*paint.tolist(), 255)
        cv2.fillPoly(self.pixels, [self._fixed_point(points)], colour, cv2.LINE_8, SUBPIXEL_BITS)

    def lines(self, polylines: Floats, paint: Picture, width: float) -> None:
        """Draw m polylines of n points (m, n, 2) in a colour (3,), sRGB; points and width are shares of the side."""
        colour, thickness = (*paint.tolist(), 255), max(1, round(width * self.side))
        lines = list(self._fixed_point(polylines))
        cv2.polylines(self.pixels, lines, False, colour, thickness, cv2.LINE_8, SUBPIXEL_BITS)

    def cells(self, points: Floats) -> Indices:
        """Flat pixel indices (...,) of points (..., 2), shares of the side, that lie on the canvas."""
        column_row = (points * self.side).astype(np.int64)
        return np.asarray(column_row[..., 1] * self.side + column_row[..., 0])

    def painted_share(self, cells: Indices) -> float:
        """Share, 0 to 1, of the pixels with these flat indices (...,) that are painted."""
        return float(np.count_nonzero(self.pixels.reshape(-1, 4)[cells, 3])) / cells.size

    def is_full(self) -> bool:
        """Tell whether leaves cover enough of the canvas (judged on every fourth row and column)."""
        return float(np.count_nonzero(self.pixels[::4, ::4, 3])) * 16 / self.side**2 >= FULL

    def tile(self) -> Picture:
        """Shrink the canvas to its tile (side, side, 4), sRGB with straight alpha, with a transparent margin."""
        half = (self.side // 2, self.side // 2)
        tile = np.asarray(cv2.resize(self.pixels, half, interpolation=cv2.INTER_AREA), dtype=np.uint8)
        edge = round(MARGIN * half[0])
        for border in (tile[:edge], tile[-edge:], tile[:, :edge], tile[:, -edge:]):
            border[..., 3] = 0
        return tile


def _light_and_dark(colours: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Choose ``count`` of the colours (m, 3), CIE Lab: light and dark ones more often than those between.

    Part of the contrast between pieces is lost when they are seen a few pixels wide and turned aside. Any few pieces
    in a row have the whole range (ranks by lightness follow a golden-ratio sequence), so that the mean stays.
    """
    even = (rng.random() + GOLDEN * np.arange(count)) % 1.0
    rank = np.sin(0.5 * np.pi * even) ** 2  # the arcsine distribution
    order = np.argsort(colours[:, 0], kind="stable")
    return np.asarray(colours[order[np.minimum(rank * len(colours), len(colours) - 1).astype(np.int64)]])


def fits_canvas(pieces: Floats) -> Mask:
    """Tell which pieces, as points (p, n, 2) in shares of the side, lie wholly within the margin (p,).

    The area that a spray may fill is a superellipse of degree 3, so that its corners are round.
    """
    reach = np.abs(pieces - 0.5) * 2
    return np.asarray((reach**3).sum(axis=2).max(axis=1) <= (1 - 2 * MARGIN) ** 3)
