"""A glTF document made smaller: rounded vertices, compressed buffer views, WebP.

Extensions: KHR_mesh_quantization, EXT_meshopt_compression, EXT_texture_webp, all required of readers.
"""

from collections import Counter
from copy import deepcopy
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from treestroke.codec.gltf.book import Book
from treestroke.codec.gltf.meshopt import Bytes, encode_attributes, encode_triangles, fixed_point, octahedral

MESHOPT, QUANTIZED, WEBP = "EXT_meshopt_compression", "KHR_mesh_quantization", "EXT_texture_webp"
_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_BYTE, _SHORT, _UNSIGNED_SHORT, _FLOAT = 5120, 5122, 5123, 5126
_STEPS = 65535
"""Of a position along the tree's longest side: 0.15 mm on a tree of 10 m."""
_UV_BITS, _SHARE_BITS = 12, 8
"""Behind the point: of a texture coordinate, an eighth of a texel of 512; of an attribute of our own, 0 to 1."""
_QUALITY, _RELIEF_QUALITY = 86, 94
Row = dict[str, Any]
Tables = dict[str, list[Row]]
Values = list[NDArray[Any]]


@dataclass(frozen=True, eq=False)
class _Grid:
    """Where positions are rounded to: the world's point is low + step times the whole number."""

    low: NDArray[np.float64]
    step: float


@dataclass(frozen=True, eq=False)
class _Stored:
    """How values are stored: the accessor's changed entries, elements as bytes (n, s), the filter that unfolds them."""

    changes: Row
    elements: Bytes
    filter: str = "NONE"


def compressed(book: Book) -> Book:
    """Give a document of the same look in about a third of the bytes.

    Positions become 16 bit on one grid around the whole tree, which the nodes undo, or the inverse bind matrices where
    vertices follow bones; normals octahedral of 8 bit; texture coordinates and attributes of our own fixed-point; turns
    of bones 16 bit. Vertices are renumbered in the order in which triangles name them; triangles keep their order.

    Raises
    ------
    ValueError
        A node with a mesh is moved already.
    """
    tables = deepcopy(book.tables)
    old_views, rows = tables.pop("bufferViews"), tables.pop("accessors")
    values = [_values(book, row) for row in rows]
    roles = _roles(tables, len(rows))
    _renumber(tables, values)
    grid = _grid([one for one, role in zip(values, roles, strict=True) if role == "POSITION"])
    _undo(tables, values, grid)
    small = Book(tables=tables, used=book.used | {MESHOPT, QUANTIZED}, required=book.required | {MESHOPT, QUANTIZED})
    _shrink_pictures(small, book, old_views)
    room = 0
    for row, one, role in zip(rows, values, roles, strict=True):
        room = _store(small, row, one, role, grid, room)
    tables["buffers"] = [{"byteLength": room, "extensions": {MESHOPT: {"fallback": True}}}]
    return small


def _values(book: Book, row: Row) -> NDArray[Any]:
    """Read an accessor (n, c)."""
    start = book.tables["bufferViews"][row["bufferView"]].get("byteOffset", 0) + row.get("byteOffset", 0)
    width = _WIDTHS[row["type"]]
    flat = np.frombuffer(book.binary, _TYPES[row["componentType"]], row["count"] * width, start)
    return flat.reshape(-1, width).copy()


def _roles(tables: Tables, count: int) -> list[str]:
    """Tell what each accessor is for: an attribute's name, INDICES, TURNS, or nothing in particular."""
    roles = [""] * count
    for mesh in tables["meshes"]:
        for primitive in mesh["primitives"]:
            for name, index in primitive["attributes"].items():
                roles[index] = name
            roles[primitive["indices"]] = "INDICES"
    for animation in tables.get("animations", []):
        for channel in animation["channels"]:
            if channel["target"]["path"] == "rotation":
                roles[animation["samplers"][channel["sampler"]]["output"]] = "TURNS"
    return roles


def _renumber(tables: Tables, values: Values) -> None:
    """Put vertices in the order in which triangles first name them; those that several primitives share stay."""
    primitives = [primitive for mesh in tables["meshes"] for primitive in mesh["primitives"]]
    users = Counter(index for one in primitives for index in (one["indices"], *one["attributes"].values()))
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
    """Lay a grid around all positions; its steps are equal on all sides, since normals allow no others."""
    low = np.min([one.min(axis=0) for one in positions], axis=0).astype(np.float64)
    high = np.max([one.max(axis=0) for one in positions], axis=0)
    return _Grid(low, max(float((high - low).max()) / _STEPS, 1e-9))


