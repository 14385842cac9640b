"""How sprays sit on their branches."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import child_counts
from treestroke.core.types import Floats, Indices

THIN = 0.25
"""Branches thinner than this share of the thickest bear leaves."""
SCATTER = 0.016
"""How far a spray's foot may stand off its branch, as a share of the tree's height (side twigs that are not drawn)."""
DROOP = 0.25
"""Weight of gravity in a spray's direction."""
AT_END = 0.25
"""Distance from a twig's end, in halves of a card's side, within which a card hides it."""
ON_END = (-0.3, 0.9)
"""How far beyond a twig's end the middle of a spray on it lies, in halves of the spray's side."""
TURN = 0.25
"""Standard deviation by which a spray at a twig's end turns aside from the twig."""


@dataclass(frozen=True, eq=False)
class Seats:
    """n places on branches, evenly spaced along them.

    Attributes
    ----------
    points
        (n, 3) places, metres.
    directions
        (n, 3) unit direction of the branch, outward.
    joints
        (n,) index of the joint that ends the edge.
    """

    points: Floats
    directions: Floats
    joints: Indices

    def __len__(self) -> int:
        return len(self.points)

    def at(self, index: Indices | NDArray[np.bool_]) -> "Seats":
        """Select places by index (k,) or by flags (n,)."""
        return Seats(self.points[index], self.directions[index], self.joints[index])


def thin_edges(skeleton: Skeleton) -> NDArray[np.bool_]:
    """Mark the joints whose edge is thin enough to bear leaves: flags (n,); all if none is thin."""
    thin = skeleton.radii < THIN * skeleton.radii.max()
    return np.asarray(thin if (edge_lengths(skeleton) * thin).any() else np.ones_like(thin))


def seats_along(skeleton: Skeleton, weights: Floats, count: int, rng: np.random.Generator) -> Seats:
    """Spread ``count`` places over edges, in proportion to each edge's length, metres, times its weight (n,).

    Source: Tan et al. 2008, section 4: leaves in proportion to branches' length.
    """
    weighted = edge_lengths(skeleton) * weights
    ends = np.cumsum(weighted)
    if ends[-1] <= 0 or count <= 0:
        return Seats(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0, dtype=np.int64))
    along = (np.arange(count) + rng.random(count)) * ends[-1] / count
    joints = np.minimum(np.searchsorted(ends, along, side="right"), len(skeleton) - 1)
    end, start = skeleton.points[joints], skeleton.points[skeleton.parents[joints]]
    share = np.clip((ends[joints] - along) / np.maximum(weighted[joints], 1e-12), 0, 1)[:, None]
    return Seats(end + share * (start - end), unit(end - start, UP), joints)


def bare_tips(skeleton: Skeleton, leaves: Leaves) -> Seats:
    """Return a place at the end of each twig that no card on its last piece reaches."""
    tips = np.flatnonzero((child_counts(skeleton) == 0) & (skeleton.parents >= 0))
    offsets = skeleton.points[leaves.joints] - leaves.centres
    half = np.linalg.norm(leaves.ups, axis=1, keepdims=True)
    square = np.maximum(half**2, 1e-12)
    across, along = (
        np.clip((offsets * side).sum(axis=1, keepdims=True) / square, -1.0, 1.0) * side
        for side in (leaves.rights, leaves.ups)
    )
    reaching = np.linalg.norm(offsets - across - along, axis=1) <= AT_END * half[:, 0]
    tips = np.setdiff1d(tips, leaves.joints[reaching])
    end, start = skeleton.points[tips], skeleton.points[skeleton.parents[tips]]
    return Seats(end, unit(end - start, UP), tips)


@dataclass(frozen=True, eq=False)
class Poses:
    """Cards without colour: centres, half-extent vectors rights and ups (n, 3), metres."""

    centres: Floats
    rights: Floats
    ups: Floats


def pose_on_branches(
    seats: Seats, half_sizes: Floats, height: float, crown_middle: Floats, rng: np.random.Generator
) -> Poses:
    """Set a spray on each of n seats: foot near the branch, outward along it, drooping a little, facing out and up.

    ``half_sizes`` (n,), ``height`` of the tree and ``crown_middle`` (3,) are in metres.
    """
    around = rng.normal(size=seats.points.shape)
    along = (around * seats.directions).sum(axis=1, keepdims=True)
    around = unit(around - along * seats.directions, UP)
    offset = height * SCATTER * np.sqrt(rng.random((len(seats), 1)))
    axis = 0.7 * seats.directions + rng.uniform(0.4, 1.2, (len(seats), 1)) * around
    axis[:, 1] -= DROOP
    axis = unit(axis, UP)
    centres = seats.points + offset * around + 0.8 * half_sizes[:, None] * axis
    return Poses(centres, *_frames(axis, unit(centres - crown_middle, UP), half_sizes, rng))


def pose_at_tips(seats: Seats, half_sizes: Floats, crown_middle: Floats, rng: np.random.Generator) -> Poses:
    """Set a spray on the end of each of n twigs, about along the twig, facing out and up.

    ``half_sizes`` (n,) and ``crown_middle`` (3,) are in metres.
    """
    axis = seats.directions + rng.normal(0, TURN, seats.directions.shape)
    axis[:, 1] -= 0.5 * DROOP
    axis = unit(axis, UP)
    centres = seats.points + rng.uniform(*ON_END, (len(seats), 1)) * half_sizes[:, None] * axis
    return Poses(centres, *_frames(axis, unit(centres - crown_middle, UP), half_sizes, rng))


def pose_over(seats: Seats, centres: Floats, half_sizes: Floats, outward: Floats, rng: np.random.Generator) -> Poses:
    """Set a spray of half size (n,) at each centre (n, 3), metres, hung from its seat and facing ``outward`` (n, 3)."""
    offsets = centres - seats.points
    axis = unit(0.6 * seats.directions + unit(offsets) + rng.normal(0, 0.5, offsets.shape), UP)
    return Poses(centres, *_frames(axis, outward, half_sizes, rng))


def _frames(axis: Floats, outward: Floats, half_sizes: Floats, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Turn cards about their axis to face outward and up, with some scatter: rights and ups."""
    facing = 0.75 * outward + rng.normal(0, 0.45, axis.shape)
    facing[:, 1] += 0.35
    right = unit(np.cross(axis, facing), UP)
    return right * half_sizes[:, None], axis * half_sizes[:, None]
