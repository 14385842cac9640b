import json

import numpy as np
from tests.builders import stick

from treestroke.codec.gltf.instances import encode_instanced, quaternions
from treestroke.codec.gltf.tree import Part, Provenance
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import Surface
from treestroke.core.leaf.cards import cards
from treestroke.core.leaf.leaves import Leaves, no_leaves
from treestroke.core.mesh.tubes import tubes
from treestroke.core.paint.atlas import Atlas

CAMERA = OrthographicCamera(640, 480, 0.01, (320.5, 450.25))
TYPES = {5121: "<u1", 5122: "<i2", 5123: "<u2", 5126: "<f4"}
FULL = {5121: 255, 5122: 32767, 5123: 65535}
WIDTHS = {"VEC2": 2, "VEC3": 3, "VEC4": 4}
BARK = Part("bark", Surface(tubes(stick()), np.full((8, 4, 3), 90, np.uint8)))
ATLAS = Atlas(np.zeros((16, 32, 4), np.uint8), np.array([[0, 0, 0.5, 1], [0.5, 0, 1, 1]]), np.zeros((2, 3)))


def leaves(count: int = 50) -> Leaves:
    rng = np.random.default_rng(0)
    axes = np.linalg.qr(rng.normal(size=(count, 3, 3)))[0]
    rights, ups = axes[:, 0] * rng.uniform(0.1, 0.3, (count, 1)), axes[:, 1] * rng.uniform(0.1, 0.3, (count, 1))
    tiles, flips = rng.integers(0, 2, count), rng.random(count) < 0.5
    centres = rng.normal(size=(count, 3))
    return Leaves(centres, rights, ups, tiles, flips, rng.random(count), np.zeros(count, dtype=np.int64))


def opened(glb: bytes) -> tuple[dict, bytes]:
    length = int.from_bytes(glb[12:16], "little")
    return json.loads(glb[20 : 20 + length]), glb[28 + length :]


def values(document: dict, content: bytes, index: int) -> np.ndarray:
    row = document["accessors"][index]
    start, kind = document["bufferViews"][row["bufferView"]]["byteOffset"], row["componentType"]
    read = np.frombuffer(content, TYPES[kind], row["count"] * WIDTHS[row["type"]], start).astype(float)
    return read.reshape(row["count"], -1) / (FULL[kind] if row.get("normalized") else 1)


def turned(quaternion: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    axis, real = quaternion[:3], quaternion[3]
    return vectors + 2 * np.cross(axis, np.cross(axis, vectors) + real * vectors)


def test_instances_are_where_the_cards_are() -> None:
    document, content = opened(encode_instanced(BARK, leaves(), ATLAS, CAMERA, provenance=Provenance("x")))
    placed = []
    for node in document["nodes"][1:-1]:
        shape = document["meshes"][node["mesh"]]["primitives"][0]["attributes"]
        flat, uvs = (values(document, content, shape[name]) for name in ("POSITION", "TEXCOORD_0"))
        given = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]
        columns = (values(document, content, given[name]) for name in ("TRANSLATION", "ROTATION", "SCALE", "_COLOR_0"))
        for place, turn, scale, colour in zip(*columns, strict=True):
            corners = place + turned(turn, flat * scale)
            placed.append(np.column_stack([corners, uvs, np.full(4, colour[0])]).ravel())
    mesh = cards(leaves(), ATLAS)
    wanted = np.column_stack([mesh.positions, mesh.uvs, mesh.shades]).reshape(50, -1)
    placed = np.array(placed)
    nearest = np.abs(wanted[:, None] - placed[None]).max(axis=2).argmin(axis=1)
    assert sorted(nearest) == list(range(50))
    assert np.allclose(placed[nearest], wanted, atol=3e-3)


def test_the_extension_is_used_not_required() -> None:
    document, _ = opened(encode_instanced(BARK, leaves(), ATLAS, CAMERA, provenance=Provenance("x")))
    assert "EXT_mesh_gpu_instancing" in document["extensionsUsed"]
    assert "extensionsRequired" not in document
    assert [material["name"] for material in document["materials"]] == ["bark", "leaf"]


def test_each_picture_and_its_mirror_image_have_a_node_under_the_leaf() -> None:
    document, _ = opened(encode_instanced(BARK, leaves(), ATLAS, CAMERA, provenance=Provenance("x")))
    names = [node["name"] for node in document["nodes"]]
    assert names == ["bark", "leaf_00", "leaf_00_mirrored", "leaf_01", "leaf_01_mirrored", "leaf"]
    assert document["nodes"][-1]["children"] == [1, 2, 3, 4]
    assert document["scenes"][0]["nodes"] == [0, 5]


def test_a_bare_tree_is_its_bark() -> None:
    document, _ = opened(encode_instanced(BARK, no_leaves(), ATLAS, CAMERA, provenance=Provenance("x")))
    assert [node["name"] for node in document["nodes"]] == ["bark"]
    assert "EXT_mesh_gpu_instancing" not in document.get("extensionsUsed", [])


def test_quaternions_turn_as_their_matrices_do() -> None:
    turns = np.linalg.qr(np.random.default_rng(0).normal(size=(200, 3, 3)))[0]
    turns *= np.linalg.det(turns)[:, None, None]
    turns = np.concatenate([turns, [np.eye(3), np.diag([1, -1, -1]), np.diag([-1, 1, -1]), np.diag([-1, -1, 1])]])
    for turn, quaternion in zip(turns, quaternions(turns), strict=True):
        assert np.allclose(turned(quaternion, np.eye(3)), turn.T)
