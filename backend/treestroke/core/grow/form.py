"""Form: from the straight branches of growth to a skeleton with natural curves.

A shoot leaves its bearer partly in the bearer's direction, sags a little and turns up toward its tip (gravitropism
and phototropism as in Weber and Penn 1995, as a cubic curve), and wavers slightly. Its tip stays in place; its base
moves to where the bearer's curve runs.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.vectors import unit
from treestroke.core.grow.branches import Chain
from treestroke.core.grow.growth_space import GrowthSpace, in_mask
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices

UP = np.array([0.0, -1.0, 0.0])
FOLLOW, SAG, RISE = 0.3, 0.22, 0.38
"""How much a shoot's start follows its bearer and sags, and its end rises, relative to its own direction."""
WAVER = 0.035
PIECE_PX = 15.0
MOST_PIECES = 14
MOST_JOINTS = 9000
STRAIGHTER = (1.0, 0.6, 0.3, 0.0)
"""Shares of the bend that are tried until a shoot stays in the crown."""
CHECKS = np.arange(1, 9) / 8


@dataclass(frozen=True, eq=False)
class BranchTable:
    """The branches of growth, bearers first; those of the visible tree come before all shoots.

    Attributes
    ----------
    bearer, fraction
        (b,) the branch that bears each (-1: part of the visible tree) and where on it, 0 to 1.
    tips
        (b, 3) the tips, px.
    born
        (b,) iteration.
    """

    bearer: Indices
    fraction: Floats
    tips: Floats
    born: Indices


class Form(NamedTuple):
    """Joints of the whole tree: points (n, 3) px, parents, born, and the measured radius px, 0 where unknown."""

    points: Floats
    parents: Indices
    born: Indices
    measured: Floats


class _Curves(NamedTuple):
    """Curves by branch: base, chord, two inner controls off the chord, two waves (b, 3)."""

    base: Floats
    chord: Floats
    start: Floats
    end: Floats
    wave: Floats
    ripple: Floats


class _Spots(NamedTuple):
    """Joints on branches: branch (n,), position along it (n,), whether it bears a shoot (n,)."""

    branch: Indices
    along: Floats
    fork: Indices


def curved(
    visible: Skeleton, seen: int, chains: list[Chain], table: BranchTable, crown: GrowthSpace, rng: np.random.Generator
) -> Form:
    """Bend the shoots and join them with the visible tree (px), whose joints stay where they are.

    The first ``seen`` joints of ``visible`` come from the photo; the rest carries its stem on and counts as born in
    the first iteration. Joints of shoots that would leave the foliage are left out.
    """
    curves = _bend(visible, chains, table, crown, rng)
    spots = _spots(table, len(chains), curves, crown.unit)
    return _join(visible, seen, chains, table, curves, spots, crown)


def _bend(
    visible: Skeleton, chains: list[Chain], table: BranchTable, crown: GrowthSpace, rng: np.random.Generator
) -> _Curves:
    """Bend level after level, as a shoot's base lies on its bearer's curve."""
    count = len(table.bearer)
    curves = _Curves(*np.zeros((6, count, 3)))
    level = np.zeros(count, dtype=np.int64)
    for branch in range(len(chains), count):
        level[branch] = level[table.bearer[branch]] + 1
    noise = rng.normal(size=(2, count, 3))
    for depth in range(1, int(level.max(initial=0)) + 1):
        shoots = np.flatnonzero(level == depth)
        bearer, fraction = table.bearer[shoots], table.fraction[shoots]
        on_chain = depth == 1
        base = _on_chains(visible, chains, bearer, fraction) if on_chain else _on_curves(curves, bearer, fraction)
        nearby = np.clip(fraction - 0.05, 0, 0.95)
        ends = [
            _on_chains(visible, chains, bearer, at) if on_chain else _on_curves(curves, bearer, at)
            for at in (nearby, nearby + 0.05)
        ]
        _bend_level(curves, shoots, base, table.tips[shoots], unit(ends[1] - ends[0]), noise[:, shoots])
        _straighten(curves, shoots, crown)
    return curves


