"""Measures which part of the foliage cards hide, by the outlines of their tiles."""

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.types import Floats, Indices

try:
    from treestroke.core.leaf._covering import lower
except ImportError:
    from treestroke.core.leaf.plain_covering import lower

LATTICES = (4, 8, 16, 32, 64)
"""Dots along a tile's side, from the smallest cards to the largest: each card is sampled at about one dot per cell."""
SURE_SHARE = 0.8
"""Mean alpha, 0 to 1, of the part of a tile around a dot from which on the dot hides what is behind it. Tuned with ten
trees, half of them conifers; lower ones (0.5) leave gaps between needles, which are narrower than a cell."""
PROBED = 16
"""Dots along a tile's side among which the probes are chosen."""
PROBES = 24
"""Dots of a tile that are tested against the foliage's outline."""

_Dots = NDArray[np.float32]
Depths = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Outlines:
    """The dots of the atlas's tiles that hide what is behind, in half-extents of a card: x right, y up, -1 to 1.

    Attributes
    ----------
    dots
        For each of `LATTICES`, k arrays (n, 2): all dots.
    probes
        (k, PROBES, 2) some of them, spread over the tile.
    fold
        How far cards are folded (`treestroke.core.paint.atlas.Atlas`).
    """

    dots: tuple[tuple[_Dots, ...], ...]
    probes: _Dots
    fold: float

    @cached_property
    def every_dot(self) -> _Dots:
        """All dots (n, 2), of one tile after another on one lattice after another."""
        return np.concatenate([dots for tiles in self.dots for dots in tiles])

    @cached_property
    def starts(self) -> Indices:
        """The first dot of each tile on each lattice, then their number."""
        return np.cumsum([0, *(len(dots) for tiles in self.dots for dots in tiles)])


def outlines_of(alphas: NDArray[np.uint8], fold: float = 0.0, sure: float = SURE_SHARE) -> Outlines:
    """Find the dots of tiles (k, side, side) of alpha, on cards that are folded so far.

    Around a dot the tile's mean alpha is ``sure``, 0 to 1, or more.
    """
    dots = tuple(tuple(_hiding_dots(alpha, side, sure) for alpha in alphas) for side in LATTICES)
    probed = dots[LATTICES.index(PROBED)]
    spread = [np.linspace(0, len(d) - 1, PROBES).round().astype(np.int64) for d in probed]
    return Outlines(dots, np.stack([d[index] for d, index in zip(probed, spread, strict=True)]), fold)


def _hiding_dots(alpha: NDArray[np.uint8], side: int, sure: float) -> _Dots:
    """Dots (n, 2), one at least, that hide what is behind a tile with this alpha, reduced to ``side`` texels a side."""
    coarse = cv2.resize(alpha, (side, side), interpolation=cv2.INTER_AREA)
    row, column = np.nonzero(coarse >= sure * min(255.0, float(coarse.max())))
    return np.stack([(column + 0.5) * 2 / side - 1, 1 - (row + 0.5) * 2 / side], axis=1).astype(np.float32)


def share_inside(leaves: Leaves, outlines: Outlines, grid: FoliageGrid) -> Floats:
    """Share (m,) of each card's probes that project into the foliage, or onto wood that the card lies behind."""
    cells = _Shown.of(leaves, outlines.fold, grid).cells(outlines.probes[leaves.tiles], grid)
    return np.asarray(grid.deeper(cells, grid.camera.depth(leaves.centres)[:, None]).mean(axis=1))


def newly_hidden(nearest: Depths, leaves: Leaves, outlines: Outlines, grid: FoliageGrid) -> tuple[Floats, Floats]:
    """Shares (m,) of each card's probes that hide foliage, or background, in cells without a ``nearest`` card (cells,).

    Wood that a card lies behind is neither.
    """
    cells = _Shown.of(leaves, outlines.fold, grid).cells(outlines.probes[leaves.tiles], grid)
    free = np.isinf(nearest.take(cells))
    foliage = grid.inside.take(cells)
    behind = grid.deeper(cells, grid.camera.depth(leaves.centres)[:, None])
    return (free & foliage).mean(axis=1), (free & ~behind).mean(axis=1)


