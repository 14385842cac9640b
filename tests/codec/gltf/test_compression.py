import json
from io import BytesIO

import numpy as np
import pytest
from PIL import Image
from tests.builders import oak
from tests.codec.gltf.unfolding import unfold

from treestroke.codec.gltf.compression import compressed
from treestroke.codec.gltf.document import Document, Material
from treestroke.codec.gltf.tree import Part, Provenance, encode_glb
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import Mesh, Surface
from treestroke.core.mesh.tubes import tubes

CAMERA = OrthographicCamera(640, 480, 0.01, (320.5, 450.25))
MESHOPT = "EXT_meshopt_compression"
TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def leaves(count: int = 40) -> Surface:
    rng = np.random.default_rng(0)
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]) / 4
    positions = (rng.uniform(-3, 3, (count, 1, 3)) + square).reshape(-1, 3).astype(np.float32)
    normals = np.repeat(rng.normal(size=(count, 3)), 4, axis=0)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    uvs = np.tile(np.array([[0, 1], [1, 1], [1, 0], [0, 0.25]], np.float32), (count, 1))
    faces = (4 * np.arange(count)[:, None, None] + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3).astype(np.uint32)
    atlas = rng.integers(0, 256, (64, 64, 4)).astype(np.uint8)
    return Surface(Mesh(positions, normals.astype(np.float32), uvs, faces, rng.random(4 * count, np.float32)), atlas)


def parts() -> list[Part]:
    return [Part("bark", Surface(tubes(oak()), np.full((64, 32, 3), 90, np.uint8))), Part("leaf", leaves())]


def opened(glb: bytes) -> tuple[dict, bytes]:
    length = int.from_bytes(glb[12:16], "little")
    return json.loads(glb[20 : 20 + length]), glb[28 + length :]


def accessors(glb: bytes) -> list[np.ndarray]:
    """Read all accessors of a compressed file by a decoder that is not ours, in their own numbers."""
    document, content = opened(glb)
    read = unfold(
        content, [document["bufferViews"][row["bufferView"]]["extensions"][MESHOPT] for row in document["accessors"]]
    )
    values = []
    for row, raw in zip(document["accessors"], read, strict=True):
        kind = np.dtype(TYPES[row["componentType"]])
        values.append(raw[:, : WIDTHS[row["type"]] * kind.itemsize].copy().view(kind))
    return values


def corners(mesh: Mesh) -> np.ndarray:
    """List positions, texture coordinates and normals by corner, so that vertices' numbers do not matter."""
    columns = np.concatenate([mesh.positions, mesh.uvs, mesh.normals], axis=1)
    first = np.argmin(mesh.triangles, axis=1)[:, None]
    return columns[np.take_along_axis(mesh.triangles, (first + np.arange(3)) % 3, axis=1)]


def meshes(glb: bytes) -> list[Mesh]:
    document, _ = opened(glb)
    values = accessors(glb)
    found = []
    for node in document["nodes"]:
        primitive = document["meshes"][node["mesh"]]["primitives"][0]
        named = {name: values[index] for name, index in primitive["attributes"].items()}
        positions = np.array(node["translation"]) + np.array(node["scale"]) * named["POSITION"]
        faces = values[primitive["indices"]].reshape(-1, 3).astype(np.uint32)
        normals = named["NORMAL"] / np.linalg.norm(named["NORMAL"].astype(float), axis=1, keepdims=True)
        found.append(Mesh(positions, normals, named["TEXCOORD_0"], faces))
    return found


def test_every_triangle_keeps_its_place_within_a_step() -> None:
    glb = encode_glb(parts(), CAMERA, provenance=Provenance("x"), compress=True)
    for part, read in zip(parts(), meshes(glb), strict=True):
        given = part.surface.mesh
        # Triangles keep their order; which corner comes first is the codec's choice, so corners are compared as sets.
        near = np.abs(corners(given)[:, :, None] - corners(read)[:, None]).max(axis=3) < 0.02
        assert near.any(axis=2).all()
        assert np.allclose(read.positions.min(axis=0), given.positions.min(axis=0), atol=1e-4)
        assert np.allclose(read.positions.max(axis=0), given.positions.max(axis=0), atol=1e-4)


def test_shades_stay_as_they_are() -> None:
    glb = encode_glb(parts(), CAMERA, provenance=Provenance("x"), compress=True)
    document, _ = opened(glb)
    shades = accessors(glb)[document["meshes"][1]["primitives"][0]["attributes"]["COLOR_0"]]
    assert np.array_equal(shades[:, 0], np.rint(leaves().mesh.shades.astype(float) * 255))


