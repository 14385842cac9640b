"""Limbs that show among the leaves at the sides that no picture shows, as those do that the picture shows."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.leaf.arrangement import Poses, Seats
from treestroke.core.leaf.leaf_crown import SIDES, USUAL_FIT, Fit, LeafCrown
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

AS_MUCH = 1.2
"""Area of the limbs that are kept free at the sides over that of the wood that the picture shows in the foliage: the
sides are a third wider. At 1.6 conifers show half as much again as in front (11 trees)."""
ASIDE = 0.5
"""Cosine between the directions to the viewer and to the side in which a limb shows, from which on it is at a side."""
LEAST = 0.1
"""Radius of the thinnest limbs that count, over the thickest stem's."""
CLEAR = 0.8
"""How far the middles of cards keep from such a limb's outline, over half a card's side."""
OUTERMOST = 0.95
"""How far out in its section, as a share of the way, a limb counts at most: a last leaf always hangs before it."""
NARROW = 4.0
"""Least distance of a limb from the axis over its breadth with what is cleared: no wide wedge is cleared before it."""
COLUMNS = 240
"""Columns of the picture all around."""


@dataclass(frozen=True, eq=False)
class ShownLimbs:
    """Limbs before which no leaf hangs, as a picture of the crown all around shows them.

    Attributes
    ----------
    volume
        The crown, about whose axis the picture is taken.
    foot, cell
        Height of the lowest row, and of each row, metres.
    distances
        (rows, columns) distance of the limb from the axis, metres; infinite where there is none. The first and last
        column face the front.
    """

    volume: CrownVolume
    foot: float
    cell: float
    distances: NDArray[np.float32]

    def behind(self, points: Floats) -> Mask:
        """Tell which points (n, 3), metres, have such a limb behind them, seen from outside: flags (n,)."""
        column, row, away = _all_around(self.volume, points, self.foot, self.cell)
        row = np.clip(row, 0, len(self.distances) - 1).astype(np.int64)
        return np.asarray(away > self.distances[row, np.minimum(column, COLUMNS - 1).astype(np.int64)])


@dataclass(frozen=True, eq=False)
class LeafPlace:
    """Where cards may hang: in the crown, but not before the limbs that show at its sides."""

    crown: LeafCrown
    limbs: ShownLimbs

    def dressed(
        self, poses: Poses, seats: Seats, rng: np.random.Generator, fit: Fit = USUAL_FIT
    ) -> tuple[Leaves, Mask]:
        """Colour the cards that fit, and tell which of the poses do: flags (n,); as `LeafCrown.dressed`."""
        leaves, kept = self.crown.dressed(poses, seats, rng, fit)
        if not fit.in_imagined:
            return leaves, kept
        free = ~self.limbs.behind(leaves.centres)
        kept[np.flatnonzero(kept)] = free
        return leaves.select(free), kept


def shown_limbs(skeleton: Skeleton, crown: LeafCrown) -> ShownLimbs:
    """Choose limbs of a grown tree (metres) that are to show at its sides: as much as the first view shows.

    Those are chosen that show most for the foliage that is cleared before them. Where the crown's depth is seen, views
    say it all, and none is chosen.
    """
    foot, cell = float(skeleton.points[:, 1].min()), 2 * np.pi * crown.volume.widest / COLUMNS
    rows = max(1, int(np.ceil(np.ptp(skeleton.points[:, 1]) / cell)))
    distances = np.full((rows, COLUMNS), np.inf, dtype=np.float32)
    limbs = ShownLimbs(crown.volume, foot, cell, distances)
    if crown.volume.depth_seen:
        return limbs
    clear = CLEAR * crown.side * sum(SIDES) / 4
    ends = skeleton.points[chosen := _chosen(skeleton, crown, clear)], skeleton.points[skeleton.parents[chosen]]
    (x, y, away), (other_x, other_y, other_away) = (_all_around(crown.volume, end, foot, cell) for end in ends)
    free, away = skeleton.radii[chosen] + clear, np.maximum(away, other_away)
    wide, high = free / away * COLUMNS / (2 * np.pi) + abs(x - other_x) / 2, free / cell + abs(y - other_y) / 2
    middle = np.stack([x + other_x, y + other_y], axis=1) / 2
    for limb in np.argsort(-away, kind="stable").tolist():
        centre, axes = np.rint(middle[limb] - 0.5).astype(int).tolist(), (round(wide[limb]), round(high[limb]))
        cv2.ellipse(distances, centre, axes, 0, 0, 360, float(away[limb]), -1)
    return limbs


def _chosen(skeleton: Skeleton, crown: LeafCrown, clear: float) -> Indices:
    """Choose the joints (k,) that end the edges which are to show; ``clear`` is the space beside them, metres."""
    start = skeleton.points[skeleton.parents]
    middles, ways = (skeleton.points + start) / 2, skeleton.points - start
    outward = (middles - crown.volume.axis(middles[:, 1])) * (1, 0, 1)
    away, reach, radii = np.sqrt((outward**2).sum(axis=1)), crown.volume.reach(middles), skeleton.radii
    along = (ways * outward).sum(axis=1) / np.maximum(away, 1e-9)
    areas = 2 * radii * np.sqrt(np.maximum(edge_lengths(skeleton) ** 2 - along**2, 0.0))
    # What is cleared before an edge widens with the distance from the axis.
    cleared = (radii + clear) * away * (1 / np.clip(reach, 1e-3, OUTERMOST) ** 2 - 1)
    # Seen from the axis, what is near it fills the whole side.
    thick = (radii >= LEAST * radii.max()) & (away > np.maximum(NARROW * (radii + clear), edge_lengths(skeleton)))
    eligible = thick & (reach <= 1) & (outward[:, 2] < ASIDE * away)
    worth = np.where(eligible, radii / np.maximum(cleared, 1e-12), 0.0)
    order = np.argsort(-worth, kind="stable")[: np.count_nonzero(eligible)]
    grid = crown.grids[0]
    shown = AS_MUCH * np.count_nonzero(np.isfinite(grid.leaves_from)) * grid.cell_m**2
    return order[: int(np.searchsorted(np.cumsum(areas[order]), shown))]


def _all_around(volume: CrownVolume, points: Floats, foot: float, cell: float) -> tuple[Floats, Floats, Floats]:
    """Return the columns and rows, in cells, and the distances from the axis (n,), metres, of points (n, 3), metres."""
    x, _, z = (points - volume.axis(points[:, 1])).T
    columns = (np.arctan2(x, -z) / (2 * np.pi) + 0.5) * COLUMNS
    return columns, (points[:, 1] - foot) / cell, np.hypot(x, z)
