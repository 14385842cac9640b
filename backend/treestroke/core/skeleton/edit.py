"""New skeletons from old ones."""

import numpy as np

from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Indices


def densified(skeleton: Skeleton, step: float) -> tuple[Skeleton, Indices]:
    """Put joints on every edge, evenly and at most ``step`` apart; radii go over linearly.

    Returns
    -------
    The skeleton, and for each of its m joints the old joint (m,) at whose edge it lies.
    """
    pieces = np.maximum(np.ceil(edge_lengths(skeleton) / step), 1).astype(np.int64)
    last = np.cumsum(pieces) - 1
    owner = np.repeat(np.arange(len(skeleton)), pieces)
    order = np.arange(len(owner)) - (last - pieces + 1)[owner]
    share = ((order + 1) / pieces[owner])[:, None]
    bearer = np.maximum(skeleton.parents, 0)[owner]
    points = skeleton.points[bearer] + share * (skeleton.points[owner] - skeleton.points[bearer])
    radii = skeleton.radii[bearer] + share[:, 0] * (skeleton.radii[owner] - skeleton.radii[bearer])
    root = skeleton.parents[owner] < 0
    first = np.where(root, -1, last[bearer])
    parents = np.where(order == 0, first, np.arange(len(owner)) - 1)
    points[root], radii[root] = skeleton.points[owner[root]], skeleton.radii[owner[root]]
    return Skeleton(points, radii, parents), owner
