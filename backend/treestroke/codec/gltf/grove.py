"""Several trees in one GLB; those that stand more than once share their meshes."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from treestroke.codec.gltf.compression import compressed
from treestroke.codec.gltf.document import Document
from treestroke.codec.gltf.tree import MATERIALS, Part, Provenance, head_of
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.siblings.grove import Grove


def encode_grove(
    trees: Sequence[Sequence[Part]],
    grove: Grove,
    camera: OrthographicCamera,
    *,
    provenance: Provenance,
    compress: bool = False,
) -> bytes:
    """Encode a grove: a node for each place, with the nodes of its tree's parts under it.

    ``camera`` is that of the first tree's front. Trees stand still. Equal input gives equal bytes.
    """
    document = Document()
    shared = [[document.add(part.material, part.surface, MATERIALS[part.material]) for part in tree] for tree in trees]
    used, roots = set[int](), list[int]()
    for number, tree in enumerate(grove.tree.tolist()):
        children = [_again(document, node) if tree in used else node for node in shared[tree]]
        used.add(tree)
        x, z = grove.places[number].tolist()
        half = float(grove.turns_rad[number]) / 2
        place: dict[str, Any] = {"name": f"tree_{number + 1:03d}", "translation": [x, 0.0, z], "children": children}
        if half:
            place["rotation"] = [0.0, float(np.sin(half)), 0.0, float(np.cos(half))]
        roots.append(document.row("nodes", place))
    return (compressed(document) if compress else document).glb(head_of(roots, camera, provenance))


def _again(document: Document, node: int) -> int:
    """Add a node with the mesh of another one."""
    row = document.tables["nodes"][node]
    return document.row("nodes", {"name": row["name"], "mesh": row["mesh"]})
