"""A glTF 2.0 document under construction: its tables and its buffer."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from treestroke.core.geometry.mesh import Mesh, Surface, submesh
from treestroke.core.geometry.tangents import shows_normal_map, tangents
from treestroke.core.sway.motion import Skin
from treestroke.core.types import Mask

_COMPONENTS = {np.uint8: 5121, np.int16: 5122, np.uint16: 5123, np.uint32: 5125, np.float32: 5126}
"""Component types, glTF 2.0, section 3.6.2.2."""
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
VERTICES, INDICES = 34962, 34963  # targets of buffer views
_LINEAR, _MIPMAPPED = 9729, 9987  # sampler filters
_JPEG_QUALITY, NORMAL_MAP_QUALITY = 88, 94
TRANSLUCENT = "KHR_materials_diffuse_transmission"
_JSON_CHUNK, _BINARY_CHUNK = b"JSON", b"BIN\0"


@dataclass(frozen=True, eq=False)
class Material:
    """The properties of a glTF material but for its textures, and how these wrap (a sampler's wrapS and wrapT)."""

    properties: Mapping[str, Any]
    wrap: int


@dataclass(eq=False)
class Document:
    """The tables of a glTF document, which grow as parts are added, and the buffer that they refer to.

    Methods that add something return its index in its table.
    """

    binary: bytearray = field(default_factory=bytearray)
    tables: dict[str, list[dict[str, Any]]] = field(default_factory=dict)
    used: set[str] = field(default_factory=set)
    """Extensions that the document uses."""
    required: set[str] = field(default_factory=set)
    """Extensions that readers must support."""
    materials: dict[tuple[int, int, int], int] = field(default_factory=dict)
    """Materials by the ids of texture, normal map and `Material`; their owners outlive the document."""
    textures: dict[int, int] = field(default_factory=dict)
    """Textures by the id of their pixels."""

    def as_dict(self, head: Mapping[str, Any]) -> dict[str, Any]:
        """Return the document's JSON: ``head``, the extensions and the tables; the buffer is the first of its table."""
        names = {"extensionsUsed": sorted(self.used), "extensionsRequired": sorted(self.required)}
        buffers = [{"byteLength": len(self.binary)}, *self.tables.get("buffers", [])]
        return {**head, **{key: value for key, value in names.items() if value}, **self.tables, "buffers": buffers}

    def glb(self, head: Mapping[str, Any]) -> bytes:
        """Encode the document, with ``head`` before its tables, as a GLB."""
        return _container(self.as_dict(head), bytes(self.binary))

    def add(
        self, name: str, surface: Surface, material: Material, skin: Skin | None = None, material_name: str = ""
    ) -> int:
        """Add a node with a surface, its material and textures; with a skin it follows the document's only one.

        Surfaces with the same arrays share a material. Where a normal map is too small to be seen, the triangles get a
        second material without it, whose name ends in ``_twigs``: that saves their tangents. ``material_name`` is
        ``name`` unless given.
        """
        label = material_name or name
        mapped = None if surface.normal_map is None else shows_normal_map(surface.mesh)
        if mapped is None or mapped.all():
            primitives = [self.primitive(surface.mesh, self._shared_material(label, surface, material), skin)]
        else:
            plain = replace(surface, normal_map=None)
            primitives = [
                self._part(surface.mesh, mask, self._shared_material(part_label, part, material), skin)
                for part_label, part, mask in ((label, surface, mapped), (f"{label}_twigs", plain, ~mapped))
                if mask.any()
            ]
        mesh = self.row("meshes", {"name": name, "primitives": primitives})
        return self.row("nodes", {"name": name, "mesh": mesh, **({} if skin is None else {"skin": 0})})

    def _part(self, mesh: Mesh, kept: Mask, material: int, skin: Skin | None) -> dict[str, Any]:
        """Return a primitive of the triangles in a mask (t,), with a material."""
        part, vertices = submesh(mesh, kept)
        return self.primitive(part, material, None if skin is None else skin.at(vertices))

    def _shared_material(self, name: str, surface: Surface, material: Material) -> int:
        """Add a material unless a surface with the same arrays has added it."""
        key = (id(surface.texture), id(surface.normal_map), id(material))
        if key not in self.materials:
            self.materials[key] = self.material(name, surface, material)
        return self.materials[key]

    def primitive(self, mesh: Mesh, material: int, skin: Skin | None = None) -> dict[str, Any]:
        """Add the arrays of a mesh and return a primitive with a material; with a normal map it has tangents."""
        attributes = {
            "POSITION": self.accessor(mesh.positions.astype(np.float32), VERTICES, bounded=True),
            "NORMAL": self.accessor(mesh.normals.astype(np.float32), VERTICES),
            "TEXCOORD_0": self._coordinates(mesh.uvs),
        }
        if "normalTexture" in self.tables["materials"][material]:
            attributes["TANGENT"] = self.accessor(tangents(mesh).astype(np.float32), VERTICES)
        if mesh.shades is not None:
            attributes["COLOR_0"] = self.accessor(_greys(mesh.shades), VERTICES, normalized=True)
        if skin is not None:
            attributes |= self._skinned(skin)
        indices = self.accessor(_indices(mesh), INDICES)
        return {"attributes": attributes, "indices": indices, "material": material}

    def _coordinates(self, uvs: NDArray[np.float32]) -> int:
        """Add texture coordinates (v, 2), as 16-bit integers where all lie within 0 to 1."""
        if uvs.min(initial=0.0) < 0 or uvs.max(initial=0.0) > 1:
            return self.accessor(uvs.astype(np.float32), VERTICES)
        return self.accessor(np.rint(uvs.astype(np.float64) * 65535).astype(np.uint16), VERTICES, normalized=True)

    def _skinned(self, skin: Skin) -> dict[str, int]:
        """Add the attributes of skinning, and those for engines with a wind of their own."""
        return {
            "JOINTS_0": self.accessor(skin.bones, VERTICES),
            "WEIGHTS_0": self.accessor(skin.weights, VERTICES, normalized=True),
            "_SWAY": self.accessor(skin.sway, VERTICES),
            "_PHASE": self.accessor(skin.phase, VERTICES),
        }

    def material(self, name: str, surface: Surface, material: Material) -> int:
        """Add a material with the textures of a surface."""
        properties = material.properties
        texture = self.texture(name, surface.texture, material.wrap)
        shading = {**properties["pbrMetallicRoughness"], "baseColorTexture": {"index": texture}}
        row = {"name": name, **properties, "pbrMetallicRoughness": shading}
        if surface.normal_map is not None:
            index = self.texture(f"{name}_relief", surface.normal_map, material.wrap, NORMAL_MAP_QUALITY)
            row["normalTexture"] = {"index": index}
        if TRANSLUCENT in properties.get("extensions", {}):
            through = {**properties["extensions"][TRANSLUCENT], "diffuseTransmissionColorTexture": {"index": texture}}
            row["extensions"] = {**properties["extensions"], TRANSLUCENT: through}
            self.used.add(TRANSLUCENT)
        return self.row("materials", row)

    def texture(self, name: str, pixels: NDArray[np.uint8], wrap: int, quality: int = _JPEG_QUALITY) -> int:
        """Add a texture of pixels (h, w, 3 or 4), sRGB, whose sides are powers of two."""
        if id(pixels) in self.textures:
            return self.textures[id(pixels)]
        if any(side & (side - 1) for side in pixels.shape[:2]):
            raise ValueError(f"the sides of a texture must be powers of two, got {pixels.shape[:2]}")
        mime, encoded = encode_picture(pixels, quality)
        image = self.row("images", {"name": name, "mimeType": mime, "bufferView": self.view(encoded)})
        filters = {"magFilter": _LINEAR, "minFilter": _MIPMAPPED, "wrapS": wrap, "wrapT": wrap}
        sampler = self.row("samplers", filters)
        self.textures[id(pixels)] = self.row("textures", {"sampler": sampler, "source": image})
        return self.textures[id(pixels)]

    def accessor(
        self, values: NDArray[Any], target: int | None = None, bounded: bool = False, normalized: bool = False
    ) -> int:
        """Add an array (n,) or (n, c); normalized integers stand for 0 to 1, or -1 to 1."""
        row: dict[str, Any] = {
            "bufferView": self.view(values.tobytes(), target),
            "componentType": _COMPONENTS[values.dtype.type],
            "count": len(values),
            "type": _TYPES[1 if values.ndim == 1 else values.shape[1]],
        }
        if normalized:
            row["normalized"] = True
        if bounded:
            columns = np.ascontiguousarray(values.T)  # numpy takes the least over a long first axis slowly
            low, high = np.atleast_1d(columns.min(axis=-1), columns.max(axis=-1))
            row |= {"min": low.tolist(), "max": high.tolist()}
        return self.row("accessors", row)

    def view(self, content: bytes, target: int | None = None) -> int:
        """Append bytes to the buffer, aligned to four, and add a buffer view of them."""
        row = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)}
        self.binary += content + b"\0" * (-len(content) % 4)
        return self.row("bufferViews", row if target is None else {**row, "target": target})

    def row(self, table: str, row: dict[str, Any]) -> int:
        """Append a row to a table."""
        rows = self.tables.setdefault(table, [])
        rows.append(row)
        return len(rows) - 1


