"""Sets the leaflets of palm fronds, or the blades of strap leaves, on their midribs."""

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

REACH = 0.18
"""How far leaflets reach aside from the midrib where they are longest, as a share of the frond's length (judged on five
palms)."""
PROFILE = ((0.0, 0.12, 0.4, 0.75, 1.0), (0.3, 0.8, 1.0, 0.8, 0.35))
"""Length of the leaflets along a frond: places, 0 to 1, and factors."""
BREADTH = 0.17
"""Breadth of a card along the midrib, as a share of the frond's length."""
BARE_FOOT = 0.08
"""Share of a frond, from its foot on, without leaflets."""
SPACING = 0.014
"""Distance between cards, one on each side in turn, as a share of the mean frond's length, at density 1."""
RAISED, HANGING, SCATTER = 0.35, 0.9, 0.12
"""Weights of the midrib's upper side and of gravity in the direction of leaflets, beside 1 for the level one, and their
standard deviation: leaflets stand in a V about the midrib of a young frond, and hang from that of an old one."""
ROLL = 0.8
"""Standard deviation by which a frond is twisted about its midrib, rad."""
SHRINKING = (1.0, 0.8, 0.6, 0.45)
"""Sizes at which a card is tried until it fits the foliage; the last one stays as it is."""
FITTING = 0.5
"""Share of a card's opaque dots that must lie in the foliage: leaflets fray the outline."""


def set_fronds(skeleton: Skeleton, crown: LeafCrown, density: float, rng: np.random.Generator) -> Leaves:
    """Set cards of leaflets along both sides of the thin limbs of a palm (metres), which are its midribs."""
    midribs = thin_edges(skeleton)
    along, length, frond = _places(skeleton, midribs)
    weights = midribs * (along >= BARE_FOOT)
    wood = float((edge_lengths(skeleton) * weights).sum())
    count = round(density * wood / max(SPACING * float(length[midribs].mean()), 1e-9))
    seats = seats_along(skeleton, weights.astype(np.float64), count, rng)
    sides, sizes = np.where(np.arange(len(seats)) % 2, 1.0, -1.0), length[seats.joints, None]
    reach = REACH * np.interp(along[seats.joints], *PROFILE)
    half = 0.5 * sizes * np.column_stack([np.full(len(seats), BREADTH), reach])
    roll = rng.normal(0, ROLL, len(skeleton))[frond[seats.joints]]
    order, found = np.arange(len(seats)), []
    for scale in SHRINKING:
        tried = seats.at(order)
        poses = _pose(tried, sides[order], roll[order], scale * half[order], rng)
        leaves = replace(crown.coloured(poses, tried, rng), flips=sides[order] > 0)
        inside = np.max([share_inside(leaves, crown.outlines, grid) for grid in crown.grids], axis=0)
        kept = (inside >= FITTING) | (scale == SHRINKING[-1])
        found.append(leaves.select(kept))
        order = order[~kept]
    leaves = crown.recoloured(join_leaves(found), rng)
    tiles = _of_one_colour(leaves.tiles, frond[leaves.joints], crown.colouring.tile_labs)
    return replace(leaves, tiles=tiles)


def _of_one_colour(tiles: Indices, fronds: Indices, labs: Floats) -> Indices:
    """Return the tiles (m,) with which all cards of a frond (m,) show the one nearest to their mean colour.

    ``labs`` (k, 3) are the tiles' colours, CIE Lab.
    """
    found, member = np.unique(fronds, return_inverse=True)
    total = np.zeros((len(found), 3))
    np.add.at(total, member, labs[tiles])
    mean = total / np.bincount(member)[:, None]
    return np.asarray(((mean[:, None] - labs) ** 2).sum(axis=2).argmin(axis=1)[member])


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


def _pose(seats: Seats, sides: Floats, roll: Floats, half: Floats, rng: np.random.Generator) -> Poses:
    """Set a card of half sizes (n, 2), metres, on each of n seats, its foot on the midrib.

    ``sides`` (n,) are 1 for the midrib's right, -1 for its left; it is twisted by ``roll`` (n,), rad.
    """
    ahead, n = seats.directions, len(seats)
    level = unit(np.cross(ahead, UP), np.array([1.0, 0.0, 0.0]))
    above = np.cross(level, ahead)
    cos, sin = np.cos(roll)[:, None], np.sin(roll)[:, None]
    level, above = cos * level + sin * above, cos * above - sin * level
    weights = np.array([RAISED, -HANGING]) + rng.normal(0, SCATTER, (n, 2))
    out = sides[:, None] * level + weights[:, :1] * above + weights[:, 1:] * UP
    out = unit(out - (out * ahead).sum(axis=1, keepdims=True) * ahead, UP)
    right = -sides[:, None] * ahead
    return Poses(seats.points + half[:, 1:] * out, right * half[:, :1], out * half[:, 1:])
