"""Growth of a bare tree whose wood was all traced: nothing grows that the photo does not show."""

import numpy as np

from treestroke.core.grow.grown import Grown
from treestroke.core.skeleton.skeleton import Skeleton


def grown_as_traced(skeleton: Skeleton, hidden: int, reached: float) -> Grown:
    """Return a lifted tree (3D, metres, measured radii) as grown; its last joints, ``hidden`` of them, count as grown.

    No joint is thicker than its parent. ``reached`` is the share of the crown that lies near its wood.
    """
    radii = skeleton.radii.copy()
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0:
            radii[joint] = min(radii[joint], radii[parent])
    born = (np.arange(len(radii)) >= len(radii) - hidden).astype(np.int64)
    choices = np.empty((0, 3), dtype=np.int64)
    return Grown(Skeleton(skeleton.points, radii, skeleton.parents), born, choices, reached)