def _bend_level(curves: _Curves, shoots: Indices, base: Floats, tips: Floats, bearing: Floats, noise: Floats) -> None:
    """Set the curves of shoots (m,) that leave bearers of the given directions (m, 3)."""
    chord = tips - base
    length, direction = np.sqrt((chord**2).sum(axis=1, keepdims=True)), unit(chord)
    upright = np.abs(direction[:, 1:2])
    start = unit(direction + FOLLOW * bearing - SAG * (1 - upright) * UP)
    end = unit(direction + RISE * (1 - upright) * UP)
    across = noise - (noise * direction).sum(axis=-1, keepdims=True) * direction
    curves.base[shoots], curves.chord[shoots] = base, chord
    curves.start[shoots] = start * length / 3 - chord / 3
    curves.end[shoots] = chord / 3 - end * length / 3
    curves.wave[shoots], curves.ripple[shoots] = across[0] * length * WAVER, across[1] * length * WAVER / 2


def _straighten(curves: _Curves, shoots: Indices, crown: GrowthSpace) -> None:
    """Bend shoots (m,) less where they would leave the crown."""
    share = np.zeros(len(shoots))
    left = np.ones(len(shoots), dtype=bool)
    at = np.tile(CHECKS, len(shoots))
    straight = curves.base[shoots, None] + CHECKS[:, None] * curves.chord[shoots, None]
    bent = _on_curves(curves, np.repeat(shoots, len(CHECKS)), at).reshape(straight.shape)
    for part in STRAIGHTER:
        inside = crown.inside(straight + part * (bent - straight)).all(axis=1)
        share[left & inside] = part
        left &= ~inside
    for offset in curves[2:]:
        offset[shoots] *= share[:, None]


def _on_curves(curves: _Curves, branch: Indices, along: Floats) -> Floats:
    """Evaluate curves: points (n, 3) at positions 0 to 1 along branches (n,)."""
    t = along[:, None]
    bezier = 3 * t * (1 - t) ** 2 * curves.start[branch] + 3 * t**2 * (1 - t) * curves.end[branch]
    waver = np.sin(2 * np.pi * t) * curves.wave[branch] + np.sin(3 * np.pi * t) * curves.ripple[branch]
    return np.asarray(curves.base[branch] + t * curves.chord[branch] + bezier + waver)


def _arc(points: Floats) -> Floats:
    """Give each point's (k, 3) position along its polyline, 0 to 1."""
    arc = np.concatenate([[0.0], np.cumsum(np.sqrt((np.diff(points, axis=0) ** 2).sum(axis=1)))])
    return np.asarray(arc / arc[-1]) if arc[-1] > 0 else np.linspace(0, 1, len(points))


def _on_chains(visible: Skeleton, chains: list[Chain], branch: Indices, along: Floats) -> Floats:
    """Find the points (n, 3) at positions along chains (n,) of the visible tree."""
    found = np.zeros((len(branch), 3))
    for chain in np.unique(branch).tolist():
        points = visible.points[chains[chain].joints]
        arc, those = _arc(points), branch == chain
        for axis in range(3):
            found[those, axis] = np.interp(along[those], arc, points[:, axis])
    return found


def _spots(table: BranchTable, chain_count: int, curves: _Curves, unit: float) -> _Spots:
    """Choose the joints of every shoot: evenly along it, at its tip, and wherever a shoot stands on any branch."""
    shoots = np.arange(chain_count, len(table.bearer))
    length = np.sqrt((curves.chord[shoots] ** 2).sum(axis=1))
    piece = max(PIECE_PX * unit, float(length.sum()) / MOST_JOINTS)
    pieces = np.clip(np.ceil(length / piece), 2, MOST_PIECES).astype(np.int64)
    order = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    even = (order + 1) / np.repeat(pieces, pieces)
    branch = np.concatenate([np.repeat(shoots, pieces), table.bearer[shoots]])
    along = np.concatenate([even, table.fraction[shoots]])
    fork = np.concatenate([np.zeros(len(even), dtype=np.int64), np.ones(len(shoots), dtype=np.int64)])
    order = np.lexsort((-fork, along, branch))
    branch, along, fork = branch[order], along[order], fork[order]
    gap = np.full(len(table.bearer), 0.05)
    gap[shoots] = 0.4 / pieces
    kept = _kept_spots(branch, along, fork, gap)
    return _Spots(branch[kept], along[kept], fork[kept])


