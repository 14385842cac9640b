"""The tables and the buffer of a glTF 2.0 document as they fill."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from treestroke.core.geometry.mesh import Mesh, Surface
from treestroke.core.geometry.parts import part_of, shows_relief
from treestroke.core.geometry.tangents import tangents
from treestroke.core.sway.wind import Skin

_COMPONENTS = {np.uint8: 5121, np.int16: 5122, np.uint16: 5123, np.uint32: 5125, np.float32: 5126}
"""Component types, glTF 2.0, 3.6.2.2."""
_KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
VERTICES, _INDICES = 34962, 34963  # buffer view targets
_LINEAR, _MIPMAPPED = 9729, 9987
_JPEG_QUALITY, RELIEF_QUALITY = 88, 94
TRANSLUCENT = "KHR_materials_diffuse_transmission"
_JSON_CHUNK, _BINARY_CHUNK = b"JSON", b"BIN\0"


@dataclass(eq=False)
class Book:
    """The tables of a glTF document as they fill, and the buffer that they point into."""

    binary: bytearray = field(default_factory=bytearray)
    tables: dict[str, list[dict[str, Any]]] = field(default_factory=dict)
    used: set[str] = field(default_factory=set)
    """Extensions that the document uses."""
    required: set[str] = field(default_factory=set)
    """Those of them without which it cannot be read."""
    worn: dict[tuple[int, int, int], int] = field(default_factory=dict)
    """Materials by the identities of texture, relief and kind, whose owners outlive the book's filling."""
    pictures: dict[int, int] = field(default_factory=dict)
    """Textures by the identity of their pixels."""

    def document(self, head: Mapping[str, Any]) -> dict[str, Any]:
        """Join what stands before the tables, the extensions and the tables; the buffer is the first one."""
        names = {"extensionsUsed": sorted(self.used), "extensionsRequired": sorted(self.required)}
        buffers = [{"byteLength": len(self.binary)}, *self.tables.get("buffers", [])]
        return {**head, **{key: value for key, value in names.items() if value}, **self.tables, "buffers": buffers}

    def glb(self, head: Mapping[str, Any]) -> bytes:
        """Close the document under what stands before its tables."""
        return _container(self.document(head), bytes(self.binary))

    def add(
        self,
        name: str,
        surface: Surface,
        material: Mapping[str, Any],
        wrap: int,
        skin: Skin | None = None,
        worn_name: str | None = None,
    ) -> int:
        """Enter a surface with all that it needs and give its node; with a skin it follows the document's only one.

        A material is entered once for all surfaces that wear the same arrays. Where relief is too small to be seen,
        a material without it (its name ends in ``_twigs``) is worn, which saves what relief needs of vertices.
        """
        worn = worn_name or name
        kept = None if surface.relief is None else shows_relief(surface.mesh)
        if kept is None or kept.all():
            primitives = [self.primitive(surface.mesh, self._worn(worn, surface, material, wrap), skin)]
        else:
            plain = replace(surface, relief=None)
            primitives = [
                self._part(surface.mesh, marked, self._worn(called, one, material, wrap), skin)
                for called, one, marked in ((worn, surface, kept), (f"{worn}_twigs", plain, ~kept))
                if marked.any()
            ]
        shape = self.row("meshes", {"name": name, "primitives": primitives})
        return self.row("nodes", {"name": name, "mesh": shape, **({} if skin is None else {"skin": 0})})

    def _part(self, mesh: Mesh, kept: NDArray[np.bool_], worn: int, skin: Skin | None) -> dict[str, Any]:
        part, vertices = part_of(mesh, kept)
        return self.primitive(part, worn, None if skin is None else skin.at(vertices))

    def _worn(self, name: str, surface: Surface, material: Mapping[str, Any], wrap: int) -> int:
        key = (id(surface.texture), id(surface.relief), id(material))
        if key not in self.worn:
            self.worn[key] = self.material(name, surface, material, wrap)
        return self.worn[key]

    def primitive(self, mesh: Mesh, worn: int, skin: Skin | None = None) -> dict[str, Any]:
        """Enter triangles that wear a material; where that has relief, they say how it lies on them."""
        attributes = {
            "POSITION": self.accessor(mesh.positions.astype(np.float32), VERTICES, bounded=True),
            "NORMAL": self.accessor(mesh.normals.astype(np.float32), VERTICES),
            "TEXCOORD_0": self._coordinates(mesh.uvs),
        }
        if "normalTexture" in self.tables["materials"][worn]:
            attributes["TANGENT"] = self.accessor(tangents(mesh).astype(np.float32), VERTICES)
        if mesh.shades is not None:
            attributes["COLOR_0"] = self.accessor(_greys(mesh.shades), VERTICES, normalized=True)
        if skin is not None:
            attributes |= self._skinned(skin)
        indices = self.accessor(_indices(mesh), _INDICES)
        return {"attributes": attributes, "indices": indices, "material": worn}

    def _coordinates(self, uvs: NDArray[np.float32]) -> int:
        """Enter texture coordinates, of 16 bit where they lie within 0 to 1."""
        if uvs.min(initial=0.0) < 0 or uvs.max(initial=0.0) > 1:
            return self.accessor(uvs.astype(np.float32), VERTICES)
        return self.accessor(np.rint(uvs.astype(np.float64) * 65535).astype(np.uint16), VERTICES, normalized=True)

    def _skinned(self, skin: Skin) -> dict[str, int]:
        """Enter which bones vertices follow, and what engines with a wind of their own go by."""
        return {
            "JOINTS_0": self.accessor(skin.bones, VERTICES),
            "WEIGHTS_0": self.accessor(skin.weights, VERTICES, normalized=True),
            "_SWAY": self.accessor(skin.sway, VERTICES),
            "_PHASE": self.accessor(skin.phase, VERTICES),
        }

    def material(self, name: str, surface: Surface, material: Mapping[str, Any], wrap: int) -> int:
        """Enter a material with the textures that a surface wears."""
        texture = self.texture(name, surface.texture, wrap)
        shading = {**material["pbrMetallicRoughness"], "baseColorTexture": {"index": texture}}
        row = {"name": name, **material, "pbrMetallicRoughness": shading}
        if surface.relief is not None:
            row["normalTexture"] = {"index": self.texture(f"{name}_relief", surface.relief, wrap, RELIEF_QUALITY)}
        if TRANSLUCENT in material.get("extensions", {}):
            through = {**material["extensions"][TRANSLUCENT], "diffuseTransmissionColorTexture": {"index": texture}}
            row["extensions"] = {**material["extensions"], TRANSLUCENT: through}
            self.used.add(TRANSLUCENT)
        return self.row("materials", row)

    def texture(self, name: str, pixels: NDArray[np.uint8], wrap: int, quality: int = _JPEG_QUALITY) -> int:
        """Enter a picture, whose sides are powers of two, and how it is sampled."""
        if id(pixels) in self.pictures:
            return self.pictures[id(pixels)]
        if any(side & (side - 1) for side in pixels.shape[:2]):
            raise ValueError(f"the sides of a texture must be powers of two, got {pixels.shape[:2]}")
        mime, encoded = encode_picture(pixels, quality)
        image = self.row("images", {"name": name, "mimeType": mime, "bufferView": self.view(encoded)})
        filters = {"magFilter": _LINEAR, "minFilter": _MIPMAPPED, "wrapS": wrap, "wrapT": wrap}
        sampler = self.row("samplers", filters)
        self.pictures[id(pixels)] = self.row("textures", {"sampler": sampler, "source": image})
        return self.pictures[id(pixels)]

    def accessor(
        self, values: NDArray[Any], target: int | None = None, bounded: bool = False, normalized: bool = False
    ) -> int:
        """Enter an array (n,) or (n, c); normalized integers stand for 0 to 1, or -1 to 1."""
        row: dict[str, Any] = {
            "bufferView": self.view(values.tobytes(), target),
            "componentType": _COMPONENTS[values.dtype.type],
            "count": len(values),
            "type": _KINDS[1 if values.ndim == 1 else values.shape[1]],
        }
        if normalized:
            row["normalized"] = True
        if bounded:
            low, high = np.atleast_1d(values.min(axis=0), values.max(axis=0))
            row |= {"min": low.tolist(), "max": high.tolist()}
        return self.row("accessors", row)

    def view(self, content: bytes, target: int | None = None) -> int:
        """Append bytes to the buffer, at a multiple of four."""
        row = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)}
        self.binary += content + b"\0" * (-len(content) % 4)
        return self.row("bufferViews", row if target is None else {**row, "target": target})

    def row(self, table: str, row: dict[str, Any]) -> int:
        """Append a row to a table and give its index."""
        rows = self.tables.setdefault(table, [])
        rows.append(row)
        return len(rows) - 1


