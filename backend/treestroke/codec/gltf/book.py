"""The tables and the buffer of a glTF 2.0 document as they fill."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from treestroke.core.geometry.mesh import Mesh, Surface

_BYTE, _SHORT, _INT, _FLOAT = 5121, 5123, 5125, 5126  # component types, glTF 2.0, 3.6.2.2
_COMPONENTS = {np.uint8: _BYTE, np.uint16: _SHORT, np.uint32: _INT, np.float32: _FLOAT}
_KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
_VERTICES, _INDICES = 34962, 34963  # buffer view targets
_LINEAR, _MIPMAPPED = 9729, 9987
_JPEG_QUALITY = 88
_JSON_CHUNK, _BINARY_CHUNK = b"JSON", b"BIN\0"


@dataclass(eq=False)
class Book:
    """The tables of a glTF document as they fill, and the buffer that they point into."""

    binary: bytearray = field(default_factory=bytearray)
    tables: dict[str, list[dict[str, Any]]] = field(default_factory=dict)

    def glb(self, head: Mapping[str, Any]) -> bytes:
        """Close the document under what stands before its tables."""
        return _container({**head, **self.tables, "buffers": [{"byteLength": len(self.binary)}]}, bytes(self.binary))

    def add(self, name: str, surface: Surface, material: Mapping[str, Any], wrap: int) -> None:
        """Enter a surface with all that it needs."""
        texture = self._texture(name, surface.texture, wrap)
        shading = {**material["pbrMetallicRoughness"], "baseColorTexture": {"index": texture}}
        worn = self._row("materials", {"name": name, **material, "pbrMetallicRoughness": shading})
        mesh = surface.mesh
        attributes = {
            "POSITION": self._accessor(mesh.positions.astype(np.float32), _VERTICES, bounded=True),
            "NORMAL": self._accessor(mesh.normals.astype(np.float32), _VERTICES),
            "TEXCOORD_0": self._accessor(_packed(mesh.uvs), _VERTICES),
        }
        if mesh.shades is not None:
            attributes["COLOR_0"] = self._accessor(_greys(mesh.shades), _VERTICES)
        indices = self._accessor(_indices(mesh), _INDICES)
        primitive = {"attributes": attributes, "indices": indices, "material": worn}
        shape = self._row("meshes", {"name": name, "primitives": [primitive]})
        self._row("nodes", {"name": name, "mesh": shape})

    def _texture(self, name: str, pixels: NDArray[np.uint8], wrap: int) -> int:
        """Enter a picture and how it is sampled."""
        mime, encoded = _picture(pixels)
        image = self._row("images", {"name": name, "mimeType": mime, "bufferView": self._view(encoded)})
        filters = {"magFilter": _LINEAR, "minFilter": _MIPMAPPED, "wrapS": wrap, "wrapT": wrap}
        sampler = self._row("samplers", filters)
        return self._row("textures", {"sampler": sampler, "source": image})

    def _accessor(self, values: NDArray[Any], target: int, bounded: bool = False) -> int:
        """Enter an array (n,) or (n, c); unsigned vertex values stand for 0 to 1."""
        row: dict[str, Any] = {
            "bufferView": self._view(values.tobytes(), target),
            "componentType": _COMPONENTS[values.dtype.type],
            "count": len(values),
            "type": _KINDS[1 if values.ndim == 1 else values.shape[1]],
        }
        if target == _VERTICES and values.dtype != np.float32:
            row["normalized"] = True
        if bounded:
            row |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        return self._row("accessors", row)

    def _view(self, content: bytes, target: int | None = None) -> int:
        """Append bytes to the buffer, at a multiple of four."""
        row = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)}
        self.binary += content + b"\0" * (-len(content) % 4)
        return self._row("bufferViews", row if target is None else {**row, "target": target})

    def _row(self, table: str, row: dict[str, Any]) -> int:
        """Append a row to a table and give its index."""
        rows = self.tables.setdefault(table, [])
        rows.append(row)
        return len(rows) - 1


def _packed(uvs: NDArray[np.float32]) -> NDArray[np.float32] | NDArray[np.uint16]:
    """Make texture coordinates 16 bit where they lie within 0 to 1."""
    if uvs.min(initial=0.0) < 0 or uvs.max(initial=0.0) > 1:
        return uvs.astype(np.float32)
    return np.rint(uvs.astype(np.float64) * 65535).astype(np.uint16)


def _greys(shades: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Make brightness an opaque grey of four bytes, the size to which vertices are aligned."""
    grey = np.rint(np.clip(shades, 0, 1).astype(np.float64) * 255).astype(np.uint8)
    return np.stack([grey, grey, grey, np.full_like(grey, 255)], axis=1)


def _indices(mesh: Mesh) -> NDArray[np.uint16] | NDArray[np.uint32]:
    """Flatten triangles to the narrowest index; 65,535 itself is reserved."""
    flat = mesh.triangles.reshape(-1)
    return flat.astype(np.uint16) if len(mesh.positions) <= 65535 else flat.astype(np.uint32)


def _picture(pixels: NDArray[np.uint8]) -> tuple[str, bytes]:
    """Encode (h, w, 3) as JPEG, (h, w, 4) as PNG."""
    out = BytesIO()
    if pixels.shape[2] == 4:
        Image.fromarray(pixels).save(out, "PNG", compress_level=7)
        return "image/png", out.getvalue()
    Image.fromarray(pixels).save(out, "JPEG", quality=_JPEG_QUALITY)
    return "image/jpeg", out.getvalue()


def _container(document: Mapping[str, Any], binary: bytes) -> bytes:
    """Join the JSON and the buffer to one file, each padded to a multiple of four."""
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    chunks = [(_JSON_CHUNK, text), (_BINARY_CHUNK, binary)]
    body = b"".join(len(content).to_bytes(4, "little") + kind + content for kind, content in chunks)
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body
