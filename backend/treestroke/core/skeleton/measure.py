"""Measures of a Skeleton."""

import numpy as np

from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices


def edge_lengths(skeleton: Skeleton) -> Floats:
    """Length of each joint's edge to its parent (n,); 0 at a root."""
    start = skeleton.points[np.maximum(skeleton.parents, 0)]
    lengths = np.linalg.norm(skeleton.points - start, axis=1)
    return np.where(skeleton.parents < 0, 0.0, lengths)


def path_lengths(skeleton: Skeleton) -> Floats:
    """Length of the way from the root to each joint (n,)."""
    lengths = edge_lengths(skeleton)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0:
            lengths[joint] += lengths[parent]
    return lengths


def generations(skeleton: Skeleton, successors: Indices) -> Indices:
    """Order of each joint's limb (n,): 0 on a stem, one more each time a joint is not its parent's successor."""
    order = np.zeros(len(skeleton), dtype=np.int64)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0:
            order[joint] = order[parent] + (successors[parent] != joint)
    return order