def _kept_spots(branch: Indices, along: Floats, fork: Indices, gap: Floats) -> Indices:
    """Keep forks and tips, and of the even joints those that stand clear of both; of equal ones the first."""
    same = np.concatenate([[False], branch[1:] == branch[:-1]])
    before = np.where(same, along - np.concatenate([[0.0], along[:-1]]), np.inf)
    after = np.concatenate([before[1:], [np.inf]])
    fork_before, fork_after = np.concatenate([[0], fork[:-1]]), np.concatenate([fork[1:], [0]])
    near = ((before < gap[branch]) & (fork_before == 1)) | ((after < gap[branch]) & (fork_after == 1))
    twin = before < 1e-9
    return np.flatnonzero(~twin & ((fork == 1) | (along >= 1) | ~near))


def _join(
    visible: Skeleton,
    seen: int,
    chains: list[Chain],
    table: BranchTable,
    curves: _Curves,
    spots: _Spots,
    crown: GrowthSpace,
) -> Form:
    """Put the visible joints, those that shoots need on them, and the shoots' own joints into one tree."""
    on_chain = spots.branch < len(chains)
    chain_spots = _Spots(spots.branch[on_chain], spots.along[on_chain], spots.fork[on_chain])
    trunk, homes = _visible_form(visible, seen, chains, chain_spots)
    branch, along = spots.branch[~on_chain], spots.along[~on_chain]
    points = _on_curves(curves, branch, along)
    keep = in_mask(points, crown.mask)
    parents = _parents(spots, table, homes, keep, len(trunk.points))
    return Form(
        np.vstack([trunk.points, points[keep]]),
        np.concatenate([trunk.parents, parents[keep]]),
        np.concatenate([trunk.born, table.born[branch[keep]]]),
        np.concatenate([trunk.measured, np.zeros(int(keep.sum()))]),
    )


def _parents(spots: _Spots, table: BranchTable, homes: Indices, keep: NDArray[np.bool_], first: int) -> Indices:
    """Find the parent of each joint on a shoot (m,); what stands on a joint that is not kept goes to the one before.

    ``homes`` are the joints at the spots on visible branches, ``first`` is the number of the first shoot's joint.
    """
    branches, along = spots.branch.tolist(), spots.along.tolist()
    joint_at = dict(zip(zip(branches, along, strict=False), homes.tolist(), strict=False))
    bearer, fraction = table.bearer.tolist(), table.fraction.tolist()
    parents, last, branch = [], -1, -1
    for b, t, kept in zip(branches[len(homes) :], along[len(homes) :], keep.tolist(), strict=True):
        if b != branch:
            branch, last = b, joint_at[bearer[b], fraction[b]]
        parents.append(last)
        if kept:
            last, first = first, first + 1
        joint_at[b, t] = last
    return np.array(parents, dtype=np.int64)


def _visible_form(visible: Skeleton, seen: int, chains: list[Chain], spots: _Spots) -> tuple[Form, Indices]:
    """Insert joints on the visible tree; give its form and the joint (m,) that stands at each spot."""
    owner = np.zeros(len(spots.branch), dtype=np.int64)
    share = np.zeros(len(spots.branch))
    for chain in np.unique(spots.branch).tolist():
        those = np.flatnonzero(spots.branch == chain)
        arc = _arc(visible.points[chains[chain].joints])
        segment = np.clip(np.searchsorted(arc, spots.along[those], side="left"), 1, len(arc) - 1)
        owner[those] = chains[chain].joints[segment]
        share[those] = (spots.along[those] - arc[segment - 1]) / np.maximum(arc[segment] - arc[segment - 1], 1e-12)
    return _inserted(visible, seen, owner, np.clip(share, 0, 1))


def _inserted(visible: Skeleton, seen: int, owner: Indices, share: Floats) -> tuple[Form, Indices]:
    """Insert a joint at a share of each owner's edge to its parent; at the edge's ends the joints there serve."""
    joint = np.arange(len(visible))
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
    return Form(points, parents, (end >= seen).astype(np.int64), np.where(known, radii, 0.0)), homes
