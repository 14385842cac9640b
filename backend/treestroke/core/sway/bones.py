"""Bones for a tree that the wind moves: one for each limb that carries much, several for the largest.

A limb's k-th bone has the limb's value over k squared, since the error of replacing a bend by straight pieces falls
with the square of their number.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.skeleton.measure import edge_lengths, path_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children, limbs
from treestroke.core.sway.motion import Rig
from treestroke.core.types import Floats, Indices

MOST_BRANCHES = 48
"""Greatest number of bones in the wood, with the root: what a phone skins easily, with flutter bones on top."""
MOST_FLUTTERS = 16
MOST_MEASURED = 224
"""The same where motion was measured: with flutter bones, what a byte can name."""
_MOST_ON_A_LIMB = 8
_STILL = 0.03  # share of a stem's length, from its base, in which nothing moves
_RAMP = 0.6  # of a bone's length, over which weights blend from the bone before to this one: a bend, not a kink
_SHORTEST_RAMP = 0.15
_FLUTTER_AT = 0.25  # of its bone's length: the place where a flutter bone starts


@dataclass(frozen=True, eq=False)
class _Cuts:
    """The joints at which limbs are cut into bones, in ascending order of ``starts``.

    Attributes
    ----------
    starts, heads, ends
        (c,) index of the joint whose edge is a bone's first, of the joint before it, and of that where the bone ends.
    """

    starts: Indices
    heads: Indices
    ends: Indices


def rig_of(skeleton: Skeleton, leaf_joints: Indices | None, most: int = MOST_BRANCHES, *, tips: bool = False) -> Rig:
    """Rig a skeleton (metres, world): a root that stands still, branch bones, and flutter bones where most leaves hang.

    The weights of joints blend from the bone's parent to the bone on a smooth ramp from the bone's head on, so that
    wood bends, and side twigs follow the wood they grow from. A branch bone is as thick as the wood that leaves its
    head.

    Parameters
    ----------
    leaf_joints
        (m,) index of the joint that each leaf hangs at, or None for a bare tree, which has no flutter bones.
    most
        Greatest number of bones in the wood, with the root.
    tips
        Whether a bone without weight marks the end of each last bone of a branch: programs that show bones as lines
        from joint to joint need it.

    Notes
    -----
    Why bones, how many, and why they only turn: docs/decisions/0012.
    """
    hung = np.empty(0, dtype=np.int64) if leaf_joints is None else leaf_joints
    cuts = _cuts(skeleton, np.bincount(hung, minlength=len(skeleton)).astype(np.float64), most)
    owner = _owners(skeleton, cuts)
    parents = np.append(-1, owner[cuts.heads])
    share = _shares(skeleton, cuts, parents, owner)
    heads, ends = (skeleton.points[np.append(0, joints)] for joints in (cuts.heads, cuts.ends))
    leafy = _leafiest(np.bincount(owner[hung], minlength=len(parents)), heads, ends)
    last = np.setdiff1d(np.arange(1, len(parents)), parents) if tips else np.empty(0, dtype=np.int64)
    ended = np.zeros(len(last))
    return Rig(
        names=_names(len(parents), len(leafy), len(last)),
        parents=np.concatenate([parents, leafy, last]),
        heads=np.concatenate([heads, heads[leafy] + _FLUTTER_AT * (ends - heads)[leafy], ends[last]]),
        ends=np.concatenate([ends, ends[leafy], ends[last]]),
        radii=np.concatenate([skeleton.radii[:1], skeleton.radii[cuts.starts], np.zeros(len(leafy)), ended]),
        joint_bones=np.stack([np.maximum(parents, 0)[owner], owner], axis=1),
        joint_share=share,
        flutter=np.append(_flutter(parents, leafy), np.full(len(last), -1, dtype=np.int64)),
        extent=max(float(np.ptp(skeleton.points, axis=0).max()), 1e-6),
    )


def _cuts(skeleton: Skeleton, leaves: Floats, most: int) -> _Cuts:
    """Cut the limbs of greatest value into bones: length times the share of wood and leaves (n,) that they carry."""
    wood = edge_lengths(skeleton)
    carried = accumulate_to_root(skeleton, wood / max(wood.sum(), 1e-9) + leaves / max(leaves.sum(), 1.0))
    distance = path_lengths(skeleton)
    paths = [path for path in limbs(skeleton, heaviest_children(skeleton, skeleton.radii)) if len(path) > 1]
    lengths = np.array([distance[path[-1]] - distance[path[0]] for path in paths])
    value = lengths * carried[[int(path[1]) for path in paths]] if paths else lengths
    found = [
        cut
        for path, count in zip(paths, _bone_counts(value, most).tolist(), strict=True)
        for cut in _bones_of_limb(path, distance[path] - distance[path[0]], count, skeleton.parents[path[0]] < 0)
    ]
    table = np.array(sorted(found), dtype=np.int64).reshape(-1, 3)
    return _Cuts(*table.T)


def _bone_counts(value: Floats, most: int) -> Indices:
    """Distribute bones among limbs (k,) by the value of each further one; limbs of value 0 get none."""
    order = np.arange(1, _MOST_ON_A_LIMB + 1)
    of_bones = (value[:, None] / order**2).reshape(-1)
    best = np.argsort(-of_bones, kind="stable")[: most - 1]
    return np.bincount(best[of_bones[best] > 0] // _MOST_ON_A_LIMB, minlength=len(value)).astype(np.int64)


def _bones_of_limb(path: Indices, along: Floats, count: int, stem: bool) -> list[tuple[int, int, int]]:
    """Cut a limb into about equal bones: (start, head, end) of each. The first of a stem starts above the ground."""
    target = along[-1] * np.arange(count) / max(count, 1)
    if stem:
        target = np.maximum(target, _STILL * along[-1])
    at = np.minimum(np.searchsorted(along, target - 1e-9), len(path) - 2)
    at = np.unique(at)
    ends = np.append(at[1:], len(path) - 1)
    return [(int(path[i + 1]), int(path[i]), int(path[end])) for i, end in zip(at, ends, strict=False)]


def _owners(skeleton: Skeleton, cuts: _Cuts) -> Indices:
    """Return the index (n,) of each joint's bone: the one that starts nearest to it on the path to the root."""
    owner = np.zeros(len(skeleton), dtype=np.int64)
    owner[cuts.starts] = np.arange(1, len(cuts.starts) + 1)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if owner[joint] == 0 and parent >= 0:
            owner[joint] = owner[parent]
    return owner


