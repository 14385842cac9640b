"""A tree as glTF in separate files: the document, the buffer and the pictures."""

import json
from collections.abc import Sequence
from urllib.parse import quote

from treestroke.codec.gltf.document import Document
from treestroke.codec.gltf.tree import Part, Provenance, build_document
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.sway.motion import Motion

_ENDINGS = {"image/jpeg": "jpg", "image/png": "png"}


def encode_gltf(
    parts: Sequence[Part],
    camera: OrthographicCamera,
    *,
    provenance: Provenance,
    stem: str,
    motion: Motion | None = None,
) -> dict[str, bytes]:
    """Encode a tree as ``stem.gltf``, ``stem.bin``, ``stem_bark.jpg``, ``stem_leaf.png`` ...: bytes by name.

    The content is that of `encode_glb`. Equal input gives equal bytes.
    """
    document, head = build_document(parts, camera, provenance, motion)
    pictures = _take_pictures(document, stem)
    content = document.as_dict(head)
    content["buffers"][0]["uri"] = quote(f"{stem}.bin")
    text = json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False).encode()
    return {f"{stem}.gltf": text, f"{stem}.bin": bytes(document.binary), **pictures}


def _take_pictures(document: Document, stem: str) -> dict[str, bytes]:
    """Move the pictures out of the buffer into files: their bytes by name. The rest of the buffer is packed again."""
    views, content = document.tables.pop("bufferViews"), bytes(document.binary)
    document.binary.clear()
    spans = [content[view["byteOffset"] : view["byteOffset"] + view["byteLength"]] for view in views]
    pictures = {}
    for image in document.tables["images"]:
        name = f"{stem}_{image['name']}.{_ENDINGS[image['mimeType']]}"
        pictures[name] = spans[image.pop("bufferView")]
        image["uri"] = quote(name)
    moved = {}
    for row in document.tables["accessors"]:
        old = row["bufferView"]
        if old not in moved:
            moved[old] = document.view(spans[old], views[old].get("target"))
        row["bufferView"] = moved[old]
    return pictures
