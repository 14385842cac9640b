"""Extends limbs whose stroke ends before the crown does.

A person may draw only the first stretch of a limb, or the tracer lose it among leaves; the limb would remain a stub.
Each is extended along a curve into free space, thick limbs first, as far as wood of its thickness reaches; of the
curves tried, the one with most free space around it is taken, as in lifting (Okabe et al. 2005).
"""

from typing import NamedTuple

import numpy as np

from treestroke.core.geometry.vectors import unit
from treestroke.core.grow.branches import successors_by_wood
from treestroke.core.grow.form import UP_IN_PICTURE
from treestroke.core.grow.growth_space import GrowthSpace
from treestroke.core.skeleton.measure import path_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import limbs
from treestroke.core.types import Floats, Indices, Mask

JOINT_SHARE = 0.02
"""Distance between new joints, as a share of the crown's height."""
LEAST_LIMB = 0.05
"""Limbs shorter than this share of the crown's height are spurs and stay as they are."""
AIM_SHARE = 0.08
"""Length of a limb's last stretch, which gives its direction and thickness, as a share of the crown's height."""
SLENDER = 55.0
"""Greatest length of an extension over the radius that it begins with."""
LEAST_REACH, MOST_REACH = 0.1, 0.5
"""Bounds of that length, as shares of the crown's height."""
MOST_GAP = 0.2
"""Greatest gap between a limb's end and the foliage that an extension crosses, as a share of the crown's height."""
ROOM = 0.12
"""Greatest free distance that counts, as a share of the crown's height."""
LEAST_ROOM = 0.03
"""Least mean free space along an extension, as a share of the crown's height; with less, a limb stays as it is."""
SWERVES = (0.0, 0.5, 1.0, 1.7)
"""Sideways offsets of the curves' ends that are tried, over their length ahead."""
TURNS = 6
LENGTHS = (1.0, 0.75, 0.5, 0.3)
RISE = 0.35
"""Weight of the vertical in the direction of a curve's end (phototropism)."""
OUTWARD = 0.3
"""Least cosine between a curve's end and the direction from the crown's foot to it: no limb curls back."""
WITHIN = 0.92
"""Share of the crown's radius that curves may use."""
MOST_EXTENDED = 20
"""Greatest number of limbs that are extended, the thickest: a crown whose limbs are seen needs no more."""
THINNED = 0.35
"""Radius at an extension's end over that at its start, before the pipe model sets the final radii (`radii`)."""


class _End(NamedTuple):
    """A limb's end: its joint, its direction there (3,), unit length, its radius, and how far it may go on, px."""

    joint: int
    direction: Floats
    radius: float
    reach: float


def with_limbs_extended(skeleton: Skeleton, space: GrowthSpace) -> Skeleton:
    """Extend the limbs of a visible tree (px) that end under the crown, or in it with free space ahead.

    An extension ends inside the crown, below the tree's highest joint, and points outward there. It may cross a gap
    between the limb's end and the foliage. Its radii fall from the limb's own.

    Source: our own; the choice by free space follows Okabe et al. 2005.
    """
    rows = np.flatnonzero(space.mask.any(axis=1))
    height = float(rows[-1] - rows[0] + 1)
    for end in _ends(skeleton, height):
        path = _best_path(skeleton, end, space, height)
        if len(path):
            skeleton = _appended(skeleton, end, path)
    return skeleton


def _ends(skeleton: Skeleton, height: float) -> list[_End]:
    """List the ends of the thickest limbs, those first, without the highest joint, which ends the leader."""
    highest = int(np.argmin(skeleton.points[:, 1]))
    arc = path_lengths(skeleton)
    found = []
    for limb in limbs(skeleton, successors_by_wood(skeleton)):
        length = float(arc[limb[-1]] - arc[limb[0]])
        if limb[-1] != highest and length >= LEAST_LIMB * height:
            found.append(_end(skeleton, limb, arc, height))
    return sorted(found, key=lambda end: (-end.radius, end.joint))[:MOST_EXTENDED]


def _end(skeleton: Skeleton, limb: Indices, arc: Floats, height: float) -> _End:
    """Measure how a limb ends, over its last stretch."""
    joints = limb[1:] if len(limb) > 1 else limb
    last = joints[arc[joints] >= arc[joints[-1]] - AIM_SHARE * height]
    before = limb[max(len(limb) - len(last) - 1, 0)]
    radius = float(skeleton.radii[last].max())
    reach = float(np.clip(SLENDER * radius, LEAST_REACH * height, MOST_REACH * height))
    return _End(int(limb[-1]), unit(skeleton.points[limb[-1]] - skeleton.points[before], UP_IN_PICTURE), radius, reach)


