"""From the straight branches of growth to a skeleton with natural curves.

A shoot leaves its parent partly in the parent's direction, sags a little and turns up toward its tip (gravitropism
and phototropism as in Weber and Penn 1995, but as a cubic Bezier curve), and waves slightly. Its tip stays
in place; its base moves onto the parent's curve.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.grow.branches import Chain
from treestroke.core.grow.growth_space import GrowthSpace, in_mask
from treestroke.core.grow.habit import UNSTEERED, Habit
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

UP_IN_PICTURE = UP * np.array([1.0, -1.0, 1.0])
"""The world's `UP` in the picture frame (px: x right, y down, z toward the viewer)."""
FOLLOW = 0.3
"""Weight of the parent's direction at a shoot's start, relative to 1 for the shoot's own."""
WAVE = 0.035
"""Amplitude of a shoot's waves (standard deviation), as a share of its length."""
PIECE_PX, MAX_PIECES = 15.0, 14
"""Length of a piece of a shoot, px of a crown 1,000 px wide, and greatest number of pieces of a shoot."""
MAX_JOINTS = 9000
"""Approximate number of joints on shoots above which pieces become longer."""
BEND_SHARES = (1.0, 0.6, 0.3, 0.0)
"""Shares of the bend that are tried, in this order, until a shoot stays in the crown."""
CHECKS = np.arange(1, 9) / 8
"""Places along a shoot, 0 to 1, where it must lie in the crown."""


@dataclass(frozen=True, eq=False)
class BranchTable:
    """The branches of growth, parents first; those of the visible tree come before all shoots.

    Attributes
    ----------
    parent, fraction
        (b,) index of each branch's parent (-1: part of the visible tree) and where on it the branch begins, 0 to 1.
    tips
        (b, 3) tips, px.
    born
        (b,) iteration in which each grew.
    """

    parent: Indices
    fraction: Floats
    tips: Floats
    born: Indices


@dataclass(frozen=True, eq=False)
class VisibleTree:
    """The visible tree as growth sees it.

    Attributes
    ----------
    skeleton
        3D, px of the crown's frame.
    traced_count
        Number of its first joints that come from the photo; the others extend its stem.
    chains
        Its pieces, which are the first branches of growth.
    """

    skeleton: Skeleton
    traced_count: int
    chains: list[Chain]


class Form(NamedTuple):
    """Joints of the whole tree: points (n, 3), px; parents, iteration and measured radius (n,), px, 0 if unknown."""

    points: Floats
    parents: Indices
    born: Indices
    measured: Floats


class _Curves(NamedTuple):
    """Curves by branch (b, 3), px: base, chord, the two inner control points' offsets from the chord, two waves."""

    base: Floats
    chord: Floats
    start: Floats
    end: Floats
    wave: Floats
    ripple: Floats


class _Spots(NamedTuple):
    """Joints on branches (n,): branch, position along it (0 to 1), and 1 where a shoot begins, else 0."""

    branch: Indices
    along: Floats
    fork: Indices


def curve_shoots(
    visible: VisibleTree,
    table: BranchTable,
    space: GrowthSpace,
    rng: np.random.Generator,
    habit: Habit = UNSTEERED,
) -> Form:
    """Bend the shoots as the tree's habit has it and join them with the visible tree, whose joints stay where they are.

    Joints that extend the visible stem count as grown in the first iteration. Joints of shoots that would leave the
    foliage are left out.
    """
    curves = _bend(visible, table, space, rng, habit)
    spots = _spots(table, len(visible.chains), curves, space.unit)
    return _join(visible, table, curves, spots, space.mask)


def _bend(
    visible: VisibleTree, table: BranchTable, space: GrowthSpace, rng: np.random.Generator, habit: Habit
) -> _Curves:
    """Bend level after level, as a shoot's base lies on its parent's curve."""
    count = len(table.parent)
    curves = _Curves(*np.zeros((6, count, 3)))
    level = np.zeros(count, dtype=np.int64)
    for branch in range(len(visible.chains), count):
        level[branch] = level[table.parent[branch]] + 1
    noise = rng.normal(size=(2, count, 3))
    for depth in range(1, int(level.max(initial=0)) + 1):
        shoots = np.flatnonzero(level == depth)
        parent, fraction = table.parent[shoots], table.fraction[shoots]
        nearby = np.clip(fraction - 0.05, 0, 0.95)
        base, before, after = (
            _on_chains(visible, parent, at) if depth == 1 else _on_curves(curves, parent, at)
            for at in (fraction, nearby, nearby + 0.05)
        )
        curves.base[shoots], curves.chord[shoots] = base, table.tips[shoots] - base
        _bend_level(curves, shoots, unit(after - before), noise[:, shoots], habit)
        _straighten(curves, shoots, space)
    return curves