def _undo(tables: Tables, values: Values, grid: _Grid) -> None:
    """Let nodes bring whole numbers back to metres; where bones place the vertices, the bones' rest does."""
    for node in tables["nodes"]:
        if "mesh" in node and "skin" not in node:
            if {"translation", "rotation", "scale", "matrix", "children"} & set(node):
                raise ValueError(f"node {node.get('name')} has a mesh and is moved or has children already")
            node["translation"], node["scale"] = grid.low.tolist(), [grid.step] * 3
    metres = np.diag([grid.step] * 3 + [1.0])
    metres[3, :3] = grid.low  # transposed, as columns stand in the file
    for index in {skin["inverseBindMatrices"] for skin in tables.get("skins", [])}:
        values[index] = (metres @ values[index].reshape(-1, 4, 4)).reshape(-1, 16).astype(np.float32)


def _store(small: Book, row: Row, values: NDArray[Any], role: str, grid: _Grid, room: int) -> int:
    """Enter an accessor with its compressed view, which unfolds behind ``room`` bytes: where the next one does."""
    stored = _stored(row, values, role, grid)
    count, stride = stored.elements.shape
    changed = {**{key: value for key, value in row.items() if key != "byteOffset"}, **stored.changes}
    triangles = role == "INDICES"
    if not triangles and stride % 4:
        small.row("accessors", {**changed, "bufferView": small.view(stored.elements.tobytes())})
        return room
    content = encode_triangles(values.reshape(-1, 3)) if triangles else encode_attributes(stored.elements)
    packed = {"buffer": 0, "byteOffset": len(small.binary), "byteLength": len(content), "byteStride": stride}
    packed |= {"count": count, "mode": "TRIANGLES" if triangles else "ATTRIBUTES"}
    if stored.filter != "NONE":
        packed["filter"] = stored.filter
    small.binary += content + b"\0" * (-len(content) % 4)
    view: Row = {"buffer": 1, "byteOffset": room, "byteLength": count * stride}
    if triangles or role not in ("", "TURNS"):
        view |= {"target": 34963} if triangles else {"target": 34962, "byteStride": stride}
    index = small.row("bufferViews", {**view, "extensions": {MESHOPT: packed}})
    small.row("accessors", {**changed, "bufferView": index})
    size: int = count * stride
    return room + size + -size % 4


def _stored(row: Row, values: NDArray[Any], role: str, grid: _Grid) -> _Stored:
    """Choose how an accessor's values are stored."""
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
    if role == "TURNS" and row["componentType"] == _FLOAT:
        turns = np.rint(values.astype(np.float64) * 32767).astype("<i2")
        return _Stored({"componentType": _SHORT, "normalized": True}, turns.view(np.uint8))
    raw = np.ascontiguousarray(values)
    return _Stored({}, raw.view(np.uint8) if role in ("", "INDICES") else _padded(raw))


def _padded(values: NDArray[Any]) -> Bytes:
    """Give values (n, c) as bytes (n, s), s a multiple of 4."""
    raw = np.ascontiguousarray(values).view(np.uint8)
    return np.pad(raw, ((0, 0), (0, -raw.shape[1] % 4)))


def _shrink_pictures(small: Book, book: Book, old_views: list[Row]) -> None:
    """Encode pictures anew as WebP: alpha and what lies behind it stay."""
    tables = small.tables
    relief = [one["normalTexture"]["index"] for one in tables["materials"] if "normalTexture" in one]
    fine = {tables["textures"][index]["source"] for index in relief}
    for number, image in enumerate(tables.get("images", [])):
        view = old_views[image["bufferView"]]
        content = book.binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        out, quality = BytesIO(), _RELIEF_QUALITY if number in fine else _QUALITY
        Image.open(BytesIO(content)).save(out, "WEBP", quality=quality, method=4, exact=True)
        image |= {"mimeType": "image/webp", "bufferView": small.view(out.getvalue())}
    for texture in tables.get("textures", []):
        texture["extensions"] = {WEBP: {"source": texture.pop("source")}}
        small.used.add(WEBP)
        small.required.add(WEBP)