def test_the_document_says_what_a_reader_needs() -> None:
    document, content = opened(encode_glb(parts(), CAMERA, provenance=Provenance("x"), compress=True))
    assert document["extensionsRequired"] == [MESHOPT, "EXT_texture_webp", "KHR_mesh_quantization"]
    assert set(document["extensionsRequired"]) < set(document["extensionsUsed"])
    stand_in = document["buffers"][1]
    assert stand_in["extensions"] == {MESHOPT: {"fallback": True}}
    folded = [view for view in document["bufferViews"] if MESHOPT in view.get("extensions", {})]
    assert max(view["byteOffset"] + view["byteLength"] for view in folded) <= stand_in["byteLength"]
    assert all(
        view["byteLength"] == view["extensions"][MESHOPT]["count"] * view["extensions"][MESHOPT]["byteStride"]
        for view in folded
    )
    assert len(content) == document["buffers"][0]["byteLength"]


def test_pictures_are_webp_of_the_same_alpha() -> None:
    document, content = opened(encode_glb(parts(), CAMERA, provenance=Provenance("x"), compress=True))
    assert [image["mimeType"] for image in document["images"]] == ["image/webp"] * 2
    assert [texture["extensions"] for texture in document["textures"]] == [
        {"EXT_texture_webp": {"source": k}} for k in (0, 1)
    ]
    view = document["bufferViews"][document["images"][1]["bufferView"]]
    picture = Image.open(BytesIO(content[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]))
    assert picture.format == "WEBP"
    assert np.array_equal(np.asarray(picture)[..., 3], leaves().texture[..., 3])


def skinned() -> Document:
    """Write a triangle that follows one bone, which turns."""
    document = Document()
    triangle = Mesh(
        np.array([[1, 0, 0], [3, 0, 0], [1, 2, 1]], np.float32),
        np.tile(np.array([0, 0, 1], np.float32), (3, 1)),
        np.zeros((3, 2), np.float32),
        np.array([[0, 1, 2]], np.uint32),
    )
    surface = Surface(triangle, np.zeros((4, 4, 3), np.uint8))
    material = document.material("bark", surface, Material({"pbrMetallicRoughness": {}}, 10497))
    mesh = document.row("meshes", {"name": "bark", "primitives": [document.primitive(triangle, material)]})
    document.row("nodes", {"mesh": mesh, "skin": 0})
    document.row("nodes", {"name": "root"})
    rest = np.eye(4, dtype=np.float32)
    rest[3, :3] = (-5, 0, 0)  # transposed: the bone's head lies at x = 5
    document.row("skins", {"joints": [1], "inverseBindMatrices": document.accessor(rest.reshape(1, 16))})
    rotations = np.array([[0, 0, 0, 1], [0.6, 0, 0, 0.8]], np.float32)
    sampler = {
        "input": document.accessor(np.array([0, 1], np.float32), bounded=True),
        "output": document.accessor(rotations),
    }
    channel = {"sampler": 0, "target": {"node": 1, "path": "rotation"}}
    document.row("animations", {"samplers": [sampler], "channels": [channel]})
    return document


def test_bones_at_rest_bring_their_vertices_back_to_metres() -> None:
    glb = compressed(skinned()).glb({"asset": {"version": "2.0"}})
    document, _ = opened(glb)
    values = accessors(glb)
    rest = values[document["skins"][0]["inverseBindMatrices"]].reshape(4, 4).T
    whole = values[document["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    placed = np.column_stack([whole, np.ones(3)]) @ rest.T
    assert np.allclose(placed[:, :3] + (5, 0, 0), [[1, 0, 0], [3, 0, 0], [1, 2, 1]], atol=1e-4)
    assert "scale" not in document["nodes"][0]


def test_rotations_of_bones_become_16_bit() -> None:
    glb = compressed(skinned()).glb({"asset": {"version": "2.0"}})
    document, _ = opened(glb)
    sampler = document["animations"][0]["samplers"][0]
    row = document["accessors"][sampler["output"]]
    assert (row["componentType"], row["normalized"]) == (5122, True)
    assert np.allclose(accessors(glb)[sampler["output"]] / 32767, [[0, 0, 0, 1], [0.6, 0, 0, 0.8]], atol=2e-5)
    assert accessors(glb)[sampler["input"]].ravel().tolist() == [0, 1]


def test_vertices_that_two_meshes_share_keep_their_numbers() -> None:
    document = skinned()
    document.tables["meshes"].append(document.tables["meshes"][0])
    document.row("nodes", {"mesh": 1})
    before = json.dumps(document.tables)
    values = accessors(compressed(document).glb({"asset": {"version": "2.0"}}))
    assert values[document.tables["meshes"][0]["primitives"][0]["indices"]].ravel().tolist() == [0, 1, 2]
    assert json.dumps(document.tables) == before


def test_a_mesh_with_a_transform_is_refused() -> None:
    document = skinned()
    document.row("nodes", {"name": "odd", "mesh": 0, "translation": [1, 0, 0]})
    with pytest.raises(ValueError, match="node odd"):
        compressed(document)


def test_equal_trees_give_equal_bytes() -> None:
    first, second = (encode_glb(parts(), CAMERA, provenance=Provenance("x"), compress=True) for _ in range(2))
    assert first == second
    assert len(first) < len(encode_glb(parts(), CAMERA, provenance=Provenance("x"))) / 2
