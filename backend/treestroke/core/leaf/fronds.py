"""Sets the leaflets of palm fronds on their midribs."""

from dataclasses import replace

import numpy as np

from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.leaf.arrangement import Poses, Seats, seats_along, thin_edges
from treestroke.core.leaf.coverage import share_inside
from treestroke.core.leaf.leaf_crown import LeafCrown
from treestroke.core.leaf.leaves import Leaves, join_leaves
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

HALF_SIDE = 0.165
"""Half the side of a card that shows a piece of a frond, as a share of the frond's length (judged on five palms)."""
PROFILE = ((0.0, 0.1, 0.4, 0.8, 1.0), (0.25, 0.75, 1.0, 0.8, 0.3))
"""Size of the pieces along a frond: places, 0 to 1, and factors."""
BARE_FOOT = 0.08
"""Share of a frond, from its foot on, without leaflets."""
SPACING = 0.025
"""Distance between pieces, as a share of the mean frond's length, at density 1."""
ROLL, SCATTER = 0.7, 0.2
"""Angle by which every other piece is turned about its midrib to either side, and its standard deviation, rad: leaflets
stand off in two planes, so that a frond is broad from the side, too."""
SHRINKING = (1.0, 0.8, 0.6, 0.45)
"""Sizes at which a piece is tried until it fits the foliage; the last one stays as it is."""
FITTING = 0.8
"""Share of a piece's opaque dots that must lie in the foliage: leaflets fray the outline."""


def set_fronds(skeleton: Skeleton, crown: LeafCrown, density: float, rng: np.random.Generator) -> Leaves:
    """Set pieces of fronds along the thin limbs of a palm (metres), which are its midribs, each level across."""
    midribs = thin_edges(skeleton)
    along, length, frond = _places(skeleton, midribs)
    weights = midribs * (along >= BARE_FOOT)
    wood = float((edge_lengths(skeleton) * weights).sum())
    count = round(density * wood / max(SPACING * float(length[midribs].mean()), 1e-9))
    seats = seats_along(skeleton, weights.astype(np.float64), count, rng)
    half_sizes = HALF_SIDE * length[seats.joints] * np.interp(along[seats.joints], *PROFILE)
    order, found = np.arange(len(seats)), []
    for scale in SHRINKING:
        tried = seats.at(order)
        leaves = crown.coloured(_pose(tried, scale * half_sizes[order], rng), tried, rng)
        inside = np.max([share_inside(leaves, crown.outlines, grid) for grid in crown.grids], axis=0)
        kept = (inside >= FITTING) | (scale == SHRINKING[-1])
        found.append(leaves.select(kept))
        order = order[~kept]
    leaves = join_leaves(found)
    return replace(leaves, tiles=_of_one_colour(leaves.tiles, frond[leaves.joints]))


def _of_one_colour(tiles: Indices, fronds: Indices) -> Indices:
    """Give all pieces of a frond the tile (m,) of its middle one, by the frond (m,) that each is a piece of."""
    order = np.argsort(fronds, kind="stable")
    _, first, count = np.unique(fronds[order], return_index=True, return_counts=True)
    found = np.empty_like(tiles)
    found[order] = np.repeat(tiles[order[first + count // 2]], count)
    return found


def _places(skeleton: Skeleton, midribs: Mask) -> tuple[Floats, Floats, Indices]:
    """Return how far along its frond each joint lies, 0 to 1, the frond's length, metres, and its last joint, all (n,).

    They mean nothing at joints that belong to no midrib.
    """
    far = edge_lengths(skeleton) * midribs
    parents = skeleton.parents.tolist()
    for joint, parent in enumerate(parents):
        far[joint] += far[parent] if parent >= 0 else 0.0
    length, last = far.copy(), np.arange(len(far))
    for joint in range(len(parents) - 1, 0, -1):
        if midribs[joint] and parents[joint] >= 0 and midribs[parents[joint]]:
            length[parents[joint]], last[parents[joint]] = length[joint], last[joint]
    return far / np.maximum(length, 1e-12), length, last


def _pose(seats: Seats, half_sizes: Floats, rng: np.random.Generator) -> Poses:
    """Lay a piece of half size (n,) along the midrib at each of n seats."""
    axis, n = seats.directions, len(seats)
    level = unit(np.cross(axis, UP), np.array([1.0, 0.0, 0.0]))
    roll = (ROLL * np.where(np.arange(n) % 2, 1.0, -1.0) + rng.normal(0, SCATTER, n))[:, None]
    right = np.cos(roll) * level + np.sin(roll) * np.cross(level, axis)
    return Poses(seats.points, right * half_sizes[:, None], axis * half_sizes[:, None], np.cross(right, axis)[:, 1])