def _greys(shades: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Make brightness an opaque grey of four bytes, the size to which vertices are aligned."""
    grey = np.rint(np.clip(shades, 0, 1).astype(np.float64) * 255).astype(np.uint8)
    return np.stack([grey, grey, grey, np.full_like(grey, 255)], axis=1)


def _indices(mesh: Mesh) -> NDArray[np.uint16] | NDArray[np.uint32]:
    """Flatten triangles to the narrowest index; 65,535 itself is reserved."""
    flat = mesh.triangles.reshape(-1)
    return flat.astype(np.uint16) if len(mesh.positions) <= 65535 else flat.astype(np.uint32)


def encode_picture(pixels: NDArray[np.uint8], quality: int = _JPEG_QUALITY) -> tuple[str, bytes]:
    """Encode (h, w, 3) as JPEG, whose colour is as sharp as its light from quality 90 on, (h, w, 4) as PNG."""
    out = BytesIO()
    if pixels.shape[2] == 4:
        Image.fromarray(pixels).save(out, "PNG", compress_level=7)
        return "image/png", out.getvalue()
    Image.fromarray(pixels).save(out, "JPEG", quality=quality, subsampling=0 if quality >= 90 else 2)
    return "image/jpeg", out.getvalue()


def _container(document: Mapping[str, Any], binary: bytes) -> bytes:
    """Join the JSON and the buffer to one file, each padded to a multiple of four."""
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    chunks = [(_JSON_CHUNK, text), (_BINARY_CHUNK, binary)]
    body = b"".join(len(content).to_bytes(4, "little") + kind + content for kind, content in chunks)
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body
