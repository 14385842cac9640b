"""A sketch made ready for depth retrieval: joints evenly spaced, and what the paper says about each branch."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from treestroke.core.geometry.polyline import simplified
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.edit import densified
from treestroke.core.skeleton.measure import edge_lengths, path_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

STRAIGHT = 0.3
"""How far, units, joints may be off a straight piece and yet be left out."""
PLANE = 20.0
"""Units on either side of the stem's two planes in which a limb looks flat."""
BIN, LOWEST, BINS = 8.0, -400.0, 200
"""Heights are counted in bins of 8 units from -400 up; what is beyond falls in the first or the last bin."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """One sketch, in sketch units: x right, y up, the root at the origin, a height of 1000.

    Attributes
    ----------
    points, radii, parents, branch
        (n, 2), (n,), (n,), (n,) its joints, evenly spaced, as in `Branched`.
    lengths
        (n,) of each joint's edge.
    given
        (n,) nearest joint of the sketch as it was given.
    aside
        (n,) distance to the right of the stem at the same height.
    paths
        For each branch the joints from the root to its tip: the descending path p, turned upward.
    bud
        (k,) joint that bears each branch, 0 for the stem.
    level, top
        (k,) level and H of each branch.
    family_top, family_lowest, family_length
        (k,) greatest height M and least height of each branch and its offspring, and the length of them all.
    bins
        (n,) bin of height of each joint.
    """

    points: Floats
    radii: Floats
    parents: Indices
    branch: Indices
    lengths: Floats
    given: Indices
    aside: Floats
    paths: list[Indices]
    bud: Indices
    level: Indices
    top: Floats
    family_top: Floats
    family_lowest: Floats
    family_length: Floats
    bins: Indices

    @cached_property
    def own(self) -> list[Indices]:
        """The joints of each branch without its bud."""
        return [path[self.branch[path] == number] for number, path in enumerate(self.paths)]

    @cached_property
    def arcs(self) -> Floats:
        """Length of the path from the root to each joint (n,)."""
        arcs = np.zeros(len(self.points))
        for joint, parent in enumerate(self.parents.tolist()):
            if parent >= 0:
                arcs[joint] = arcs[parent] + self.lengths[joint]
        return arcs

    @cached_property
    def thickness(self) -> Floats:
        """Radius with which each branch begins (k,)."""
        return np.array([np.max(self.radii[own[:3]]) for own in self.own])

    @cached_property
    def passing(self) -> Mask:
        """Which bins of height each branch passes (k, bins)."""
        return self.lengths_by_height(np.ones(len(self.points), dtype=bool)) > 0

    @cached_property
    def reaching(self) -> Mask:
        """Which bins of height each branch passes to the left or right of the stem (k, bins)."""
        return self.lengths_by_height(~self.flat) > 0

    @cached_property
    def flat(self) -> Mask:
        """Which joints (n,) lie before or behind the stem, so that the other sketch's plane would hold them."""
        return np.asarray(np.abs(self.aside) < PLANE)

    def lengths_by_height(self, chosen: Mask) -> Floats:
        """Sum the lengths of the chosen joints (n,) by branch and bin of height (k, bins)."""
        cell = self.branch * BINS + self.bins
        total = np.bincount(cell, weights=self.lengths * chosen, minlength=len(self.paths) * BINS)
        return np.asarray(total, dtype=np.float64).reshape(len(self.paths), BINS)

    def order(self) -> list[int]:
        """List branches level by level from the stem, in a level the one with the longest family first."""
        return sorted(range(len(self.paths)), key=lambda b: (self.level[b], -self.family_length[b], b))


