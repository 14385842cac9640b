"""Motion in a glTF document: bones as nodes, a skin, and animations."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from treestroke.codec.gltf.document import Document
from treestroke.core.sway.motion import Animation, Motion, Rig
from treestroke.core.types import Floats

_DIGITS = 6
"""Decimals of a bone's position, metres: rounded, translations add up exactly to the inverse bind matrices."""


def add_motion(document: Document, motion: Motion) -> int:
    """Add bones, the document's only skin and the animations; return the index of the root bone's node.

    That node belongs into the scene. Bones have no rotation at rest. A branch bone's ``extras.radius`` is that of its
    wood, metres.
    """
    first = len(document.tables.get("nodes", []))
    rig = motion.rig
    for node in _joints(rig, first):
        document.row("nodes", node)
    joints = list(range(first, first + len(rig.names)))
    bound = document.accessor(_inverse_binds(rig))
    document.row("skins", {"name": "wind", "inverseBindMatrices": bound, "skeleton": first, "joints": joints})
    for animation in motion.animations:
        document.row("animations", _animation(document, animation, first))
    return first


def _joints(rig: Rig, first: int) -> list[dict[str, Any]]:
    """Return a node for each bone; the root bone's has the index ``first``."""
    heads = np.round(rig.heads, _DIGITS)
    nodes = []
    for bone, (name, parent) in enumerate(zip(rig.names, rig.parents.tolist(), strict=True)):
        offset = heads[bone] - heads[parent] if parent >= 0 else heads[bone]
        node: dict[str, Any] = {"name": name, "translation": np.round(offset, _DIGITS).tolist()}
        children = (first + np.flatnonzero(rig.parents == bone)).tolist()
        if children:
            node["children"] = children
        if rig.radii[bone] > 0:
            node["extras"] = {"radius": round(float(rig.radii[bone]), _DIGITS)}
        nodes.append(node)
    return nodes


def _inverse_binds(rig: Rig) -> NDArray[np.float32]:
    """Return the inverse bind matrices (b, 16), column-major, from the world to each bone's frame, metres."""
    matrices = np.tile(np.eye(4, dtype=np.float32), (len(rig.names), 1, 1))
    matrices[:, 3, :3] = -np.round(rig.heads, _DIGITS)
    return matrices.reshape(-1, 16)


def _rotations(document: Document, rotations: Floats, many: bool) -> int:
    """Add unit quaternions (k, 4), as floats or, of ``many``, as 16 bit; return their accessor."""
    if many:
        return document.accessor(np.rint(rotations * 32767).astype(np.int16), normalized=True)
    return document.accessor(rotations.astype(np.float32))


def _animation(document: Document, animation: Animation, first: int) -> dict[str, Any]:
    """Add keyframes and return the row of an animation; bones with the same times share them."""
    inputs: dict[bytes, int] = {}
    samplers: list[dict[str, int]] = []
    channels: list[dict[str, Any]] = []
    for bone, times, rotations in zip(animation.bones, animation.times, animation.rotations, strict=True):
        seconds = times.astype(np.float32)
        key = seconds.tobytes()
        if key not in inputs:
            inputs[key] = document.accessor(seconds, bounded=True)
        target = {"node": first + bone, "path": "rotation"}
        channels.append({"sampler": len(samplers), "target": target})
        samplers.append({"input": inputs[key], "output": _rotations(document, rotations, animation.many)})
    return {"name": animation.name, "channels": channels, "samplers": samplers}