def _bend_level(curves: _Curves, shoots: Indices, parent_direction: Floats, noise: Floats, habit: Habit) -> None:
    """Set the bend of shoots (m,) with a known base and chord that leave parents in unit directions (m, 3)."""
    chord = curves.chord[shoots]
    length, direction = np.sqrt((chord**2).sum(axis=1, keepdims=True)), unit(chord)
    upright = np.abs(direction[:, 1:2])
    start = unit(direction + FOLLOW * parent_direction - habit.sag * (1 - upright) * UP_IN_PICTURE)
    end = unit(direction + habit.turn_up * (1 - upright) * UP_IN_PICTURE)
    across = noise - (noise * direction).sum(axis=-1, keepdims=True) * direction
    curves.start[shoots] = start * length / 3 - chord / 3
    curves.end[shoots] = chord / 3 - end * length / 3
    curves.wave[shoots], curves.ripple[shoots] = across[0] * length * WAVE, across[1] * length * WAVE / 2


def _straighten(curves: _Curves, shoots: Indices, space: GrowthSpace) -> None:
    """Bend shoots (m,) less where they would leave the crown."""
    share = np.zeros(len(shoots))
    left = np.ones(len(shoots), dtype=bool)
    at = np.tile(CHECKS, len(shoots))
    straight = curves.base[shoots, None] + CHECKS[:, None] * curves.chord[shoots, None]
    bent = _on_curves(curves, np.repeat(shoots, len(CHECKS)), at).reshape(straight.shape)
    for part in BEND_SHARES:
        inside = space.inside(straight + part * (bent - straight)).all(axis=1)
        share[left & inside] = part
        left &= ~inside
    for offset in curves[2:]:
        offset[shoots] *= share[:, None]


def _on_curves(curves: _Curves, branch: Indices, along: Floats) -> Floats:
    """Return the points (n, 3), px, at positions 0 to 1 along the curves of branches (n,)."""
    t = along[:, None]
    bezier = 3 * t * (1 - t) ** 2 * curves.start[branch] + 3 * t**2 * (1 - t) * curves.end[branch]
    waves = np.sin(2 * np.pi * t) * curves.wave[branch] + np.sin(3 * np.pi * t) * curves.ripple[branch]
    return np.asarray(curves.base[branch] + t * curves.chord[branch] + bezier + waves)


def _arc(points: Floats) -> Floats:
    """Return the position (k,), 0 to 1, of each point (k, 3) along its polyline."""
    arc = np.concatenate([[0.0], np.cumsum(np.sqrt((np.diff(points, axis=0) ** 2).sum(axis=1)))])
    return np.asarray(arc / arc[-1]) if arc[-1] > 0 else np.linspace(0, 1, len(points))


def _on_chains(visible: VisibleTree, branch: Indices, along: Floats) -> Floats:
    """Return the points (n, 3), px, at positions 0 to 1 along chains (n,) of the visible tree."""
    found = np.zeros((len(branch), 3))
    for chain in np.unique(branch).tolist():
        points = visible.skeleton.points[visible.chains[chain].joints]
        arc, those = _arc(points), branch == chain
        for axis in range(3):
            found[those, axis] = np.interp(along[those], arc, points[:, axis])
    return found


def _spots(table: BranchTable, chain_count: int, curves: _Curves, unit: float) -> _Spots:
    """Choose the joints of every shoot: evenly along it, at its tip, and wherever a shoot begins on any branch."""
    shoots = np.arange(chain_count, len(table.parent))
    length = np.sqrt((curves.chord[shoots] ** 2).sum(axis=1))
    piece = max(PIECE_PX * unit, float(length.sum()) / MAX_JOINTS)
    pieces = np.clip(np.ceil(length / piece), 2, MAX_PIECES).astype(np.int64)
    order = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    even = (order + 1) / np.repeat(pieces, pieces)
    branch = np.concatenate([np.repeat(shoots, pieces), table.parent[shoots]])
    along = np.concatenate([even, table.fraction[shoots]])
    fork = np.concatenate([np.zeros(len(even), dtype=np.int64), np.ones(len(shoots), dtype=np.int64)])
    order = np.lexsort((-fork, along, branch))
    branch, along, fork = branch[order], along[order], fork[order]
    gap = np.full(len(table.parent), 0.05)
    gap[shoots] = 0.4 / pieces
    kept = _kept_spots(branch, along, fork, gap)
    return _Spots(branch[kept], along[kept], fork[kept])