def sheet(sketch: Branched, step: float) -> Sheet:
    """Space a sketch's joints evenly, at most ``step`` apart, and survey its branches."""
    kept = _bends(sketch)
    place = np.cumsum(kept) - 1
    bearer = _nearest_kept(sketch.skeleton, kept)
    reduced = Skeleton(
        sketch.skeleton.points[kept], sketch.skeleton.radii[kept], place[bearer] * (bearer >= 0) - (bearer < 0)
    )
    dense, owner = densified(reduced, step)
    branch = sketch.branch[kept][owner]
    paths, bud = _paths(dense.parents, branch)
    lengths = edge_lengths(dense)
    level = sketch.levels()
    top, lowest = (
        np.array([pick(dense.points[p[branch[p] == b], 1]) for b, p in enumerate(paths)]) for pick in (np.max, np.min)
    )
    family = np.stack([top, -lowest, np.bincount(branch, weights=lengths)])
    for number in np.argsort(-level, kind="stable").tolist():
        if level[number] > 0:
            host = branch[bud[number]]
            family[:2, host] = np.maximum(family[:2, host], family[:2, number])
            family[2, host] += family[2, number]
    given = _given(sketch, path_lengths(dense), branch)
    bins = np.clip((dense.points[:, 1] - LOWEST) // BIN, 0, BINS - 1).astype(np.int64)
    return Sheet(
        dense.points,
        dense.radii,
        dense.parents,
        branch,
        lengths,
        given,
        _aside(dense.points, paths[0]),
        paths,
        bud,
        level,
        top,
        family[0],
        -family[1],
        family[2],
        bins,
    )


def _bends(sketch: Branched) -> Mask:
    """Tell which joints (n,) are needed: root, tips, buds and bends."""
    kept = np.zeros(len(sketch), dtype=bool)
    buds = {int(chain[0]) for chain in sketch.chains()}
    shape = np.column_stack([sketch.skeleton.points, sketch.skeleton.radii])
    for chain in sketch.chains():
        cuts = [0] + [i for i in range(1, len(chain) - 1) if int(chain[i]) in buds] + [len(chain) - 1]
        for start, end in pairwise(cuts):
            kept[chain[start : end + 1][simplified(shape[chain[start : end + 1]], STRAIGHT)]] = True
        kept[chain[[0, -1]]] = True
    return kept


def _nearest_kept(skeleton: Skeleton, kept: Mask) -> Indices:
    """Find the parent of each kept joint among the kept ones, -1 for the root."""
    nearest = np.full(len(skeleton), -1, dtype=np.int64)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0:
            nearest[joint] = parent if kept[parent] else nearest[parent]
    return nearest[kept]


def _paths(parents: Indices, branch: Indices) -> tuple[list[Indices], Indices]:
    """List each branch's joints from the root to its tip, and its bud."""
    order = np.argsort(branch, kind="stable")
    own = np.split(order, np.flatnonzero(np.diff(branch[order])) + 1)
    bud = np.array([max(int(parents[joints[0]]), 0) for joints in own], dtype=np.int64)
    paths: list[Indices] = [own[0]] * len(own)
    for number in np.argsort([joints[0] for joints in own], kind="stable").tolist():
        if parents[own[number][0]] >= 0:
            bearing = paths[branch[bud[number]]]
            place = int(np.flatnonzero(bearing == bud[number])[0])
            paths[number] = np.concatenate([bearing[: place + 1], own[number]])
    return paths, bud


def _given(sketch: Branched, arcs: Floats, branch: Indices) -> Indices:
    """Find the nearest given joint along each branch for joints at the path lengths ``arcs`` (m,)."""
    given_arcs = path_lengths(sketch.skeleton)
    found = np.zeros(len(arcs), dtype=np.int64)
    for number, chain in enumerate(sketch.chains()):
        mine = branch == number
        after = np.clip(np.searchsorted(given_arcs[chain], arcs[mine]), 1, max(len(chain) - 1, 1))
        after = np.minimum(after, len(chain) - 1)
        before = np.maximum(after - 1, 0)
        nearer = arcs[mine] - given_arcs[chain[before]] < given_arcs[chain[after]] - arcs[mine]
        found[mine] = chain[np.where(nearer, before, after)]
    return found


def _aside(points: Floats, stem: Indices) -> Floats:
    """Measure how far right of the stem each joint lies (n,), above the stem's top of its tip."""
    heights, first = np.unique(np.maximum.accumulate(points[stem, 1]), return_index=True)
    return np.asarray(points[:, 0] - np.interp(points[:, 1], heights, points[stem[first], 0]))
