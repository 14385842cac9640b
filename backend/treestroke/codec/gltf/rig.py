"""Wind in a glTF document: bones as nodes, what vertices follow them, and clips as animations."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from treestroke.codec.gltf.book import Book
from treestroke.core.sway.wind import Clip, Rig, Wind

_DIGITS = 6
"""Of a bone's place in metres, so that the ways from bone to bone add up to what the vertices are bound to."""


def add_wind(book: Book, wind: Wind) -> int:
    """Enter bones, the document's only skin and the clips; give the root bone's node, which is to stand in the scene.

    Bones are unturned at rest. A branch bone's ``extras.radius`` is that of its wood, metres.
    """
    first = len(book.tables.get("nodes", []))
    rig = wind.rig
    for node in _joints(rig, first):
        book.row("nodes", node)
    joints = list(range(first, first + len(rig.names)))
    bound = book.accessor(_inverse_binds(rig))
    book.row("skins", {"name": "wind", "inverseBindMatrices": bound, "skeleton": first, "joints": joints})
    for clip in wind.clips:
        book.row("animations", _animation(book, clip, first))
    return first


def _joints(rig: Rig, first: int) -> list[dict[str, Any]]:
    """Make a node of each bone, the root's at ``first``."""
    heads = np.round(rig.heads, _DIGITS)
    nodes = []
    for bone, (name, parent) in enumerate(zip(rig.names, rig.parents.tolist(), strict=True)):
        way = heads[bone] - heads[parent] if parent >= 0 else heads[bone]
        node: dict[str, Any] = {"name": name, "translation": np.round(way, _DIGITS).tolist()}
        children = (first + np.flatnonzero(rig.parents == bone)).tolist()
        if children:
            node["children"] = children
        if rig.radii[bone] > 0:
            node["extras"] = {"radius": round(float(rig.radii[bone]), _DIGITS)}
        nodes.append(node)
    return nodes


def _inverse_binds(rig: Rig) -> NDArray[np.float32]:
    """Give the matrices (b, 16), columns one after the other, that bring the world's points into a bone's frame."""
    matrices = np.tile(np.eye(4, dtype=np.float32), (len(rig.names), 1, 1))
    matrices[:, 3, :3] = -np.round(rig.heads, _DIGITS)
    return matrices.reshape(-1, 16)


def _animation(book: Book, clip: Clip, first: int) -> dict[str, Any]:
    """Enter a clip's times and turns; bones with the same times share them."""
    inputs: dict[bytes, int] = {}
    samplers: list[dict[str, int]] = []
    channels: list[dict[str, Any]] = []
    for bone, times, turns in zip(clip.bones, clip.times, clip.turns, strict=True):
        seconds = times.astype(np.float32)
        key = seconds.tobytes()
        if key not in inputs:
            inputs[key] = book.accessor(seconds, bounded=True)
        target = {"node": first + bone, "path": "rotation"}
        channels.append({"sampler": len(samplers), "target": target})
        samplers.append({"input": inputs[key], "output": book.accessor(turns.astype(np.float32))})
    return {"name": clip.name, "channels": channels, "samplers": samplers}
