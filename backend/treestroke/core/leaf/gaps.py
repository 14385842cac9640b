"""Further cards where the foliage is still seen through."""

import cv2
import numpy as np

from treestroke.core.leaf.arrangement import Seats, pose_over, seats_along
from treestroke.core.leaf.crown import SIDES, Crown
from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices

SIZES = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.4, 0.3)
"""Sizes of the cards, round by round, the large ones first."""
TARGET = 0.985
"""Share of the foliage's cells at which covering stops."""
BEARERS = 8000
"""Places on all branches, thick ones too, that such cards may hang from."""
NEAR, REACH = 0.045, 0.08
"""How far such a card usually and at most stands off its branch in the photo, as shares of the tree's height."""
FAR_SHARE = 0.02
"""Share of the cards that may stand further off than NEAR: an end of the crown that growth did not reach."""
THICKNESS = 0.012
"""Standard deviation of such cards' depth about that of their branch, as a share of the tree's height."""


def cover_gaps(
    leaves: Leaves, skeleton: Skeleton, crown: Crown, share: float, most: int, rng: np.random.Generator
) -> list[Leaves]:
    """Set cards over what the leaves leave open, in smaller and smaller sizes, at most so many.

    Ends when ``share`` of what can be covered is. Places too far from any branch stay open.
    """
    seats = seats_along(skeleton, np.ones(len(skeleton), dtype=np.bool_), BEARERS, rng)
    if len(seats) == 0:
        return []
    nearest, inside = _nearest_seats(seats, crown.grid), crown.grid.inside.ravel()
    covered, patches = np.zeros(inside.size, dtype=np.bool_), [leaves]
    far = int(FAR_SHARE * len(leaves) / len(SIZES))
    for scale in SIZES:
        crown.hide(covered, patches[-1])
        gaps = np.flatnonzero(inside & ~covered)
        left, surplus = most - sum(map(len, patches[1:])), len(gaps) - (1 - TARGET * share) * inside.sum()
        if surplus <= 0 or left <= 0:
            break
        chosen = rng.choice(gaps, min(_count(surplus, scale, crown), left, len(gaps)), replace=False)
        centres, index = _centres(chosen, nearest[chosen], seats, crown, far, rng)
        patches.append(_patch(centres, seats.at(index), scale, crown, rng))
    return patches[1:]


def _count(cells: float, scale: float, crown: Crown) -> int:
    """How many cards of a size could cover so many cells, half of them in vain."""
    card_cells = 0.3 * (scale * crown.side * sum(SIDES) / 2 / crown.grid.cell_m) ** 2
    return int(np.ceil(1.5 * cells / max(card_cells, 1.0)))


def _centres(
    gaps: Indices, nearest: Indices, seats: Seats, crown: Crown, far: int, rng: np.random.Generator
) -> tuple[Floats, Indices]:
    """Place centres (n, 3) over gaps (m,), about as deep as the seat ``nearest`` (m,) in the photo, and tell that seat.

    Gaps out of reach are left out, and so are all but ``far`` of those that are not near.
    """
    x, y = crown.grid.x_y_of(gaps, rng.random((len(gaps), 2)))
    distance = np.hypot(x - seats.points[nearest, 0], y - seats.points[nearest, 1])
    beyond = distance > NEAR * crown.height
    kept = (distance <= REACH * crown.height) & (~beyond | (np.cumsum(beyond) <= far))
    z = seats.points[nearest[kept], 2] + rng.normal(0, THICKNESS * crown.height, np.count_nonzero(kept))
    return np.stack([x[kept], y[kept], z], axis=1), nearest[kept]


def _nearest_seats(seats: Seats, grid: FoliageGrid) -> Indices:
    """Find the seat nearest in the photo to each cell, flat, to within a cell."""
    cells = grid.flat_cells(seats.points[:, 0], seats.points[:, 1])
    free = np.ones(grid.inside.size, dtype=np.uint8)
    free[cells] = 0
    _, labels = cv2.distanceTransformWithLabels(
        free.reshape(grid.inside.shape), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    seat_of = np.zeros(int(labels.max()) + 1, dtype=np.int64)
    seat_of[labels.ravel()[cells]] = np.arange(len(seats))
    return np.asarray(seat_of[labels.ravel()])


def _patch(centres: Floats, seats: Seats, scale: float, crown: Crown, rng: np.random.Generator) -> Leaves:
    """Set cards of one size at centres (n, 3), each borne by its seat; those that do not fit are left out."""
    poses = pose_over(seats, centres, scale * crown.half_sizes(len(seats), rng), crown.middle, rng)
    return crown.dressed(poses, seats, rng)[0]
