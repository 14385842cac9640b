"""A tree as glTF in files of its own: the document, the buffer and the pictures beside it."""

import json
from collections.abc import Sequence
from urllib.parse import quote

from treestroke.codec.gltf.book import Book
from treestroke.codec.gltf.tree import Part, write_book
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.sway.wind import Wind

_ENDINGS = {"image/jpeg": "jpg", "image/png": "png"}


def encode_gltf(
    parts: Sequence[Part], camera: OrthographicCamera, *, generator: str, stem: str, wind: Wind | None = None
) -> dict[str, bytes]:
    """Write a tree as ``stem.gltf``, ``stem.bin``, ``stem_bark.jpg``, ``stem_leaf.png`` ...: bytes by name.

    The document says the same as `encode_glb`'s. Equal input gives equal bytes.
    """
    book, head = write_book(parts, camera, generator, wind)
    pictures = _take_pictures(book, stem)
    document = book.document(head)
    document["buffers"][0]["uri"] = quote(f"{stem}.bin")
    text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False).encode()
    return {f"{stem}.gltf": text, f"{stem}.bin": bytes(book.binary), **pictures}


def _take_pictures(book: Book, stem: str) -> dict[str, bytes]:
    """Move the pictures out of the buffer to files, and close the gaps."""
    views, content = book.tables.pop("bufferViews"), bytes(book.binary)
    book.binary.clear()
    spans = [content[view["byteOffset"] : view["byteOffset"] + view["byteLength"]] for view in views]
    pictures = {}
    for image in book.tables["images"]:
        name = f"{stem}_{image['name']}.{_ENDINGS[image['mimeType']]}"
        pictures[name] = spans[image.pop("bufferView")]
        image["uri"] = quote(name)
    moved = {}
    for row in book.tables["accessors"]:
        old = row["bufferView"]
        if old not in moved:
            moved[old] = book.view(spans[old], views[old].get("target"))
        row["bufferView"] = moved[old]
    return pictures
