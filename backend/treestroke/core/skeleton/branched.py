"""A skeleton that is split into branches."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import limbs
from treestroke.core.types import Indices


@dataclass(frozen=True, eq=False)
class Branched:
    """A skeleton of one stem, split into branches.

    ========  ================================================================================
    word      meaning
    ========  ================================================================================
    branch    a chain of joints, each the parent of the next; branch 0 begins at the root
    bud       the joint of another branch from which a branch goes out
    tip       its last joint
    level     0 for the stem, one more than that of its parent, the branch of its bud
    ========  ================================================================================

    Attributes
    ----------
    skeleton
        n joints in two or three dimensions, with one root; a radius is 0 where it is unknown.
    branch
        (n,) index of each joint's branch, 0 to k - 1; a bud belongs to the parent branch.

    Raises
    ------
    ValueError
        There are several roots, or a branch is not a chain.
    """

    skeleton: Skeleton
    branch: Indices

    def __post_init__(self) -> None:
        branch = np.array(self.branch, dtype=np.int64)
        parents = self.skeleton.parents
        if branch.shape != parents.shape or branch[0] != 0 or (parents[1:] < 0).any():
            raise ValueError("a branched skeleton has one root, of branch 0, and a branch for each joint")
        follows = np.append(False, branch[1:] == branch[parents[1:]])
        starts = np.sort(branch[~follows])
        if len(np.unique(parents[follows])) != follows.sum() or not np.array_equal(starts, np.arange(len(starts))):
            raise ValueError("each branch must be one chain of joints")
        branch.flags.writeable = False
        object.__setattr__(self, "branch", branch)

    def __len__(self) -> int:
        return len(self.skeleton)

    def chains(self) -> list[Indices]:
        """List the joint indices (m,) of each branch: its bud (the stem has none), then its joints up to the tip."""
        order = np.argsort(self.branch, kind="stable")
        by_branch = np.split(order, np.flatnonzero(np.diff(self.branch[order])) + 1)
        buds = [self.skeleton.parents[joints[:1]] for joints in by_branch]
        return [np.concatenate([bud[bud >= 0], joints]) for bud, joints in zip(buds, by_branch, strict=True)]

    def levels(self) -> Indices:
        """Return the level (k,) of each branch, a count: 0 for the stem."""
        level = np.zeros(int(self.branch.max()) + 1, dtype=np.int64)
        for joint, parent in enumerate(self.skeleton.parents.tolist()):
            if parent >= 0 and self.branch[joint] != self.branch[parent]:
                level[self.branch[joint]] = level[self.branch[parent]] + 1
        return level

    def path(self, joint: int) -> Indices:
        """Return the joint indices (m,) from the root to a joint."""
        path = [joint]
        while self.skeleton.parents[path[-1]] >= 0:
            path.append(int(self.skeleton.parents[path[-1]]))
        return np.array(path[::-1], dtype=np.int64)


def branched(skeleton: Skeleton, successors: Indices) -> Branched:
    """Split a skeleton into the limbs that follow ``successors`` (n,), indices; further stems branch from joint 0."""
    parents = np.where((skeleton.parents < 0) & (np.arange(len(skeleton)) > 0), 0, skeleton.parents)
    branch = np.zeros(len(skeleton), dtype=np.int64)
    for number, limb in enumerate(limbs(skeleton, successors)):
        is_stem = skeleton.parents[limb[0]] < 0 and (len(limb) == 1 or successors[limb[0]] == limb[1])
        branch[limb if is_stem else limb[1:]] = number
    return Branched(Skeleton(skeleton.points, skeleton.radii, parents), branch)
