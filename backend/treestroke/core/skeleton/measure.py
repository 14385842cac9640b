"""Measures of a Skeleton."""

import numpy as np

from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices


def edge_lengths(skeleton: Skeleton) -> Floats:
    """Return the length of each joint's edge to its parent (n,), in the skeleton's unit (px or metres); 0 at a root."""
    start = skeleton.points[np.maximum(skeleton.parents, 0)]
    lengths = np.linalg.norm(skeleton.points - start, axis=1)
    return np.where(skeleton.parents < 0, 0.0, lengths)


def path_lengths(skeleton: Skeleton) -> Floats:
    """Return the length of the path from the root to each joint (n,), in the skeleton's unit (px or metres)."""
    lengths = edge_lengths(skeleton).tolist()
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0:
            lengths[joint] += lengths[parent]
    return np.array(lengths)


def generations(skeleton: Skeleton, successors: Indices) -> Indices:
    """Return the order of each joint's limb (n,), a count: 0 on a stem, one more where a joint is not the successor.

    ``successors`` (n,) is the index of the child that continues each joint's limb, -1 at a tip.
    """
    order = np.zeros(len(skeleton), dtype=np.int64)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0:
            order[joint] = order[parent] + (successors[parent] != joint)
    return order