def _kept_spots(branch: Indices, along: Floats, fork: Indices, gap: Floats) -> Indices:
    """Return the indices of the forks and tips, and of the even joints apart from both; of equal ones the first."""
    same = np.concatenate([[False], branch[1:] == branch[:-1]])
    before = np.where(same, along - np.concatenate([[0.0], along[:-1]]), np.inf)
    after = np.concatenate([before[1:], [np.inf]])
    fork_before, fork_after = np.concatenate([[0], fork[:-1]]), np.concatenate([fork[1:], [0]])
    near = ((before < gap[branch]) & (fork_before == 1)) | ((after < gap[branch]) & (fork_after == 1))
    twin = before < 1e-9
    return np.flatnonzero(~twin & ((fork == 1) | (along >= 1) | ~near))


def _join(visible: VisibleTree, table: BranchTable, curves: _Curves, spots: _Spots, foliage: Mask) -> Form:
    """Join the visible joints, those that shoots need on them, and the shoots' own joints to one tree."""
    on_chain = spots.branch < len(visible.chains)
    chain_spots = _Spots(spots.branch[on_chain], spots.along[on_chain], spots.fork[on_chain])
    trunk, homes = _visible_form(visible, chain_spots)
    branch, along = spots.branch[~on_chain], spots.along[~on_chain]
    points = _on_curves(curves, branch, along)
    keep = in_mask(points, foliage)
    parents = _parents(spots, table, homes, keep, len(trunk.points))
    return Form(
        np.vstack([trunk.points, points[keep]]),
        np.concatenate([trunk.parents, parents[keep]]),
        np.concatenate([trunk.born, table.born[branch[keep]]]),
        np.concatenate([trunk.measured, np.zeros(int(keep.sum()))]),
    )


def _parents(spots: _Spots, table: BranchTable, homes: Indices, keep: Mask, first: int) -> Indices:
    """Return the parent of each joint on a shoot (m,); the nearest kept joint before it, where that one is not kept.

    ``homes`` are the joints at the spots on visible branches, ``first`` is the index of the first shoot's first joint.
    """
    branches, along = spots.branch.tolist(), spots.along.tolist()
    joint_at = dict(zip(zip(branches, along, strict=False), homes.tolist(), strict=False))
    parent_branch, fraction = table.parent.tolist(), table.fraction.tolist()
    parents, last, branch = [], -1, -1
    for b, t, kept in zip(branches[len(homes) :], along[len(homes) :], keep.tolist(), strict=True):
        if b != branch:
            branch, last = b, joint_at[parent_branch[b], fraction[b]]
        parents.append(last)
        if kept:
            last, first = first, first + 1
        joint_at[b, t] = last
    return np.array(parents, dtype=np.int64)


def _visible_form(visible: VisibleTree, spots: _Spots) -> tuple[Form, Indices]:
    """Insert joints on the visible tree; return its form and the joint (m,) at each spot."""
    owner = np.zeros(len(spots.branch), dtype=np.int64)
    share = np.zeros(len(spots.branch))
    for chain in np.unique(spots.branch).tolist():
        those = np.flatnonzero(spots.branch == chain)
        joints = visible.chains[chain].joints
        arc = _arc(visible.skeleton.points[joints])
        segment = np.clip(np.searchsorted(arc, spots.along[those], side="left"), 1, len(arc) - 1)
        owner[those] = joints[segment]
        share[those] = (spots.along[those] - arc[segment - 1]) / np.maximum(arc[segment] - arc[segment - 1], 1e-12)
    return _insert(visible, owner, np.clip(share, 0, 1))


def _insert(tree: VisibleTree, owner: Indices, share: Floats) -> tuple[Form, Indices]:
    """Insert a joint at a share (m,) of each owner's edge from its parent; at an edge's ends, use the joint there.

    Returns the form and the joint (m,) at each share.
    """
    visible, joint = tree.skeleton, np.arange(len(tree.skeleton))
    new = np.flatnonzero((share > 1e-6) & (share < 1 - 1e-6))
    edge = np.concatenate([joint, owner[new]])
    place = np.concatenate([np.ones(len(joint)), share[new]])
    order = np.lexsort((place, edge))
    number = np.empty(len(edge), dtype=np.int64)
    number[order] = np.arange(len(edge))
    start, end = visible.parents[edge[order]], edge[order]
    first = np.concatenate([[True], end[1:] != end[:-1]])
    parents = np.where(first, np.where(start < 0, -1, number[np.maximum(start, 0)]), np.arange(len(edge)) - 1)
    part = place[order]
    start = np.where(start < 0, end, start)
    points = visible.points[start] + part[:, None] * (visible.points[end] - visible.points[start])
    points[part == 1] = visible.points[end[part == 1]]
    radii = visible.radii[start] + part * (visible.radii[end] - visible.radii[start])
    known = (visible.radii[start] > 0) & (visible.radii[end] > 0)
    homes = np.where(share >= 0.5, number[owner], number[np.maximum(visible.parents[owner], 0)])
    homes[new] = number[len(joint) :]
    return Form(points, parents, (end >= tree.traced_count).astype(np.int64), np.where(known, radii, 0.0)), homes
