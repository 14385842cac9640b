"""Functions that return a changed skeleton."""

import numpy as np

from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Indices, Mask


def densified(skeleton: Skeleton, step: float) -> tuple[Skeleton, Indices]:
    """Insert joints on every edge, evenly and at most ``step`` (the skeleton's unit) apart; radii change linearly.

    Returns
    -------
    The skeleton with m joints, and for each the index (m,) of the old joint on whose edge it lies.
    """
    pieces = np.maximum(np.ceil(edge_lengths(skeleton) / step), 1).astype(np.int64)
    last = np.cumsum(pieces) - 1
    owner = np.repeat(np.arange(len(skeleton)), pieces)
    order = np.arange(len(owner)) - (last - pieces + 1)[owner]
    share = ((order + 1) / pieces[owner])[:, None]
    start = np.maximum(skeleton.parents, 0)[owner]
    points = skeleton.points[start] + share * (skeleton.points[owner] - skeleton.points[start])
    radii = skeleton.radii[start] + share[:, 0] * (skeleton.radii[owner] - skeleton.radii[start])
    root = skeleton.parents[owner] < 0
    first = np.where(root, -1, last[start])
    parents = np.where(order == 0, first, np.arange(len(owner)) - 1)
    points[root], radii[root] = skeleton.points[owner[root]], skeleton.radii[owner[root]]
    return Skeleton(points, radii, parents), owner


def subskeleton(skeleton: Skeleton, kept: Mask) -> tuple[Skeleton, Indices]:
    """Select joints by a mask (n,) that marks the parent of every marked joint, except of roots.

    Returns
    -------
    The skeleton of these joints in the same unit, and their index (m,) in the whole one, ascending.
    """
    joints, number = np.flatnonzero(kept), np.cumsum(kept) - 1
    parents = skeleton.parents[joints]
    part = Skeleton(skeleton.points[joints], skeleton.radii[joints], np.where(parents < 0, -1, number[parents]))
    return part, joints