def _shares(skeleton: Skeleton, cuts: _Cuts, parents: Indices, owner: Indices) -> Floats:
    """Return the weight (n,), 0 to 1, of each joint's own bone; the rest is that of the bone's parent.

    A ramp ends before the next bone starts, if that leaves it at least 15 % of the bone's length.
    """
    distance = path_lengths(skeleton)
    start = np.append(0.0, distance[cuts.heads])
    length = np.append(1.0, distance[cuts.ends] - distance[cuts.heads])
    free = np.full(len(parents), np.inf)
    np.minimum.at(free, parents[1:], start[1:] - start[parents[1:]])
    ramp = np.clip(free, _SHORTEST_RAMP * length, _RAMP * length)
    t = np.clip((distance - start[owner]) / np.maximum(ramp[owner], 1e-9), 0.0, 1.0)
    return np.where(owner > 0, t * t * (3.0 - 2.0 * t), 0.0)


def _leafiest(leaves: Indices, heads: Floats, ends: Floats) -> Indices:
    """Return the ascending index of the bones with most leaves, by counts (b,), but for bones without length."""
    counts = np.where(np.linalg.norm(ends - heads, axis=1) > 1e-6, leaves, 0)
    best = np.argsort(-counts, kind="stable")[:MOST_FLUTTERS]
    return np.sort(best[counts[best] > 0])


def _flutter(parents: Indices, leafy: Indices) -> Indices:
    """Return the index of each bone's flutter bone, its own or that of the nearest ancestor; flutter bones have -1."""
    found = np.full(len(parents) + len(leafy), -1, dtype=np.int64)
    found[leafy] = len(parents) + np.arange(len(leafy))
    for bone in range(1, len(parents)):
        if found[bone] < 0:
            found[bone] = found[parents[bone]]
    return found


def _names(branches: int, flutters: int, tips: int) -> tuple[str, ...]:
    """Name the root, the branches after it, the flutter bones and the tips."""
    branch = [f"branch_{number:02d}" for number in range(1, branches)]
    flutter = [f"flutter_{number:02d}" for number in range(1, flutters + 1)]
    return ("root", *branch, *flutter, *(f"tip_{number:02d}" for number in range(1, tips + 1)))
