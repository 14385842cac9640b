"""Adds cards where cards leave gaps in the foliage."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.leaf.arrangement import Seats, pose_over, seats_along
from treestroke.core.leaf.coverage import newly_hidden
from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.leaf.leaf_crown import SIDES, LeafCrown
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices

SIZES = (1.0, 0.8, 0.6, 0.5, 0.4, 0.4, 0.3, 0.3, 0.3, 0.25, 0.25, 0.25, 0.2, 0.2, 0.2, 0.2, 0.2)
"""Sizes of the cards, round by round, the large ones first."""
TARGET = 0.985
"""Share of the foliage's cells at which covering stops."""
SEATS = 8000
"""Places on all branches, thick ones too, that such cards may hang from."""
FITTING = 0.55
"""Share of such a card's opaque dots that must lie in the foliage, which is all fringe where leaves are thin."""
WORTH = 4.0
"""How many times as much open foliage such a card hides as background (2 costs 2 % of the silhouette's precision for
1 % of its recall; 7 crowns)."""
NEAR, REACH = 0.045, 0.08
"""How far such a card usually and at most stands off its branch in the picture, as shares of the tree's height."""
FAR_SHARE = 0.02
"""Share of the cards that may stand further off than NEAR: an end of the crown that growth did not reach."""
THICKNESS = 0.012
"""Standard deviation of such cards' depth about that of their branch, as a share of the tree's height."""


@dataclass(frozen=True)
class GapParams:
    """How far gaps are covered.

    Attributes
    ----------
    share
        Share, 0 to 1, of what can be covered that is covered.
    most
        Most cards that are added.
    """

    share: float
    most: int


@dataclass(frozen=True, eq=False)
class _Gaps:
    """What covers the gaps of one view: the view's grid, the seats, and how many cards may stand far from theirs."""

    grid: FoliageGrid
    crown: LeafCrown
    seats: Seats
    far: int


def cover_gaps(
    leaves: Leaves, skeleton: Skeleton, crown: LeafCrown, params: GapParams, rng: np.random.Generator
) -> list[Leaves]:
    """Set cards over what the leaves leave open in each view, in smaller and smaller sizes.

    Places too far from any branch stay open.
    """
    seats = seats_along(skeleton, np.ones(len(skeleton), dtype=np.bool_), SEATS, rng)
    if len(seats) == 0:
        return []
    far, patches = int(FAR_SHARE * len(leaves) / len(SIZES)), [leaves]
    for grid in crown.grids:
        patches += _cover_view(patches, _Gaps(grid, crown, seats, far), params, rng)
    return patches[1:]


def _cover_view(patches: Sequence[Leaves], gaps: _Gaps, params: GapParams, rng: np.random.Generator) -> list[Leaves]:
    """Set cards over what all ``patches`` leave open in one view; the first of them does not count as added."""
    grid, crown, inside = gaps.grid, gaps.crown, gaps.grid.inside.ravel()
    nearest, covered, added = _nearest_seats(gaps.seats, grid), np.zeros(inside.size, dtype=np.bool_), list[Leaves]()
    for patch in patches[:-1]:
        crown.hide(covered, patch, grid)
    for scale in SIZES:
        crown.hide(covered, (added or patches)[-1], grid)
        open_cells = np.flatnonzero(inside & ~covered)
        left = params.most - sum(map(len, [*patches[1:], *added]))
        surplus = len(open_cells) - (1 - TARGET * params.share) * inside.sum()
        if surplus <= 0 or left <= 0:
            break
        count = min(_count(surplus, scale, gaps), left, len(open_cells))
        chosen = rng.choice(open_cells, count, replace=False)
        patch = _patch(chosen, gaps.seats.at(nearest[chosen]), scale, gaps, rng)
        foliage, background = newly_hidden(covered, patch, crown.outlines, grid)
        added.append(patch.select((foliage > 0) & (foliage >= WORTH * background)))
    return added


def _count(cells: float, scale: float, gaps: _Gaps) -> int:
    """Estimate how many cards of a size cover this many cells, if half of them cover nothing new."""
    card_cells = 0.3 * (scale * gaps.crown.side * sum(SIDES) / 2 / gaps.grid.cell_m) ** 2
    return int(np.ceil(1.5 * cells / max(card_cells, 1.0)))


def _nearest_seats(seats: Seats, grid: FoliageGrid) -> Indices:
    """Find the seat nearest in the picture to each cell, flat, to within a cell."""
    cells = grid.cells_of(seats.points)
    free = np.ones(grid.inside.size, dtype=np.uint8)
    free[cells] = 0
    _, labels = cv2.distanceTransformWithLabels(
        free.reshape(grid.inside.shape), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    seat_of = np.zeros(int(labels.max()) + 1, dtype=np.int64)
    seat_of[labels.ravel()[cells]] = np.arange(len(seats))
    return np.asarray(seat_of[labels.ravel()])


def _patch(cells: Indices, seats: Seats, scale: float, gaps: _Gaps, rng: np.random.Generator) -> Leaves:
    """Set cards of one size over cells (m,), each hung from its seat; those that do not fit are left out."""
    crown = gaps.crown
    centres, kept = _centres(cells, seats, gaps, rng)
    seats, half_sizes = seats.at(kept), scale * crown.half_sizes(len(centres), rng)
    outward = _seen_from(gaps.grid, centres, unit(centres - crown.middle, UP))
    return crown.dressed(pose_over(seats, centres, half_sizes, outward, rng), seats, rng, FITTING)[0]


def _centres(cells: Indices, seats: Seats, gaps: _Gaps, rng: np.random.Generator) -> tuple[Floats, Indices]:
    """Place centres (n, 3), metres, over cells (m,), about as deep in the view as their seats (m,): centres, and which.

    Cells out of reach are left out, and so are all but ``far`` of those that are not near.
    """
    camera, height = gaps.grid.camera, gaps.crown.height
    points_px, depth = gaps.grid.pixels_of(cells, rng.random((len(cells), 2))), camera.depth(seats.points)
    way = camera.world_from_pixels(points_px, depth) - seats.points
    distance = np.sqrt((way**2).sum(axis=1))
    beyond = distance > NEAR * height
    kept = np.flatnonzero((distance <= REACH * height) & (~beyond | (np.cumsum(beyond) <= gaps.far)))
    depth = depth[kept] - rng.normal(0, THICKNESS * height, len(kept))
    return camera.world_from_pixels(points_px[kept], depth), kept


def _seen_from(grid: FoliageGrid, centres: Floats, outward: Floats) -> Floats:
    """Turn directions (n, 3) out of the crown toward or away from the viewer of a view, as they point already."""
    toward = grid.camera.toward_viewer(centres)
    away = (outward * toward).sum(axis=1, keepdims=True) < 0
    return np.asarray(outward + np.where(away, -1.0, 1.0) * toward)
