"""Bones for a tree that the wind moves: the limbs that much hangs on get one, the largest several.

A limb's k-th bone is worth the limb's weight over k squared, for what is left of a bend falls with the square of the
number of straight pieces that stand for it.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.skeleton.measure import edge_lengths, path_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children, limbs
from treestroke.core.sway.wind import Rig
from treestroke.core.types import Floats, Indices

MOST_BRANCHES = 48
"""Bones at most, the root's with them: what a phone skins without effort, leaves' flutter on top."""
MOST_FLUTTERS = 16
_MOST_ON_A_LIMB = 8
_STILL = 0.03  # of a stem's length at its base, where nothing moves
_RAMP = 0.6  # of a bone's length, over which wood goes over from the bone before to this one: a bend, not a kink
_SHORTEST_RAMP = 0.15
_FLUTTER_AT = 0.25  # of its bone's length, where a flutter bone starts


@dataclass(frozen=True, eq=False)
class _Cuts:
    """Where limbs are cut into bones, in ascending order of ``starts``.

    Attributes
    ----------
    starts, heads, ends
        (c,) joint whose edge is a bone's first, the joint before it, and where the bone ends.
    """

    starts: Indices
    heads: Indices
    ends: Indices


def rig_of(skeleton: Skeleton, leaf_joints: Indices | None) -> Rig:
    """Put bones into a tree (metres, world): one that stands still, branches, and flutter where most leaves hang.

    Each joint goes over from its bone's parent to the bone on a smooth ramp along the way from the bone's head, so
    that wood bends and side twigs follow what bears them. A branch bone is as thick as the wood that leaves its head.

    Parameters
    ----------
    leaf_joints
        (m,) the joint that each leaf hangs at, or None for a bare tree, which has no flutter bones.
    """
    hung = np.empty(0, dtype=np.int64) if leaf_joints is None else leaf_joints
    cuts = _cuts(skeleton, np.bincount(hung, minlength=len(skeleton)).astype(np.float64))
    owner = _owners(skeleton, cuts)
    parents = np.append(-1, owner[cuts.heads])
    share = _shares(skeleton, cuts, parents, owner)
    heads, ends = (skeleton.points[np.append(0, joints)] for joints in (cuts.heads, cuts.ends))
    bearing = _bearing(np.bincount(owner[hung], minlength=len(parents)), heads, ends)
    return Rig(
        names=_names(len(parents), len(bearing)),
        parents=np.append(parents, bearing),
        heads=np.concatenate([heads, heads[bearing] + _FLUTTER_AT * (ends - heads)[bearing]]),
        ends=np.concatenate([ends, ends[bearing]]),
        radii=np.concatenate([skeleton.radii[:1], skeleton.radii[cuts.starts], np.zeros(len(bearing))]),
        joint_bones=np.stack([np.maximum(parents, 0)[owner], owner], axis=1),
        joint_share=share,
        flutter=_flutter(parents, bearing),
    )


def _cuts(skeleton: Skeleton, leaves: Floats) -> _Cuts:
    """Cut the weightiest limbs into bones."""
    wood = edge_lengths(skeleton)
    hanging = accumulate_to_root(skeleton, wood / max(wood.sum(), 1e-9) + leaves / max(leaves.sum(), 1.0))
    way = path_lengths(skeleton)
    chains = [chain for chain in limbs(skeleton, heaviest_children(skeleton, skeleton.radii)) if len(chain) > 1]
    lengths = np.array([way[chain[-1]] - way[chain[0]] for chain in chains])
    worth = lengths * hanging[[int(chain[1]) for chain in chains]] if chains else lengths
    found = [
        cut
        for chain, seats in zip(chains, _seats(worth).tolist(), strict=True)
        for cut in _pieces(chain, way[chain] - way[chain[0]], seats, skeleton.parents[chain[0]] < 0)
    ]
    table = np.array(sorted(found), dtype=np.int64).reshape(-1, 3)
    return _Cuts(*table.T)


def _seats(worth: Floats) -> Indices:
    """Share out bones among limbs (k,) by what each further one is worth; limbs without worth get none."""
    order = np.arange(1, _MOST_ON_A_LIMB + 1)
    value = (worth[:, None] / order**2).reshape(-1)
    best = np.argsort(-value, kind="stable")[: MOST_BRANCHES - 1]
    return np.bincount(best[value[best] > 0] // _MOST_ON_A_LIMB, minlength=len(worth)).astype(np.int64)


def _pieces(chain: Indices, along: Floats, seats: int, stem: bool) -> list[tuple[int, int, int]]:
    """Cut a limb into about equal bones: the start, head and end of each. A stem's first starts above the ground."""
    target = along[-1] * np.arange(seats) / max(seats, 1)
    if stem:
        target = np.maximum(target, _STILL * along[-1])
    at = np.minimum(np.searchsorted(along, target - 1e-9), len(chain) - 2)
    at = np.unique(at)
    ends = np.append(at[1:], len(chain) - 1)
    return [(int(chain[i + 1]), int(chain[i]), int(chain[end])) for i, end in zip(at, ends, strict=False)]


def _owners(skeleton: Skeleton, cuts: _Cuts) -> Indices:
    """Give the bone (n,) that each joint belongs to: that of the nearest start on its way to the root."""
    owner = np.zeros(len(skeleton), dtype=np.int64)
    owner[cuts.starts] = np.arange(1, len(cuts.starts) + 1)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if owner[joint] == 0 and parent >= 0:
            owner[joint] = owner[parent]
    return owner


def _shares(skeleton: Skeleton, cuts: _Cuts, parents: Indices, owner: Indices) -> Floats:
    """Give how far each joint (n,) follows its own bone; the rest follows the bone's parent.

    A ramp ends before the next bone on it starts, as long as that leaves it some length.
    """
    way = path_lengths(skeleton)
    start = np.append(0.0, way[cuts.heads])
    length = np.append(1.0, way[cuts.ends] - way[cuts.heads])
    free = np.full(len(parents), np.inf)
    np.minimum.at(free, parents[1:], start[1:] - start[parents[1:]])
    ramp = np.clip(free, _SHORTEST_RAMP * length, _RAMP * length)
    t = np.clip((way - start[owner]) / np.maximum(ramp[owner], 1e-9), 0.0, 1.0)
    return np.where(owner > 0, t * t * (3.0 - 2.0 * t), 0.0)


def _bearing(leaves: Indices, heads: Floats, ends: Floats) -> Indices:
    """Choose the bones that bear most of the leaves (b,), in ascending order; those without length bear none."""
    counts = np.where(np.linalg.norm(ends - heads, axis=1) > 1e-6, leaves, 0)
    best = np.argsort(-counts, kind="stable")[:MOST_FLUTTERS]
    return np.sort(best[counts[best] > 0])


def _flutter(parents: Indices, bearing: Indices) -> Indices:
    """Name each bone's flutter bone, its own or that of the nearest ancestor; flutter bones have none."""
    found = np.full(len(parents) + len(bearing), -1, dtype=np.int64)
    found[bearing] = len(parents) + np.arange(len(bearing))
    for bone in range(1, len(parents)):
        if found[bone] < 0:
            found[bone] = found[parents[bone]]
    return found


def _names(branches: int, flutters: int) -> tuple[str, ...]:
    """Name the root, the branches after it and the flutter bones."""
    branch = [f"branch_{number:02d}" for number in range(1, branches)]
    return ("root", *branch, *(f"flutter_{number:02d}" for number in range(1, flutters + 1)))
