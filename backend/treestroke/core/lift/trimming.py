"""The woven tree made light: without ends that show nothing new, and with no more joints than its bends need."""

import numpy as np

from treestroke.core.geometry.polyline import simplified
from treestroke.core.lift.path_pairs import Weave
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

TOLERANCE = 0.5
"""How far, units, a joint may be off a straight piece and yet be left out."""

STANDS = 8.0
"""How far, units, a joint may be from a sheet's joint and yet stand for it."""


def trimmed(weave: Weave) -> tuple[Branched, Indices, Indices]:
    """Turn a weave into a branched skeleton.

    Returns
    -------
    The tree; (2, n) the joint of each sheet that a joint stands for; (n,) origins.
    """
    points, parents = np.array(weave.points), np.array(weave.parents)
    joints, origins = np.array(weave.joints).T, np.array(weave.origins)
    walks = np.array(weave.walks)
    kept = _needed(weave, points, joints, parents, walks)
    after = _successors(parents, walks, kept)
    branch = _branches(parents, after, kept)
    kept &= _bends(points, parents, after, origins, kept)
    return _gathered(points, parents, branch, kept), joints[:, kept], origins[kept]


def _needed(weave: Weave, points: Floats, joints: Indices, parents: Indices, walks: Indices) -> Mask:
    """Drop ends whose every joint stands for what others stand for too, the latest first; the stem stays."""
    kept = np.ones(len(parents), dtype=bool)
    children = np.bincount(parents[1:], minlength=len(parents))
    stands = [
        np.hypot(*(points[:, [axis, 1]] - sheet.points[each]).T) <= STANDS
        for axis, sheet, each in zip((0, 2), weave.sheets, joints, strict=True)
    ]
    counts = [np.bincount(each, weights=at).tolist() for each, at in zip(joints, stands, strict=True)]
    for joint in range(len(parents) - 1, 0, -1):
        mine = [(count, int(each[joint])) for count, each, at in zip(counts, joints, stands, strict=True) if at[joint]]
        if walks[joint] > 0 and children[joint] == 0 and all(count[each] > 1 for count, each in mine):
            kept[joint] = False
            children[parents[joint]] -= 1
            for count, each in mine:
                count[each] -= 1
    return kept


def _successors(parents: Indices, walks: Indices, kept: Mask) -> Indices:
    """Give the joint with which each joint's branch goes on (n,), -1 at a tip: of its own walk, else the first one."""
    after = np.full(len(parents), -1, dtype=np.int64)
    for joint in range(len(parents) - 1, 0, -1):
        parent = parents[joint]
        own = walks[joint] == walks[parent]
        if kept[joint] and (
            own or (walks[parent] > 0 and (after[parent] < 0 or walks[after[parent]] != walks[parent]))
        ):
            after[parent] = joint
    return after


def _branches(parents: Indices, after: Indices, kept: Mask) -> Indices:
    """Give branches numbers (n,) in the order in which they begin."""
    branch = np.zeros(len(parents), dtype=np.int64)
    count = 0
    for joint in range(1, len(parents)):
        if kept[joint] and after[parents[joint]] == joint:
            branch[joint] = branch[parents[joint]]
        elif kept[joint]:
            count += 1
            branch[joint] = count
    return branch


def _bends(points: Floats, parents: Indices, after: Indices, origins: Indices, kept: Mask) -> Mask:
    """Tell which joints (n,) are buds, ends, bends or where the origin changes."""
    needed = np.zeros(len(parents), dtype=bool)
    needed[0] = True
    needed[np.unique(parents[1:][kept[1:] & (after[parents[1:]] != np.arange(1, len(parents)))])] = True
    needed[1:] |= (after[1:] >= 0) & (origins[after[1:]] != origins[1:])
    needed |= kept & (after < 0)
    for joint in np.flatnonzero(needed & kept).tolist():
        chain = [joint]
        while parents[chain[-1]] >= 0 and (len(chain) == 1 or not needed[chain[-1]]):
            if after[parents[chain[-1]]] != chain[-1]:
                break
            chain.append(int(parents[chain[-1]]))
        way = np.array(chain)
        needed[way[simplified(points[way], TOLERANCE)]] = True
    return needed


def _gathered(points: Floats, parents: Indices, branch: Indices, kept: Mask) -> Branched:
    """Build the skeleton of the kept joints."""
    bearer = np.full(len(parents), -1, dtype=np.int64)
    for joint in range(1, len(parents)):
        parent = int(parents[joint])
        bearer[joint] = parent if kept[parent] else bearer[parent]
    place = np.cumsum(kept) - 1
    chosen = bearer[kept]
    skeleton = Skeleton(points[kept, :3], points[kept, 3], np.where(chosen < 0, -1, place[chosen]))
    return Branched(skeleton, branch[kept])
