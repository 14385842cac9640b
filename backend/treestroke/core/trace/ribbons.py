"""Ribbons of wood in a photo: the centre lines of what has the colours of branches and their shape.

Colour alone takes shade among leaves for wood. A limb is a ribbon: wood along a straight piece of its centre line, and
none on either side of it.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.trace.centre_lines import thin
from treestroke.core.types import Floats, Indices, Mask

SURE = 1.0
"""Log odds, averaged over the grain of bark, that every piece of wood reaches somewhere."""
SHORTEST = 0.008
"""Least length of a piece of wood, as a share of the tree's height."""
ELONGATION = 4.0
"""Least length of a piece of wood, in mean widths."""
AHEAD, AHEAD_PX = 2.5, 6.0
"""How far ahead and behind a place a ribbon is followed, in half widths and at least so many px."""
BESIDE, BESIDE_PX = 1.3, 2.0
"""How far beside its centre line a ribbon must have ended, in half widths plus px."""
AROUND_PX = 6
"""Distance along both axes over which clearness is averaged, px."""
TYPICAL = 0.25
"""Clearness of most limbs: 1 where wood is seen all along a ribbon and none beside it."""
CLEAR = ((0.05, 0.5, 0.06), (0.1, 0.25, 0.03), (0.3, -0.1, 0.0))
"""By the share of wood-coloured lines that are so clear: how clear a ribbon must be, and how long, in tree heights.

Where hardly any is, that is shade, and only long, clear ribbons are limbs (at most 0.1 on 12 photos of dense crowns);
where much is, the colour can be trusted at forks and in short pieces, too (0.18 to 0.88 on 16 synthetic trees).
"""
_THICK_PX, _NEAR_PX, _FAR_PX = 3.5, 8, 16
"""Half width from which a ribbon's direction is measured over the second distance and not over the first, px."""


@dataclass(frozen=True, eq=False)
class Ribbons:
    """Centre lines one pixel wide: pixels (n, 2) as row and column, and half widths (n,) of the wood there, px."""

    pixels: Indices
    half_widths: Floats

    @property
    def points(self) -> Floats:
        """The middles (n, 2) of the pixels, px."""
        return self.pixels[:, ::-1].astype(np.float64) + 0.5


def find_ribbons(
    odds: NDArray[np.float32], smooth: NDArray[np.float32], crown: Mask, height_px: float
) -> tuple[Ribbons, bool]:
    """Find the ribbons of wood inside a crown (h, w) of a tree ``height_px`` high, and tell whether colours show them.

    Wood is told by log odds (h, w), as they are and averaged over the grain of bark (``smooth``).
    """
    wood = crown & ((odds > 0) | (smooth > 0))
    count, labels = cv2.connectedComponents(wood.astype(np.uint8), connectivity=8)
    area, shortest = np.bincount(labels.reshape(-1), minlength=count), SHORTEST * height_px
    sure = np.zeros(count, dtype=bool)
    sure[labels[wood & (smooth > SURE)]] = True
    sure &= area > shortest
    wood &= sure[labels]
    lines = thin(wood)
    length = np.bincount(labels[lines], minlength=count)
    lines &= ((length > shortest) & (length**2 > ELONGATION * area))[labels]
    inward = cv2.distanceTransform(wood.astype(np.uint8), cv2.DIST_L2, 5)
    found = Ribbons(np.argwhere(lines), np.maximum(inward[lines].astype(np.float64) - 0.5, 0.5))
    return _clear(found, smooth, height_px) if len(found.pixels) else (found, False)


def headings(ribbons: Ribbons, reach_px: int) -> Floats:
    """Return the unit direction (n, 2) of the centre lines around each pixel, by their second moments."""
    lines, at = _drawn(ribbons)
    y, x = np.arange(lines.shape[0])[:, None], np.arange(lines.shape[1])[None]

    def around(values: Floats) -> Floats:
        return np.asarray(_sums(values, reach_px)[at])

    n, sum_x, sum_y = around(lines), around(lines * x), around(lines * y)
    xx, yy = around(lines * x * x) - sum_x**2 / n, around(lines * y * y) - sum_y**2 / n
    xy = around(lines * x * y) - sum_x * sum_y / n
    angle = 0.5 * np.arctan2(2 * xy, xx - yy)
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _clear(ribbons: Ribbons, smooth: NDArray[np.float32], height_px: float) -> tuple[Ribbons, bool]:
    """Keep the clear and long parts of ribbons, by `CLEAR`; the more of all is clear, the less is asked of each.

    Tell, too, whether so much is clear that colours show limbs.
    """
    lines, at = _drawn(ribbons)
    count = _sums(lines, AROUND_PX)[at]
    lines[at] = _clearness(ribbons, smooth)
    clearness = _sums(lines, AROUND_PX)[at] / count
    shares, least, lengths = np.transpose(CLEAR)
    share = (clearness > TYPICAL).mean()
    clear = clearness > np.interp(share, shares, least)
    lines[:] = 0.0
    lines[tuple(part[clear] for part in at)] = 1.0
    _, labels = cv2.connectedComponents(lines.astype(np.uint8), connectivity=8)
    clear &= np.bincount(labels.ravel())[labels[at]] > height_px * np.interp(share, shares, lengths)
    return Ribbons(ribbons.pixels[clear], ribbons.half_widths[clear]), bool(share >= shares[-1])


def _clearness(ribbons: Ribbons, smooth: NDArray[np.float32]) -> Floats:
    """Return how clear (n,) ribbons are at each pixel, -1 to 1, by log odds (h, w) along them and on both sides."""
    half = ribbons.half_widths[:, None]
    along = np.where(half > _THICK_PX, headings(ribbons, _FAR_PX), headings(ribbons, _NEAR_PX))
    beside = (BESIDE * half + BESIDE_PX) * np.column_stack([-along[:, 1], along[:, 0]])
    steps = np.linspace(-1.0, 1.0, 9)[:, None, None] * np.maximum(AHEAD_PX, AHEAD * half) * along
    seen = np.clip(smooth, -1.0, 1.0)
    on, left, right = (
        sample_nearest(seen, ribbons.points + steps + side * beside, -1.0).mean(axis=0) for side in (0, -1, 1)
    )
    return np.asarray((on - np.maximum(left, right)) / 2)


def _drawn(ribbons: Ribbons) -> tuple[Floats, tuple[Indices, ...]]:
    """Return a picture (h, w) of the centre lines, as large as they need, and where it has their pixels."""
    low = ribbons.pixels.min(axis=0)
    at = tuple((ribbons.pixels - low).T)
    lines = np.zeros(ribbons.pixels.max(axis=0) - low + 1, dtype=np.float64)
    lines[at] = 1.0
    return lines, at


def _sums(values: Floats, reach_px: int) -> Floats:
    """Return the sum of values (h, w) over the square around each place."""
    size = (2 * reach_px + 1, 2 * reach_px + 1)
    return np.asarray(cv2.boxFilter(values, cv2.CV_64F, size, normalize=False, borderType=cv2.BORDER_CONSTANT))
