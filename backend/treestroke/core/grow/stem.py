"""The first stem: where it enters the crown, and how it goes on to the crown's top."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.outline_volume import Sections
from treestroke.core.grow.branches import successors_by_wood
from treestroke.core.grow.growth_space import in_mask
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices

JOINT_SHARE = 0.02
"""Distance between the joints of an extended stem, as a share of the crown's height."""
SLACK = 0.03
"""Share of the crown's height above the highest joint up to which extending is tried."""


def stem_of(skeleton: Skeleton) -> Indices:
    """List the joints (k,), indices, of the first stem from its root to its tip, which is its highest joint."""
    successors = successors_by_wood(skeleton)
    joints = [0]
    while successors[joints[-1]] >= 0:
        joints.append(int(successors[joints[-1]]))
    return np.array(joints, dtype=np.int64)


def foot_of(skeleton: Skeleton, mask: NDArray[np.bool_]) -> Floats:
    """Find where the first stem (px) enters the foliage (h, w): (3,), px; its tip where it never does."""
    stem = stem_of(skeleton)
    inside = in_mask(skeleton.points[stem], mask)
    return np.array(skeleton.points[stem[int(np.argmax(inside)) if inside.any() else -1]])


def with_leader(skeleton: Skeleton, mask: NDArray[np.bool_], sections: Sections, share: float) -> Skeleton:
    """Extend the first stem (px) to a share of the height of the foliage (h, w), unless a joint reaches that height.

    It goes straight to the middle of the crown's section there, or of one as near to that height as it can without
    leaving the foliage once it is inside. The new joints have radius 0: unknown.
    """
    rows = np.flatnonzero(mask.any(axis=1))
    height = float(rows[-1] - rows[0] + 1)
    highest = (rows[-1] + 1 - float(skeleton.points[:, 1].min())) / height
    stem = stem_of(skeleton)
    for aim in np.arange(share, highest + SLACK, -0.05):
        y = rows[-1] + 1 - aim * height
        row = int(np.clip(y, 0, len(mask) - 1))
        top = np.array([sections.middle_px[row], y, sections.near_px[row]])
        points = _straight_line(skeleton.points[stem[-1]], top, JOINT_SHARE * height)
        inside = in_mask(points, mask)
        if inside.any() and inside[int(np.argmax(inside)) :].all():
            return _with_joints(skeleton, int(stem[-1]), points)
    return skeleton


def _straight_line(start: Floats, end: Floats, step: float) -> Floats:
    """Place points (k, 3), px, at most ``step`` apart from ``start`` to ``end``, without the start."""
    count = max(int(np.ceil(np.sqrt(((end - start) ** 2).sum()) / step)), 1)
    return start + (end - start) * (np.arange(1, count + 1) / count)[:, None]


def _with_joints(skeleton: Skeleton, tip: int, points: Floats) -> Skeleton:
    """Append joints at points (k, 3), px, of unknown radius after a tip."""
    first = len(skeleton)
    parents = np.concatenate([[tip], np.arange(first, first + len(points) - 1)])
    return Skeleton(
        np.vstack([skeleton.points, points]),
        np.concatenate([skeleton.radii, np.zeros(len(points))]),
        np.concatenate([skeleton.parents, parents]),
    )