def fit_and_gain(
    nearest: Depths, leaves: Leaves, outlines: Outlines, grid: FoliageGrid
) -> tuple[Floats, Floats, Floats]:
    """Return `share_inside` and the two shares of `newly_hidden` of cards (m,) at once."""
    cells = _Shown.of(leaves, outlines.fold, grid).cells(outlines.probes[leaves.tiles], grid)
    behind = grid.deeper(cells, grid.camera.depth(leaves.centres)[:, None])
    free = np.isinf(nearest.take(cells))
    foliage = (free & grid.inside.take(cells)).mean(axis=1)
    return behind.mean(axis=1), foliage, (free & ~behind).mean(axis=1)


def share_hidden(nearest: Depths, leaves: Leaves, outlines: Outlines, grid: FoliageGrid) -> Floats:
    """Share (m,) of each card's probes in cells whose ``nearest`` card (cells,) lies before it."""
    cells = _Shown.of(leaves, outlines.fold, grid).cells(outlines.probes[leaves.tiles], grid)
    depth = grid.camera.depth(leaves.centres).astype(np.float32)
    return np.asarray((nearest[cells] < depth[:, None]).mean(axis=1))


def cover(nearest: Depths, leaves: Leaves, outlines: Outlines, grid: FoliageGrid) -> None:
    """Lower the depth of the ``nearest`` card (cells,), metres, flat as the grid, to that of cards that lie before it.

    It is infinite where no card hides the cell.
    """
    shown = _Shown.of(leaves, outlines.fold, grid)
    depth = grid.camera.depth(leaves.centres).astype(np.float32)[:, None]
    cards = np.concatenate([shown.middles, shown.rights, shown.ups, shown.ridges, depth], axis=1)
    kinds = np.searchsorted(LATTICES[:-1], shown.sides) * len(outlines.probes) + leaves.tiles
    kinds = kinds.astype(np.int64)
    cells = nearest.reshape(grid.inside.shape)
    lower(cells, np.ascontiguousarray(cards), kinds, outlines.every_dot, outlines.starts)


@dataclass(frozen=True, eq=False)
class _Shown:
    """Cards as a view shows them, in cells of its grid: their middles, half-extents right and up, and ridges (m, 2)."""

    middles: _Dots
    rights: _Dots
    ups: _Dots
    ridges: _Dots

    @staticmethod
    def of(leaves: Leaves, fold: float, grid: FoliageGrid) -> "_Shown":
        """Project cards' middles and extents; within a card, perspective is neglected."""
        rights = np.where(leaves.flips, -1.0, 1.0)[:, None] * leaves.rights
        offsets = (np.zeros_like(rights), rights, leaves.ups, leaves.ridges(fold))
        points = np.concatenate([leaves.centres + offset for offset in offsets])
        middles, right, up, ridge = np.split(grid.positions_of(points).astype(np.float32), 4)
        return _Shown(middles, right - middles, up - middles, ridge - middles)

    @property
    def sides(self) -> _Dots:
        """Longer side (m,) of each card."""
        return np.asarray(2 * np.sqrt(np.maximum((self.rights**2).sum(axis=1), (self.ups**2).sum(axis=1))))

    def cells(self, dots: _Dots, grid: FoliageGrid) -> Indices:
        """Flat cells (m, p) of dots (m or 1, p, 2) on the cards."""
        rows, columns = grid.inside.shape
        right, up = np.ascontiguousarray(np.moveaxis(dots, -1, 0))
        before, places = 1 - np.abs(right - up), []
        for axis in (0, 1):
            place = right * self.rights[:, None, axis]
            place += up * self.ups[:, None, axis]
            place += before * self.ridges[:, None, axis]
            place += self.middles[:, None, axis]
            places.append(place)
        x, y = places
        return np.asarray(_within(y, rows) * columns + _within(x, columns))


def _within(position: _Dots, count: int) -> Indices:
    """Index of the cell, of ``count``, that holds each position; the nearest one outside."""
    return np.asarray(np.clip(position, 0, count - 1).astype(np.int32))
