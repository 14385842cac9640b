"""Measures which part of the foliage cards hide, by the outlines of their tiles."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.types import Floats, Indices

DOTS_ACROSS = 12
"""A tile is sampled in 12 x 12 dots: about one per grid cell for a card of usual size."""
SURE_ALPHA = 160
"""Alpha (0 to 255) above which a dot is drawn in every mip level."""
PROBES = 24
"""Opaque dots of a tile that are tested against the foliage's outline."""


@dataclass(frozen=True, eq=False)
class Outlines:
    """The opaque dots of the atlas's tiles, in half-extents of a card: x right, y up, -1 to 1.

    Attributes
    ----------
    dots
        k arrays (n, 2), all opaque dots.
    probes
        (k, PROBES, 2) some of them, spread over the tile.
    """

    dots: tuple[Floats, ...]
    probes: Floats


def outlines_of(alphas: NDArray[np.uint8]) -> Outlines:
    """Find the opaque dots of tiles (k, side, side) of alpha."""
    dots = []
    for alpha in alphas:
        coarse = cv2.resize(alpha, (DOTS_ACROSS, DOTS_ACROSS), interpolation=cv2.INTER_AREA)
        row, column = np.nonzero(coarse >= min(SURE_ALPHA, int(coarse.max())))
        x, y = (column + 0.5) * 2 / DOTS_ACROSS - 1, 1 - (row + 0.5) * 2 / DOTS_ACROSS
        dots.append(np.stack([x, y], axis=1))
    spread = [np.linspace(0, len(d) - 1, PROBES).round().astype(np.int64) for d in dots]
    return Outlines(tuple(dots), np.stack([d[index] for d, index in zip(dots, spread, strict=True)]))


def share_inside(leaves: Leaves, outlines: Outlines, grid: FoliageGrid) -> Floats:
    """Share (m,) of each card's opaque dots that project into the foliage, or onto wood that the card lies behind."""
    cells = _cells(leaves, outlines.probes[leaves.tiles], grid)
    return np.asarray(grid.deeper(cells, grid.camera.depth(leaves.centres)[:, None]).mean(axis=1))


def newly_hidden(
    covered: NDArray[np.bool_], leaves: Leaves, outlines: Outlines, grid: FoliageGrid
) -> tuple[Floats, Floats]:
    """Shares (m,) of each card's opaque dots that hide foliage, or background, not ``covered`` (cells,) yet.

    Wood that a card lies behind is neither.
    """
    cells = _cells(leaves, outlines.probes[leaves.tiles], grid)
    free = ~covered[cells]
    foliage = grid.inside.ravel()[cells]
    behind = grid.deeper(cells, grid.camera.depth(leaves.centres)[:, None])
    return (free & foliage).mean(axis=1), (free & ~behind).mean(axis=1)


def cover(covered: NDArray[np.bool_], leaves: Leaves, outlines: Outlines, grid: FoliageGrid) -> None:
    """Mark in ``covered``, flags (cells,), flat as the grid, what the cards hide."""
    for tile, dots in enumerate(outlines.dots):
        covered[_cells(leaves.select(leaves.tiles == tile), dots[None], grid)] = True


def _cells(leaves: Leaves, dots: Floats, grid: FoliageGrid) -> Indices:
    """Grid cells (m, p) of dots (m or 1, p, 2) on cards."""
    across, up = dots[..., 0] * np.where(leaves.flips, -1.0, 1.0)[:, None], dots[..., 1]
    # One coordinate after the other: numpy is slow where the last axis is short.
    centres, rights, ups = (vectors.T[..., None] for vectors in (leaves.centres, leaves.rights, leaves.ups))
    points = across * rights
    points += centres
    points += up * ups
    return grid.cells_of(points.reshape(3, -1).T).reshape(points.shape[1:])