def _best_path(skeleton: Skeleton, end: _End, space: GrowthSpace, height: float) -> Floats:
    """Choose the curve (k, 3), px, with most free space along it, without its start; (0, 3) where none fits."""
    start = skeleton.points[end.joint]
    others = _near(skeleton.points[_away(skeleton, end.joint, AIM_SHARE * height)], start, end.reach + ROOM * height)
    top = float(skeleton.points[:, 1].min()) + JOINT_SHARE * height
    best, best_room = np.zeros((0, 3)), LEAST_ROOM * height * LEAST_REACH * height
    for paths in _paths(start, end, JOINT_SHARE * height):
        paths, beyond = _fitting(paths[paths[..., 1].min(axis=1) >= top], space, start, MOST_GAP * height)
        if not len(paths):
            continue
        room = np.zeros(beyond.shape)
        room[beyond] = np.minimum(_nearest(paths[beyond], others), ROOM * height)
        free = room.sum(axis=1) * np.sqrt(((paths[:, -1] - paths[:, -2]) ** 2).sum(axis=-1))
        most = int(free.argmax())
        if free[most] > best_room:
            best, best_room = paths[most], float(free[most])
    return best


def _paths(start: Floats, end: _End, step: float) -> list[Floats]:
    """Draw curves that begin in a limb's direction, swerve to all sides, and rise to their end: (m, k, 3) a length."""
    side = unit(np.cross(end.direction, UP_IN_PICTURE if abs(end.direction[1]) < 0.9 else np.array([1.0, 0.0, 0.0])))
    other = np.cross(side, end.direction)
    turns = 2 * np.pi * np.arange(TURNS) / TURNS
    around = np.cos(turns)[:, None] * other + np.sin(turns)[:, None] * side
    swerved = [swerve * (around if swerve else np.zeros((1, 3))) for swerve in SWERVES]
    directions = unit(end.direction + np.concatenate(swerved))
    return [_curves(start, end.direction, directions * length * end.reach, step) for length in LENGTHS]


def _curves(start: Floats, direction: Floats, chords: Floats, step: float) -> Floats:
    """Place points (m, k, 3) about ``step`` apart on cubic curves that start in one direction and rise at their ends.

    The chords (m, 3) are equally long.
    """
    length = float(np.sqrt((chords[0] ** 2).sum()))
    count = max(int(np.ceil(length / step)), 2)
    t = (np.arange(1, count + 1) / count)[:, None]
    rising = unit(unit(chords) + RISE * UP_IN_PICTURE)[:, None]
    inner = t * (1 - t) ** 2 * direction * length - t**2 * (1 - t) * rising * length
    return np.asarray(start + t**2 * (3 - 2 * t) * chords[:, None] + inner)


def _fitting(paths: Floats, space: GrowthSpace, start: Floats, most_gap: float) -> tuple[Floats, Mask]:
    """Keep the paths (m, k, 3) that soon enter the crown, stay in it, end outward; flag their points (m, k) there."""
    away, ends = unit(paths[:, -1] - space.foot), unit(paths[:, -1] - paths[:, -2])
    paths = paths[(away * ends).sum(axis=1) >= OUTWARD]
    inside = _inside(paths, space)
    beyond = np.logical_or.accumulate(inside, axis=1)
    first = paths[np.arange(len(paths)), inside.argmax(axis=1)]
    fit = (inside == beyond).all(axis=1) & inside[:, -1] & (((first - start) ** 2).sum(axis=1) <= most_gap**2)
    return paths[fit], beyond[fit]


def _inside(paths: Floats, space: GrowthSpace) -> Mask:
    """Tell which points (m, k, 3) lie in the crown, clear of its surface."""
    return np.asarray(space.inside(paths) & (space.reach(paths) <= WITHIN))


def _near(points: Floats, centre: Floats, reach: float) -> Floats:
    """Keep the points (n, 3) of a cube about a centre (3,): no other is within ``reach``."""
    return np.asarray(points[(np.abs(points - centre) <= reach).all(axis=1)])


def _nearest(points: Floats, others: Floats) -> Floats:
    """Measure each point's (k, 3) distance to the nearest of others (n, 3); infinite without one."""
    squares = np.zeros((len(points), len(others)))
    for axis in range(3):
        away = points[:, axis, None] - others[:, axis]
        squares += np.multiply(away, away, out=away)
    return np.asarray(np.sqrt(squares.min(axis=1, initial=np.inf)))


def _away(skeleton: Skeleton, tip: int, reach: float) -> Indices:
    """List the joints (k,) except those on the last stretch (px) before a tip."""
    arc = path_lengths(skeleton)
    others = np.ones(len(skeleton), dtype=bool)
    joint = tip
    while joint >= 0 and arc[tip] - arc[joint] <= reach:
        others[joint] = False
        joint = int(skeleton.parents[joint])
    return np.flatnonzero(others) if others.any() else np.array([0], dtype=np.int64)


def _appended(skeleton: Skeleton, end: _End, path: Floats) -> Skeleton:
    """Append a path behind a limb's end; the wood tapers along it."""
    first, t = len(skeleton), np.arange(1, len(path) + 1) / len(path)
    radii = skeleton.radii[end.joint] * (1 - (1 - THINNED) * t)
    parents = np.concatenate([[end.joint], np.arange(first, first + len(path) - 1)])
    return Skeleton(
        np.vstack([skeleton.points, path]),
        np.concatenate([skeleton.radii, radii]),
        np.concatenate([skeleton.parents, parents]),
    )
