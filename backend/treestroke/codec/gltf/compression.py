"""Compression of a glTF document: quantised vertices, compressed buffer views, WebP.

Extensions, all required of readers: KHR_mesh_quantization, EXT_meshopt_compression, EXT_texture_webp.
"""

from collections import Counter
from copy import deepcopy
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from treestroke.codec.gltf.document import INDICES, VERTICES, Document
from treestroke.codec.gltf.meshopt import Bytes, encode_attributes, encode_triangles, fixed_point, octahedral

MESHOPT, QUANTIZED, WEBP = "EXT_meshopt_compression", "KHR_mesh_quantization", "EXT_texture_webp"
_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_BYTE, _SHORT, _UNSIGNED_SHORT, _FLOAT = 5120, 5122, 5123, 5126
_STEPS = 65535
"""Steps of a position along the tree's longest side: 0.15 mm on a tree of 10 m."""
_UV_BITS, _SHARE_BITS = 12, 8
"""Fraction bits of a texture coordinate (1/8 texel of 512) and of an application-specific attribute, 0 to 1."""
_QUALITY, _NORMAL_MAP_QUALITY = 86, 94  # of WebP
Row = dict[str, Any]
Tables = dict[str, list[Row]]
Values = list[NDArray[Any]]


@dataclass(frozen=True, eq=False)
class _Grid:
    """The quantisation grid of positions: a point is low (3,) plus step times an integer, metres."""

    low: NDArray[np.float64]
    step: float


@dataclass(frozen=True, eq=False)
class _Stored:
    """An accessor's changed entries, its elements as bytes (n, s), and the filter that decodes them."""

    changes: Row
    elements: Bytes
    filter: str = "NONE"


def compressed(document: Document) -> Document:
    """Return a document that looks the same in about a third of the bytes.

    Positions become 16 bit on one grid around the whole tree, which is undone by the nodes, or by the inverse bind
    matrices of skinned meshes; normals octahedral of 8 bit; texture coordinates and application-specific attributes
    fixed-point; rotations of bones 16 bit. Vertices are renumbered in the order in which triangles use them; triangles
    keep their order.

    Raises
    ------
    ValueError
        A node with a mesh is transformed already.
    """
    tables = deepcopy(document.tables)
    old_views, rows = tables.pop("bufferViews"), tables.pop("accessors")
    values = [_values(document, row) for row in rows]
    roles = _roles(tables, len(rows))
    _renumber(tables, values)
    grid = _grid([array for array, role in zip(values, roles, strict=True) if role == "POSITION"])
    _dequantise(tables, values, grid)
    extensions = {MESHOPT, QUANTIZED}
    small = Document(tables=tables, used=document.used | extensions, required=document.required | extensions)
    _shrink_pictures(small, document, old_views)
    accessors = _Accessors(small, grid)
    for row, array, role in zip(rows, values, roles, strict=True):
        accessors.add(row, array, role)
    tables["buffers"] = [{"byteLength": accessors.decoded_bytes, "extensions": {MESHOPT: {"fallback": True}}}]
    return small


def _values(document: Document, row: Row) -> NDArray[Any]:
    """Read an accessor: (n, c)."""
    start = document.tables["bufferViews"][row["bufferView"]].get("byteOffset", 0) + row.get("byteOffset", 0)
    width = _WIDTHS[row["type"]]
    flat = np.frombuffer(document.binary, _TYPES[row["componentType"]], row["count"] * width, start)
    return flat.reshape(-1, width).copy()


def _roles(tables: Tables, count: int) -> list[str]:
    """List the role of each accessor: an attribute's name, INDICES, ROTATIONS, or an empty string."""
    roles = [""] * count
    for mesh in tables["meshes"]:
        for primitive in mesh["primitives"]:
            for name, index in primitive["attributes"].items():
                roles[index] = name
            roles[primitive["indices"]] = "INDICES"
    for animation in tables.get("animations", []):
        for channel in animation["channels"]:
            if channel["target"]["path"] == "rotation":
                roles[animation["samplers"][channel["sampler"]]["output"]] = "ROTATIONS"
    return roles


def _renumber(tables: Tables, values: Values) -> None:
    """Sort vertices by their first use in triangles, in place; those that several primitives share stay as they are."""
    primitives = [primitive for mesh in tables["meshes"] for primitive in mesh["primitives"]]
    users = Counter(index for part in primitives for index in (part["indices"], *part["attributes"].values()))
    for primitive in primitives:
        indices, columns = primitive["indices"], list(primitive["attributes"].values())
        if max(users[index] for index in (indices, *columns)) > 1:
            continue
        flat = values[indices].ravel()
        first = np.full(len(values[columns[0]]), len(flat))
        first[flat[::-1]] = np.arange(len(flat))[::-1]  # of several assignments the last one stays
        order = np.argsort(first, kind="stable")
        number = np.empty_like(order)
        number[order] = np.arange(len(order))
        values[indices] = number[flat].astype(flat.dtype)[:, None]
        for column in columns:
            values[column] = values[column][order]


def _grid(positions: Values) -> _Grid:
    """Lay a grid around all positions (n, 3); its steps are equal in all directions, so that normals stay valid."""
    low = np.min([array.min(axis=0) for array in positions], axis=0).astype(np.float64)
    high = np.max([array.max(axis=0) for array in positions], axis=0)
    return _Grid(low, max(float((high - low).max()) / _STEPS, 1e-9))


