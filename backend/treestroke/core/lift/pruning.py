"""Pruning of the retrieved tree: no ends that show nothing new, and no more joints than its bends need."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.polyline import simplified
from treestroke.core.lift.path_pairs import PathTrie
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

TOLERANCE = 0.5
"""Joints within this distance, units, of a straight piece are left out."""
REPRESENTS = 8.0
"""A joint represents a sketch's joint within this distance, units."""


@dataclass(frozen=True, eq=False)
class _Joints:
    """The trie's joints as arrays: points (n, 4), joints (2, n), parents, origins and path pair number (n,)."""

    points: Floats
    joints: Indices
    parents: Indices
    origins: Indices
    pair_number: Indices


def prune(trie: PathTrie) -> tuple[Branched, Indices, Indices]:
    """Turn a trie into a branched skeleton with as few joints as possible.

    Returns
    -------
    The tree, in sketch units; (2, n) index of each sketch's joint that a joint represents; (n,) origins.
    """
    tree = _Joints(
        np.array(trie.points),
        np.array(trie.joints).T,
        np.array(trie.parents),
        np.array(trie.origins),
        np.array(trie.pair_number),
    )
    kept = _needed(trie, tree)
    successor = _successors(tree, kept)
    branch = _branches(tree.parents, successor, kept)
    kept &= _bends(tree, successor, kept)
    return _skeleton_of(tree, branch, kept), tree.joints[:, kept], tree.origins[kept]


def _needed(trie: PathTrie, tree: _Joints) -> Mask:
    """Return a mask (n,) without the ends, latest first, whose joints are represented elsewhere; the stem stays."""
    kept = np.ones(len(tree.parents), dtype=bool)
    children = np.bincount(tree.parents[1:], minlength=len(tree.parents))
    represents = [
        np.hypot(*(tree.points[:, [axis, 1]] - sketch.points[each]).T) <= REPRESENTS
        for axis, sketch, each in zip((0, 2), trie.sketches, tree.joints, strict=True)
    ]
    counts = [np.bincount(each, weights=near).tolist() for each, near in zip(tree.joints, represents, strict=True)]
    views = list(zip(counts, tree.joints, represents, strict=True))
    for joint in range(len(tree.parents) - 1, 0, -1):
        mine = [(count, int(each[joint])) for count, each, near in views if near[joint]]
        is_end = tree.pair_number[joint] > 0 and children[joint] == 0
        if is_end and all(count[each] > 1 for count, each in mine):
            kept[joint] = False
            children[tree.parents[joint]] -= 1
            for count, each in mine:
                count[each] -= 1
    return kept


def _successors(tree: _Joints, kept: Mask) -> Indices:
    """Return the joint with which each joint's branch goes on (n,), -1 at a tip: its own pair's, else the first."""
    number, successor = tree.pair_number, np.full(len(tree.parents), -1, dtype=np.int64)
    for joint in range(len(tree.parents) - 1, 0, -1):
        parent = tree.parents[joint]
        same = number[joint] == number[parent]
        free = number[parent] > 0 and (successor[parent] < 0 or number[successor[parent]] != number[parent])
        if kept[joint] and (same or free):
            successor[parent] = joint
    return successor


def _branches(parents: Indices, successor: Indices, kept: Mask) -> Indices:
    """Return the branch number of each joint (n,); branches count in the order in which they begin."""
    branch = np.zeros(len(parents), dtype=np.int64)
    count = 0
    for joint in range(1, len(parents)):
        if kept[joint] and successor[parents[joint]] == joint:
            branch[joint] = branch[parents[joint]]
        elif kept[joint]:
            count += 1
            branch[joint] = count
    return branch


def _bends(tree: _Joints, successor: Indices, kept: Mask) -> Mask:
    """Return a mask (n,) of the joints that are buds, ends, bends, or where the origin changes."""
    points, parents, origins = tree.points, tree.parents, tree.origins
    needed = np.zeros(len(parents), dtype=bool)
    needed[0] = True
    needed[np.unique(parents[1:][kept[1:] & (successor[parents[1:]] != np.arange(1, len(parents)))])] = True
    needed[1:] |= (successor[1:] >= 0) & (origins[successor[1:]] != origins[1:])
    needed |= kept & (successor < 0)
    for joint in np.flatnonzero(needed & kept).tolist():
        chain = [joint]
        while parents[chain[-1]] >= 0 and (len(chain) == 1 or not needed[chain[-1]]):
            if successor[parents[chain[-1]]] != chain[-1]:
                break
            chain.append(int(parents[chain[-1]]))
        joints = np.array(chain)
        needed[joints[simplified(points[joints], TOLERANCE)]] = True
    return needed


def _skeleton_of(tree: _Joints, branch: Indices, kept: Mask) -> Branched:
    """Build the skeleton of the kept joints, each joined to its nearest kept ancestor."""
    ancestor = np.full(len(tree.parents), -1, dtype=np.int64)
    for joint in range(1, len(tree.parents)):
        parent = int(tree.parents[joint])
        ancestor[joint] = parent if kept[parent] else ancestor[parent]
    number, chosen = np.cumsum(kept) - 1, ancestor[kept]
    parents = np.where(chosen < 0, -1, number[chosen])
    return Branched(Skeleton(tree.points[kept, :3], tree.points[kept, 3], parents), branch[kept])
