"""The forks of a tree as bifurcations: a limb that goes on, and one that leaves it.

A fork of more than two is several bifurcations of the same limb. Of a joint's children the one that carries the most
wood goes on.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.skeleton.measure import edge_lengths, generations, path_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children, limbs
from treestroke.core.types import Floats, Indices

SHORTEST = 0.04
"""Shorter limbs, as a share of the tree's height, are twigs: growth adds them to siblings as to any tree."""
START = 0.25
"""Share of a limb, from its base on, whose direction counts at the fork."""
AROUND = 0.03
"""Length of the limb before and after a fork that gives its directions there, as a share of the tree's height."""


@dataclass(frozen=True, eq=False)
class Limb:
    """A limb of an example.

    Attributes
    ----------
    points
        (m, 3) its joints from the fork on, metres.
    radii
        (m,) its radii, metres; at the fork that of its first own joint.
    order
        0 for a stem, 1 for what leaves it.
    """

    points: Floats
    radii: Floats
    order: int


@dataclass(frozen=True, eq=False)
class Bifurcations:
    """Bifurcations of a tree, n in all, each with the limb that leaves.

    Attributes
    ----------
    order
        (n,) order of the limb that leaves.
    angles_rad
        (n, 3) angle between the limb before and after the fork, between that after it and the one that leaves, and
        between this and the limb before it (paper: theta).
    lengths
        (n, 3) length of the limb up to the fork, of its rest, and of the limb that leaves, metres (paper: L).
    rise
        (n,) sine of the angle to the ground at which it leaves.
    radius_ratio
        (n,) its radius at its base over that of the limb that it leaves.
    limb
        (n,) index of it, and
    parent
        (n,) of the limb that it leaves, in `limbs`.
    limbs
        All limbs that are long enough, stems first.
    """

    order: Indices
    angles_rad: Floats
    lengths: Floats
    rise: Floats
    radius_ratio: Floats
    limb: Indices
    parent: Indices
    limbs: tuple[Limb, ...]


def bifurcations(tree: Skeleton) -> Bifurcations:
    """Find the bifurcations of a 3D tree, metres, whose limbs are both long enough."""
    successors = heaviest_children(tree, accumulate_to_root(tree, edge_lengths(tree)))
    order, arc = generations(tree, successors), path_lengths(tree)
    height = float(np.ptp(tree.points[:, 1]))
    chains = sorted(limbs(tree, successors), key=lambda chain: (order[chain[-1]], int(chain[0])))
    long_ones = [c for c in chains if order[c[-1]] == 0 or arc[c[-1]] - arc[c[0]] >= SHORTEST * height]
    owner = {
        int(joint): number for number, chain in enumerate(long_ones) for joint in chain[int(order[chain[-1]] > 0) :]
    }
    rows = []
    for number, chain in enumerate(long_ones):
        parent = owner.get(int(chain[0]), -1)
        if order[chain[-1]] == 0 or parent < 0:
            continue
        rows.append((number, parent, *_fork(tree, arc, long_ones[parent], chain, AROUND * height)))
    found = np.array(rows, dtype=np.float64).reshape(-1, 10)
    index = found[:, :2].astype(np.int64)
    kept = tuple(_limb(tree, chain, int(order[chain[-1]])) for chain in long_ones)
    orders = np.array([kept[limb].order for limb in index[:, 0]], dtype=np.int64)
    return Bifurcations(orders, found[:, 2:5], found[:, 5:8], found[:, 8], found[:, 9], index[:, 0], index[:, 1], kept)


def _fork(tree: Skeleton, arc: Floats, parent: Indices, chain: Indices, around: float) -> list[float]:
    """Measure a fork: its three angles, three lengths, the rise and the radius ratio of the limb that leaves."""
    base, place = int(chain[0]), arc[chain[0]]
    at = int(np.flatnonzero(parent == base)[0])
    start = np.flatnonzero(arc[parent] <= place - around)
    end = np.flatnonzero(arc[parent] >= place + around)
    before = tree.points[base] - tree.points[parent[start[-1] if len(start) else 0]]
    after = tree.points[parent[end[0] if len(end) else -1]] - tree.points[base]
    length = arc[chain[-1]] - place
    out = tree.points[chain[max(1, int(np.searchsorted(arc[chain] - place, START * length)))]] - tree.points[base]
    if at == 0:
        before = after
    elif at == len(parent) - 1:
        after = before
    angles = [angle_rad(-before, after), angle_rad(after, out), angle_rad(out, -before)]
    lengths = [place - arc[parent[0]], arc[parent[-1]] - place, length]
    rise = float(out[1] / max(float(np.linalg.norm(out)), 1e-9))
    return [*angles, *lengths, rise, float(tree.radii[chain[1]] / max(float(tree.radii[base]), 1e-9))]


def angle_rad(one: Floats, other: Floats) -> float:
    """Return the angle between two directions (3,), radians."""
    lengths = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(np.arccos(np.clip(float(one @ other) / max(lengths, 1e-12), -1.0, 1.0)))


def _limb(tree: Skeleton, chain: Indices, order: int) -> Limb:
    radii = tree.radii[chain].copy()
    if order > 0 and len(radii) > 1:
        radii[0] = radii[1]
    return Limb(tree.points[chain], radii, order)