def _greys(shades: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Convert brightness (v,), 0 to 1, to opaque greys (v, 4), since vertex attributes are aligned to four bytes."""
    grey = np.rint(np.clip(shades, 0, 1).astype(np.float64) * 255).astype(np.uint8)
    return np.stack([grey, grey, grey, np.full_like(grey, 255)], axis=1)


def _indices(mesh: Mesh) -> NDArray[np.uint16] | NDArray[np.uint32]:
    """Flatten triangles to the narrowest index type; 65,535 is reserved (glTF 2.0, section 3.7.2.1)."""
    flat = mesh.triangles.reshape(-1)
    return flat.astype(np.uint16) if len(mesh.positions) <= 65535 else flat.astype(np.uint32)


def encode_picture(pixels: NDArray[np.uint8], quality: int = _JPEG_QUALITY) -> tuple[str, bytes]:
    """Encode pixels (h, w, 3) as JPEG or (h, w, 4) as PNG: the media type and the bytes.

    From quality 90 on, the colour of a JPEG is not subsampled.
    """
    out = BytesIO()
    if pixels.shape[2] == 4:
        Image.fromarray(pixels).save(out, "PNG", compress_level=5)
        return "image/png", out.getvalue()
    Image.fromarray(pixels).save(out, "JPEG", quality=quality, subsampling=0 if quality >= 90 else 2)
    return "image/jpeg", out.getvalue()


def _container(document: Mapping[str, Any], binary: bytes) -> bytes:
    """Join the JSON and the buffer as a GLB (glTF 2.0, section 4.4), each chunk padded to a multiple of four."""
    text = json.dumps(document, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    chunks = [(_JSON_CHUNK, text), (_BINARY_CHUNK, binary)]
    body = b"".join(len(content).to_bytes(4, "little") + kind + content for kind, content in chunks)
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body
