"""A sketch prepared for depth retrieval: evenly spaced joints and the paper's features of each branch."""

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
"""Joints within this distance, units, of a straight piece are left out before resampling."""
PLANE = 20.0
"""Half thickness, units, of the slab about the stem in which a joint counts as flat."""
BIN, LOWEST, BINS = 8.0, -400.0, 200
"""Height bins: size and lower end of the first, units, and their number; the outer bins also take what is beyond."""


@dataclass(frozen=True, eq=False)
class SketchTree:
    """One sketch, in sketch units: x right, y up, the root at the origin, a height of 1000.

    n joints, k branches. Symbols are those of the two-sketches paper, section 3.

    Attributes
    ----------
    points, radii, parents, branch
        (n, 2), (n,), (n,), (n,) evenly spaced joints, as in `Branched`.
    lengths
        (n,) length of each joint's edge, units.
    source_joint
        (n,) index of the nearest joint of the original sketch.
    aside
        (n,) signed distance to the right of the stem at the same height, units.
    paths
        For each branch the joints from the root to its tip: the descending path p, in upward order.
    bud
        (k,) joint from which each branch goes out, 0 for the stem.
    level, top
        (k,) level of each branch and its greatest height H, units.
    family_top, family_lowest, family_length
        (k,) greatest height M, least height and total length of each branch with its offspring, units.
    height_bin
        (n,) index of each joint's height bin.
    """

    points: Floats
    radii: Floats
    parents: Indices
    branch: Indices
    lengths: Floats
    source_joint: Indices
    aside: Floats
    paths: list[Indices]
    bud: Indices
    level: Indices
    top: Floats
    family_top: Floats
    family_lowest: Floats
    family_length: Floats
    height_bin: Indices

    @cached_property
    def branch_joints(self) -> list[Indices]:
        """Indices of each branch's joints (m,) without its bud."""
        return [path[self.branch[path] == number] for number, path in enumerate(self.paths)]

    @cached_property
    def arcs(self) -> Floats:
        """Path length from the root to each joint (n,); unit: 1/1000 of the tree's height."""
        arcs = np.zeros(len(self.points))
        for joint, parent in enumerate(self.parents.tolist()):
            if parent >= 0:
                arcs[joint] = arcs[parent] + self.lengths[joint]
        return arcs

    @cached_property
    def thickness(self) -> Floats:
        """Radius (k,) at the beginning of each branch, 0 where unknown; unit: 1/1000 of the tree's height."""
        return np.array([np.max(self.radii[joints[:3]]) for joints in self.branch_joints])

    @cached_property
    def passing(self) -> Mask:
        """Boolean mask (k, bins) of the height bins that each branch passes."""
        return self.lengths_by_height(np.ones(len(self.points), dtype=bool)) > 0

    @cached_property
    def reaching(self) -> Mask:
        """Boolean mask (k, bins) of the height bins that each branch passes outside the slab about the stem."""
        return self.lengths_by_height(~self.flat) > 0

    @cached_property
    def flat(self) -> Mask:
        """Mask (n,) of the joints so close to the stem that the tree would lie in the other sketch's plane."""
        return np.asarray(np.abs(self.aside) < PLANE)

    def lengths_by_height(self, chosen: Mask) -> Floats:
        """Sum the edge lengths, units, of the joints in a mask (n,) by branch and height bin (k, bins)."""
        cell = self.branch * BINS + self.height_bin
        total = np.bincount(cell, weights=self.lengths * chosen, minlength=len(self.paths) * BINS)
        return np.asarray(total, dtype=np.float64).reshape(len(self.paths), BINS)

    def order(self) -> list[int]:
        """List the branches level by level from the stem, within a level the one with the longest family first."""
        return sorted(range(len(self.paths)), key=lambda b: (self.level[b], -self.family_length[b], b))


