"""How limbs branch: their angles, lengths and radii by order, and how far those of two trees are apart."""

from typing import NamedTuple

import numpy as np

from treestroke.core.skeleton.measure import edge_lengths, generations, path_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children, limbs
from treestroke.core.types import Floats, Indices

SHORTEST = 0.05
"""Shorter limbs, as a share of the tree's height, are twigs."""
START = 0.25
"""Share of a limb, from its base on, whose direction is compared with its parent limb's."""
BEFORE = 0.03
"""Length of the parent limb before the fork that gives its direction there, as a share of the tree's height."""
QUANTILES = (np.arange(100) + 0.5) / 100


class Branching(NamedTuple):
    """Limbs (k,): order (1 on a stem), angle to the parent limb, degrees, length and radius at the base over its."""

    order: Indices
    angle_deg: Floats
    length_ratio: Floats
    radius_ratio: Floats


def branching(tree: Skeleton) -> Branching:
    """Measure the limbs of a 3D tree; each goes on with the child that bears most wood."""
    successors = heaviest_children(tree, accumulate_to_root(tree, edge_lengths(tree)))
    chains, order, arc = limbs(tree, successors), generations(tree, successors), path_lengths(tree)
    height = float(np.ptp(tree.points[:, 1]))
    first = {int(joint): chain for chain in chains for joint in chain[1:]}
    rows = []
    for chain in chains:
        parent = first.get(int(chain[0]))
        length = arc[chain[-1]] - arc[chain[0]]
        if parent is None or order[chain[-1]] == 0 or length < SHORTEST * height:
            continue
        rows.append(
            (
                order[chain[-1]],
                _angle_deg(_ahead(tree, chain, arc, START * length), _before(tree, chain[0], arc, BEFORE * height)),
                length / (arc[parent[-1]] - arc[parent[0]]),
                tree.radii[chain[1]] / tree.radii[parent[1]],
            )
        )
    found = np.array(rows).reshape(-1, 4)
    return Branching(found[:, 0].astype(np.int64), *found[:, 1:].T)


def distances(found: Branching, true: Branching, order: int) -> dict[str, float]:
    """Return the 1-Wasserstein distances of angle (degrees), length ratio and radius ratio of the limbs of an order."""
    mine, theirs = (np.array(limbs[1:])[:, limbs.order == order] for limbs in (found, true))
    apart = np.abs(np.quantile(mine, QUANTILES, axis=1) - np.quantile(theirs, QUANTILES, axis=1)).mean(axis=0)
    return dict(zip(Branching._fields[1:], apart.tolist(), strict=True))


def _ahead(tree: Skeleton, chain: Indices, arc: Floats, reach: float) -> Floats:
    """Return the way (3,) from a limb's base to the first joint at least ``reach`` along it."""
    far = int(np.searchsorted(arc[chain] - arc[chain[0]], reach))
    return np.asarray(tree.points[chain[max(far, 1)]] - tree.points[chain[0]])


def _before(tree: Skeleton, fork: int, arc: Floats, reach: float) -> Floats:
    """Return the way (3,) to a fork from the last joint at least ``reach`` before it, or else from the root."""
    joint = int(fork)
    while tree.parents[joint] >= 0 and arc[fork] - arc[joint] < reach:
        joint = int(tree.parents[joint])
    return np.asarray(tree.points[fork] - tree.points[joint])


def _angle_deg(one: Floats, other: Floats) -> float:
    lengths = np.linalg.norm(one) * np.linalg.norm(other)
    return float(np.degrees(np.arccos(np.clip(one @ other / max(lengths, 1e-12), -1, 1))))
