"""Points of the cloud told apart: on branches or on leaves."""

from collections.abc import Sequence

import numpy as np

from treestroke.core.capture import PointCloud, Shot, TreeMatte
from treestroke.core.types import Mask


def is_branch(cloud: PointCloud, shots: Sequence[Shot], mattes: Sequence[TreeMatte]) -> Mask:
    """Tell which points (n,) lie on wood: by what the shots that see them show there, in the mean.

    Source: Tan et al. 2007, section 5, "using color and position": the mattes' wood was told by colour and place.
    """
    wood, count = np.zeros(len(cloud)), np.zeros(len(cloud))
    for number, (shot, matte) in enumerate(zip(shots, mattes, strict=True)):
        column, row = np.floor(shot.camera.pixels_from_world(cloud.points)).astype(np.int64).T
        height, width = matte.wood.shape
        seen = cloud.seen[:, number] & (column >= 0) & (column < width) & (row >= 0) & (row < height)
        wood[seen] += matte.wood[row[seen], column[seen]]
        count += seen
    return np.asarray(wood > 0.5 * np.maximum(count, 1))