def prepare_sketch(sketch: Branched, step: float) -> SketchTree:
    """Resample a sketch (n joints, sketch units) to joints at most ``step`` units apart and measure its branches."""
    kept = _bends(sketch)
    number = np.cumsum(kept) - 1
    parent = _kept_parents(sketch.skeleton, kept)
    reduced = Skeleton(
        sketch.skeleton.points[kept], sketch.skeleton.radii[kept], number[parent] * (parent >= 0) - (parent < 0)
    )
    dense, owner = densified(reduced, step)
    branch = sketch.branch[kept][owner]
    paths, bud = _paths(dense.parents, branch)
    lengths, level = edge_lengths(dense), sketch.levels()
    top, family = _heights(dense, branch, paths, bud, level)
    return SketchTree(
        dense.points,
        dense.radii,
        dense.parents,
        branch,
        lengths,
        _source_joints(sketch, path_lengths(dense), branch),
        _aside(dense.points, paths[0]),
        paths,
        bud,
        level,
        top,
        family[0],
        -family[1],
        family[2],
        np.clip((dense.points[:, 1] - LOWEST) // BIN, 0, BINS - 1).astype(np.int64),
    )


def _heights(
    dense: Skeleton, branch: Indices, paths: list[Indices], bud: Indices, level: Indices
) -> tuple[Floats, Floats]:
    """Return each branch's top (k,), and its family's top, negated lowest height and length (3, k), units."""
    top, lowest = (
        np.array([pick(dense.points[p[branch[p] == b], 1]) for b, p in enumerate(paths)]) for pick in (np.max, np.min)
    )
    family = np.stack([top, -lowest, np.bincount(branch, weights=edge_lengths(dense))])
    for number in np.argsort(-level, kind="stable").tolist():
        if level[number] > 0:
            parent = branch[bud[number]]
            family[:2, parent] = np.maximum(family[:2, parent], family[:2, number])
            family[2, parent] += family[2, number]
    return top, family


def _bends(sketch: Branched) -> Mask:
    """Return a mask (n,) of the joints that define the shape: root, tips, buds and bends."""
    kept = np.zeros(len(sketch), dtype=bool)
    buds = {int(chain[0]) for chain in sketch.chains()}
    shape = np.column_stack([sketch.skeleton.points, sketch.skeleton.radii])
    for chain in sketch.chains():
        cuts = [0] + [i for i in range(1, len(chain) - 1) if int(chain[i]) in buds] + [len(chain) - 1]
        for start, end in pairwise(cuts):
            kept[chain[start : end + 1][simplified(shape[chain[start : end + 1]], STRAIGHT)]] = True
        kept[chain[[0, -1]]] = True
    return kept


def _kept_parents(skeleton: Skeleton, kept: Mask) -> Indices:
    """Return the nearest kept ancestor of each kept joint (m,), -1 for the root."""
    nearest = np.full(len(skeleton), -1, dtype=np.int64)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0:
            nearest[joint] = parent if kept[parent] else nearest[parent]
    return nearest[kept]


def _paths(parents: Indices, branch: Indices) -> tuple[list[Indices], Indices]:
    """Return for each branch the joints from the root to its tip, and its bud (k,)."""
    order = np.argsort(branch, kind="stable")
    joints_by_branch = np.split(order, np.flatnonzero(np.diff(branch[order])) + 1)
    bud = np.array([max(int(parents[joints[0]]), 0) for joints in joints_by_branch], dtype=np.int64)
    paths: list[Indices] = [joints_by_branch[0]] * len(joints_by_branch)
    for number in np.argsort([joints[0] for joints in joints_by_branch], kind="stable").tolist():
        if parents[joints_by_branch[number][0]] >= 0:
            parent_path = paths[branch[bud[number]]]
            place = int(np.flatnonzero(parent_path == bud[number])[0])
            paths[number] = np.concatenate([parent_path[: place + 1], joints_by_branch[number]])
    return paths, bud


def _source_joints(sketch: Branched, arcs: Floats, branch: Indices) -> Indices:
    """Return the nearest original joint on the same branch for joints at path lengths ``arcs`` (m,)."""
    source_arcs = path_lengths(sketch.skeleton)
    found = np.zeros(len(arcs), dtype=np.int64)
    for number, chain in enumerate(sketch.chains()):
        mine = branch == number
        after = np.clip(np.searchsorted(source_arcs[chain], arcs[mine]), 1, max(len(chain) - 1, 1))
        after = np.minimum(after, len(chain) - 1)
        before = np.maximum(after - 1, 0)
        nearer = arcs[mine] - source_arcs[chain[before]] < source_arcs[chain[after]] - arcs[mine]
        found[mine] = chain[np.where(nearer, before, after)]
    return found


def _aside(points: Floats, stem: Indices) -> Floats:
    """Return how far right of the stem each joint lies (n,), units; above the stem, right of its tip."""
    heights, first = np.unique(np.maximum.accumulate(points[stem, 1]), return_index=True)
    return np.asarray(points[:, 0] - np.interp(points[:, 1], heights, points[stem[first], 0]))
