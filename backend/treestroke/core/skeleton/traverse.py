"""Traversals of a Skeleton."""

import numpy as np

from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices


def children(skeleton: Skeleton) -> list[list[int]]:
    """List the indices of each joint's children, in ascending order."""
    found: list[list[int]] = [[] for _ in range(len(skeleton))]
    for child, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0:
            found[parent].append(child)
    return found


def child_counts(skeleton: Skeleton) -> Indices:
    """Return the number of each joint's children (n,)."""
    return np.bincount(skeleton.parents[skeleton.parents >= 0], minlength=len(skeleton)).astype(np.int64)


def accumulate_to_root(skeleton: Skeleton, values: Floats) -> Floats:
    """Return the sums (n,) of values (n,), any unit, over each joint and all its descendants."""
    total = values.astype(np.float64).tolist()
    parents = skeleton.parents.tolist()
    for joint in range(len(skeleton) - 1, 0, -1):
        if parents[joint] >= 0:
            total[parents[joint]] += total[joint]
    return np.array(total)


def heaviest_children(skeleton: Skeleton, weights: Floats) -> Indices:
    """Return the index (n,) of each joint's child of greatest weight (n,), the first among equals; -1 at a tip."""
    best, weight = [-1] * len(skeleton), weights.tolist()
    for child, parent in reversed(list(enumerate(skeleton.parents.tolist()))):
        if parent >= 0 and (best[parent] < 0 or weight[child] >= weight[best[parent]]):
            best[parent] = child
    return np.array(best, dtype=np.int64)


def limbs(skeleton: Skeleton, successors: Indices) -> list[Indices]:
    """Split the skeleton into limbs: chains of joint indices (m,) that follow ``successors`` (n,) until a tip.

    Each limb that is not a stem begins with the joint of another limb that it leaves, so limbs share only their forks
    and together contain every edge once. Limbs come in the order of their first own joint.
    """
    parents, following = skeleton.parents.tolist(), successors.tolist()
    starts = [joint for joint, parent in enumerate(parents) if parent < 0 or following[parent] != joint]
    found = []
    for start in starts:
        chain, after = [start] if parents[start] < 0 else [parents[start], start], following[start]
        while after >= 0:
            chain.append(after)
            after = following[after]
        found.append(np.array(chain, dtype=np.int64))
    return found
