"""Skinning: the bones that each vertex of a mesh follows, and their weights."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import Attachment, Mesh
from treestroke.core.sway.motion import Rig, Skin
from treestroke.core.sway.stiffness import softness
from treestroke.core.types import Floats, Indices

FLUTTER = 0.5
"""Weight of the flutter bone of a leaf's own bone at its outer corners; its inner ones follow the wood alone."""
FURTHER_FLUTTER = 0.15
"""The same where only a bone nearer to the root has one: more would distort cards when the bones between turn."""
_GOLDEN = 0.6180339887498949  # golden ratio: its multiples spread evenly over 0 to 1
_OUTER = np.array([False, False, True, True])  # corners of a card


def skin(rig: Rig, mesh: Mesh, *, leaves: bool) -> Skin:
    """Bind a mesh that is attached to the rig's skeleton; ``leaves`` means that it consists of cards of four vertices.

    A vertex between two joints blends the bones of both. Weights are whole 255ths; sway and phase vary smoothly along
    the wood.

    Raises
    ------
    ValueError
        The mesh has no attachment.
    """
    if mesh.attachment is None:
        raise ValueError("a mesh without attachment cannot follow bones")
    bones, weights = _joint_weights(rig, mesh.attachment)
    if leaves:
        bones, weights = _fluttering(rig, mesh.attachment, bones, weights)
    bones, weights = _four_greatest(bones, weights)
    quantised = _quantised(weights)
    sway = _sway(rig, mesh.positions.astype(np.float64), bones, weights)
    phase = (weights * _phases(rig)[bones]).sum(axis=1)
    kept = np.where(quantised > 0, bones, 0).astype(np.uint8)
    return Skin(kept, quantised, sway.astype(np.float32), phase.astype(np.float32))


def _joint_weights(rig: Rig, attachment: Attachment) -> tuple[Indices, Floats]:
    """Return the bones (v, 4) of both joints of each vertex, and their weights (v, 4)."""
    second = rig.joint_share[attachment.joints]
    at = np.stack([1.0 - attachment.share, attachment.share], axis=1)
    weights = np.stack([at * (1.0 - second), at * second], axis=2)
    return rig.joint_bones[attachment.joints].reshape(-1, 4), weights.reshape(-1, 4)


def _fluttering(rig: Rig, attachment: Attachment, bones: Indices, weights: Floats) -> tuple[Indices, Floats]:
    """Add a flutter bone for the outer corners of cards: bones and weights (v, 5)."""
    wood = rig.joint_bones[attachment.joints[:, 0], 1]
    flutter = rig.flutter[wood]
    near = rig.parents[flutter] == wood
    outer = np.resize(_OUTER, len(wood))
    part = np.where(near, FLUTTER * rig.joint_share[attachment.joints[:, 0]], FURTHER_FLUTTER)
    part = np.where(outer & (flutter >= 0), part, 0.0)
    bones = np.concatenate([bones, np.maximum(flutter, 0)[:, None]], axis=1)
    return bones, np.concatenate([weights * (1.0 - part)[:, None], part[:, None]], axis=1)


def _four_greatest(bones: Indices, weights: Floats) -> tuple[Indices, Floats]:
    """Merge bones that occur twice, and keep the four (v, 4) of greatest weight, greatest first."""
    weights = weights.copy()
    for later in range(1, bones.shape[1]):
        for earlier in range(later):
            same = bones[:, later] == bones[:, earlier]
            weights[same, earlier] += weights[same, later]
            weights[same, later] = 0.0
    best = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    kept = np.take_along_axis(weights, best, axis=1)
    return np.take_along_axis(bones, best, axis=1), kept / kept.sum(axis=1, keepdims=True)


def _quantised(weights: Floats) -> NDArray[np.uint8]:
    """Round weights (v, 4), greatest first, to 255ths that sum to 1: the greatest remainders are rounded up."""
    parts = weights * 255.0
    low = np.floor(parts)
    missing = 255.0 - low.sum(axis=1, keepdims=True)
    rank = np.argsort(np.argsort(low - parts, axis=1, kind="stable"), axis=1, kind="stable")
    return np.asarray(low + (rank < missing), dtype=np.uint8)


def _sway(rig: Rig, positions: Floats, bones: Indices, weights: Floats) -> Floats:
    """Estimate how far vertices (v,) move, 0 to 1 of the farthest end of a bone: turns add up from the root on."""
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
    """Spread the bones' phases (b,) evenly over 0 to 1, with neighbours far apart."""
    return np.asarray(np.arange(len(rig.names)) * _GOLDEN, dtype=np.float64) % 1.0
