"""Which bones each vertex of a mesh follows, and by how much."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import Hold, Mesh
from treestroke.core.sway.stiffness import softness
from treestroke.core.sway.wind import Rig, Skin
from treestroke.core.types import Floats, Indices

FLUTTER = 0.5
"""How much a leaf's outer corners follow the flutter bone of their own bone; its inner ones hold to the wood."""
FURTHER_FLUTTER = 0.15
"""The same where only a bone nearer to the root has one: more would tear at cards when the bones between turn."""
_GOLDEN = 0.6180339887498949
_OUTER = np.array([False, False, True, True])  # corners of a card


def skin(rig: Rig, mesh: Mesh, *, leaves: bool) -> Skin:
    """Bind a mesh that holds to the rig's skeleton; ``leaves`` says that its vertices are cards', four each.

    A vertex between two joints mixes what they follow. Weights are whole 255ths; sway and phase vary smoothly along
    the wood.

    Raises
    ------
    ValueError
        The mesh does not say where it holds.
    """
    if mesh.hold is None:
        raise ValueError("a mesh that holds to nothing cannot follow bones")
    bones, weights = _held(rig, mesh.hold)
    if leaves:
        bones, weights = _fluttering(rig, mesh.hold, bones, weights)
    bones, weights = _four_best(bones, weights)
    whole = _whole(weights)
    swayed = _sway(rig, mesh.positions.astype(np.float64), bones, weights)
    phase = (weights * _phases(rig)[bones]).sum(axis=1)
    kept = np.where(whole > 0, bones, 0).astype(np.uint8)
    return Skin(kept, whole, swayed.astype(np.float32), phase.astype(np.float32))


def _held(rig: Rig, hold: Hold) -> tuple[Indices, Floats]:
    """Give the bones and weights (v, 4) of the joints on both sides."""
    second = rig.joint_share[hold.joints]
    at = np.stack([1.0 - hold.share, hold.share], axis=1)
    weights = np.stack([at * (1.0 - second), at * second], axis=2)
    return rig.joint_bones[hold.joints].reshape(-1, 4), weights.reshape(-1, 4)


def _fluttering(rig: Rig, hold: Hold, bones: Indices, weights: Floats) -> tuple[Indices, Floats]:
    """Let the outer corners of cards follow flutter bones in part (v, 5)."""
    own = rig.joint_bones[hold.joints[:, 0], 1]
    flutter = rig.flutter[own]
    near = rig.parents[flutter] == own
    outer = np.resize(_OUTER, len(own))
    part = np.where(near, FLUTTER * rig.joint_share[hold.joints[:, 0]], FURTHER_FLUTTER)
    part = np.where(outer & (flutter >= 0), part, 0.0)
    bones = np.concatenate([bones, np.maximum(flutter, 0)[:, None]], axis=1)
    return bones, np.concatenate([weights * (1.0 - part)[:, None], part[:, None]], axis=1)


def _four_best(bones: Indices, weights: Floats) -> tuple[Indices, Floats]:
    """Add up what a bone is named for twice, and keep the four of greatest weight (v, 4), greatest first."""
    weights = weights.copy()
    for later in range(1, bones.shape[1]):
        for earlier in range(later):
            same = bones[:, later] == bones[:, earlier]
            weights[same, earlier] += weights[same, later]
            weights[same, later] = 0.0
    best = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    kept = np.take_along_axis(weights, best, axis=1)
    return np.take_along_axis(bones, best, axis=1), kept / kept.sum(axis=1, keepdims=True)


def _whole(weights: Floats) -> NDArray[np.uint8]:
    """Round weights (v, 4), greatest first, to 255ths that sum to 1: the greatest remainders go up."""
    parts = weights * 255.0
    low = np.floor(parts)
    missing = 255.0 - low.sum(axis=1, keepdims=True)
    rank = np.argsort(np.argsort(low - parts, axis=1, kind="stable"), axis=1, kind="stable")
    return np.asarray(low + (rank < missing), dtype=np.uint8)


def _sway(rig: Rig, positions: Floats, bones: Indices, weights: Floats) -> Floats:
    """Estimate how far vertices (v,) move, over the most of any bone's end: turns add up on the way from the root."""
    soft = softness(rig)
    level = np.zeros(len(soft))
    for bone in range(1, len(soft)):
        parent = rig.parents[bone]
        level[bone] = level[parent] + soft[parent] * np.linalg.norm(rig.heads[bone] - rig.heads[parent])
    most = float((level + soft * np.linalg.norm(rig.ends - rig.heads, axis=1)).max())
    away = np.linalg.norm(positions[:, None] - rig.heads[bones], axis=2)
    moved = (weights * (level[bones] + soft[bones] * away)).sum(axis=1)
    return np.asarray(np.clip(moved / max(most, 1e-9), 0.0, 1.0))


def _phases(rig: Rig) -> Floats:
    """Spread the bones' phases evenly over 0 to 1 (b,), neighbours far apart."""
    return np.asarray(np.arange(len(rig.names)) * _GOLDEN, dtype=np.float64) % 1.0