def _dequantise(tables: Tables, values: Values, grid: _Grid) -> None:
    """Make nodes, or the inverse bind matrices of skinned meshes, convert grid steps back to metres, in place."""
    for node in tables["nodes"]:
        if "mesh" in node and "skin" not in node:
            if {"translation", "rotation", "scale", "matrix", "children"} & set(node):
                raise ValueError(f"node {node.get('name')} has a mesh and must have no transform and no children")
            node["translation"], node["scale"] = grid.low.tolist(), [grid.step] * 3
    metres = np.diag([grid.step] * 3 + [1.0])
    metres[3, :3] = grid.low  # transposed: the file is column-major
    for index in {skin["inverseBindMatrices"] for skin in tables.get("skins", [])}:
        values[index] = (metres @ values[index].reshape(-1, 4, 4)).reshape(-1, 16).astype(np.float32)


class _Accessors:
    """Adds accessors to a document, compressed, and counts the bytes that a reader decodes them to."""

    def __init__(self, document: Document, grid: _Grid) -> None:
        self._document, self._grid = document, grid
        self.decoded_bytes = 0

    def add(self, row: Row, values: NDArray[Any], role: str) -> None:
        """Add an accessor by its row in the original document, its values (n, c) and its role."""
        stored = _stored(row, values, role, self._grid)
        stride = stored.elements.shape[1]
        if role == "INDICES":
            index = self._view("TRIANGLES", encode_triangles(values.reshape(-1, 3)), stored, {"target": INDICES})
        elif stride % 4:
            index = self._document.view(stored.elements.tobytes())
        else:
            vertices = {} if role in ("", "ROTATIONS") else {"target": VERTICES, "byteStride": stride}
            index = self._view("ATTRIBUTES", encode_attributes(stored.elements), stored, vertices)
        changed = {**{key: value for key, value in row.items() if key != "byteOffset"}, **stored.changes}
        self._document.row("accessors", {**changed, "bufferView": index})

    def _view(self, mode: str, content: bytes, stored: _Stored, target: Row) -> int:
        """Append a stream and add its buffer view, which also has a place in the fallback buffer; return its index."""
        count, stride = stored.elements.shape
        offset = len(self._document.binary)
        packed = {"buffer": 0, "byteOffset": offset, "byteLength": len(content), "byteStride": stride}
        packed |= {"count": count, "mode": mode}
        if stored.filter != "NONE":
            packed["filter"] = stored.filter
        self._document.binary += content + b"\0" * (-len(content) % 4)
        view: Row = {"buffer": 1, "byteOffset": self.decoded_bytes, "byteLength": count * stride, **target}
        size: int = count * stride
        self.decoded_bytes += size + -size % 4
        return self._document.row("bufferViews", {**view, "extensions": {MESHOPT: packed}})


def _stored(row: Row, values: NDArray[Any], role: str, grid: _Grid) -> _Stored:
    """Choose how the values (n, c) of an accessor are stored, by its role."""
    if role == "POSITION":
        whole = np.rint((values - grid.low) / grid.step).astype("<u2")
        bounds = {"min": whole.min(axis=0).tolist(), "max": whole.max(axis=0).tolist()}
        return _Stored({"componentType": _UNSIGNED_SHORT, **bounds}, _padded(whole))
    if role in ("NORMAL", "TANGENT"):
        return _Stored({"componentType": _BYTE, "normalized": True}, octahedral(values), "OCTAHEDRAL")
    if role.startswith("TEXCOORD"):
        places = values / np.iinfo(values.dtype).max if row.get("normalized") else values
        return _Stored({"componentType": _FLOAT, "normalized": False}, fixed_point(places, _UV_BITS), "EXPONENTIAL")
    if role.startswith("_") and row["componentType"] == _FLOAT:
        return _Stored({}, fixed_point(values, _SHARE_BITS), "EXPONENTIAL")
    if role == "ROTATIONS" and row["componentType"] == _FLOAT:
        rotations = np.rint(values.astype(np.float64) * 32767).astype("<i2")
        return _Stored({"componentType": _SHORT, "normalized": True}, rotations.view(np.uint8))
    raw = np.ascontiguousarray(values)
    return _Stored({}, raw.view(np.uint8) if role in ("", "INDICES") else _padded(raw))


def _padded(values: NDArray[Any]) -> Bytes:
    """Return values (n, c) as bytes (n, s), padded so that s is a multiple of 4."""
    raw = np.ascontiguousarray(values).view(np.uint8)
    return np.pad(raw, ((0, 0), (0, -raw.shape[1] % 4)))


def _shrink_pictures(small: Document, document: Document, old_views: list[Row]) -> None:
    """Encode pictures as WebP; alpha, and the colours of transparent pixels, stay exact."""
    tables = small.tables
    normal_maps = [row["normalTexture"]["index"] for row in tables["materials"] if "normalTexture" in row]
    fine = {tables["textures"][index]["source"] for index in normal_maps}
    for number, image in enumerate(tables.get("images", [])):
        view = old_views[image["bufferView"]]
        content = document.binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        out, quality = BytesIO(), _NORMAL_MAP_QUALITY if number in fine else _QUALITY
        Image.open(BytesIO(content)).save(out, "WEBP", quality=quality, method=4, exact=True)
        image |= {"mimeType": "image/webp", "bufferView": small.view(out.getvalue())}
    for texture in tables.get("textures", []):
        texture["extensions"] = {WEBP: {"source": texture.pop("source")}}
        small.used.add(WEBP)
        small.required.add(WEBP)
