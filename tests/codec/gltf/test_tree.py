import json
from io import BytesIO

import numpy as np
import pygltflib
import pytest
import trimesh
from PIL import Image
from tests.builders import fork, oak, stick

from treestroke.codec.gltf.tree import Part, Provenance, encode_glb
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import Mesh, Surface
from treestroke.core.mesh.tubes import TubeParams, tubes

CAMERA = OrthographicCamera(640, 480, 0.01, (320.5, 450.25))


def bark(texture_height: int = 8) -> Surface:
    return Surface(tubes(stick(), TubeParams()), np.full((texture_height, 4, 3), 90, np.uint8))


def leaves(count: int = 2) -> Surface:
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    positions = np.concatenate([square + np.array([0, 0, k]) for k in range(count)]).astype(np.float32)
    faces = np.concatenate([np.array([[0, 1, 2], [0, 2, 3]]) + 4 * k for k in range(count)]).astype(np.uint32)
    shades = np.tile(np.array([0.0, 0.5, 1.0, 1.0], np.float32), count)
    uvs = np.tile(np.array([[0, 1], [1, 1], [1, 0], [0, 0.25]], np.float32), (count, 1))
    normals = np.tile(np.array([0, 0, 1], np.float32), (4 * count, 1))
    atlas = np.zeros((4, 4, 4), np.uint8)
    atlas[1:3, 1:3] = (10, 200, 30, 255)
    return Surface(Mesh(positions, normals, uvs, faces, shades), atlas)


def document(glb: bytes) -> dict:
    length = int.from_bytes(glb[12:16], "little")
    return json.loads(glb[20 : 20 + length])


def values(glb: bytes, index: int) -> np.ndarray:
    """Read an accessor by pygltflib, independently of the writer."""
    gltf = pygltflib.GLTF2.load_from_bytes(glb)
    row = gltf.accessors[index]
    view = gltf.bufferViews[row.bufferView]
    kind = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}[row.componentType]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[row.type]
    read = np.frombuffer(gltf.binary_blob(), kind, row.count * width, view.byteOffset)
    return read.reshape(row.count, width)


def test_the_header_tells_the_length() -> None:
    glb = encode_glb([Part("bark", bark()), Part("leaf", leaves())], CAMERA, provenance=Provenance("treestroke 1"))
    assert glb[:4] == b"glTF"
    assert int.from_bytes(glb[8:12], "little") == len(glb)
    assert len(glb) % 4 == 0


def test_geometry_returns_unchanged() -> None:
    surface = Surface(tubes(oak(), TubeParams()), np.zeros((4, 4, 3), np.uint8))
    glb = encode_glb([Part("bark", surface)], CAMERA, provenance=Provenance("treestroke 1"))
    primitive = document(glb)["meshes"][0]["primitives"][0]
    assert np.array_equal(values(glb, primitive["attributes"]["POSITION"]), surface.mesh.positions)
    assert np.array_equal(values(glb, primitive["attributes"]["NORMAL"]), surface.mesh.normals)
    assert np.array_equal(values(glb, primitive["attributes"]["TEXCOORD_0"]), surface.mesh.uvs)
    assert np.array_equal(values(glb, primitive["indices"]).reshape(-1, 3), surface.mesh.triangles)


def test_trimesh_reads_both_parts_by_name() -> None:
    glb = encode_glb([Part("bark", bark()), Part("leaf", leaves())], CAMERA, provenance=Provenance("treestroke 1"))
    scene = trimesh.load(BytesIO(glb), file_type="glb", process=False)
    assert set(scene.geometry) == {"bark", "leaf"}
    assert len(scene.geometry["leaf"].faces) == 4
    positions = bark().mesh.positions
    assert np.allclose(scene.geometry["bark"].bounds, [positions.min(axis=0), positions.max(axis=0)])


def test_the_scene_holds_the_photo_s_camera() -> None:
    scene = document(encode_glb([Part("bark", bark())], CAMERA, provenance=Provenance("treestroke 1")))["scenes"][0]
    photo = {"width": 640, "height": 480, "metres_per_pixel": 0.01, "root": [320.5, 450.25]}
    assert scene == {"nodes": [0], "extras": {"photo": photo}}


def test_materials_are_named_and_leaves_are_cut_out() -> None:
    wood, leaf = document(
        encode_glb([Part("bark", bark()), Part("leaf", leaves())], CAMERA, provenance=Provenance("treestroke 1"))
    )["materials"]
    assert (wood["name"], leaf["name"]) == ("bark", "leaf")
    assert "alphaMode" not in wood
    assert (leaf["alphaMode"], leaf["alphaCutoff"], leaf["doubleSided"]) == ("MASK", 0.3, True)


def test_bark_repeats_and_leaves_clamp() -> None:
    samplers = document(
        encode_glb([Part("bark", bark()), Part("leaf", leaves())], CAMERA, provenance=Provenance("treestroke 1"))
    )["samplers"]
    assert [s["wrapS"] for s in samplers] == [10497, 33071]


def test_leaf_coordinates_and_shades_are_normalised_integers() -> None:
    glb = encode_glb([Part("bark", bark()), Part("leaf", leaves())], CAMERA, provenance=Provenance("treestroke 1"))
    attributes = document(glb)["meshes"][1]["primitives"][0]["attributes"]
    rows = document(glb)["accessors"]
    assert [rows[attributes[a]]["normalized"] for a in ("TEXCOORD_0", "COLOR_0")] == [True, True]
    assert values(glb, attributes["TEXCOORD_0"])[:4].tolist() == [[0, 65535], [65535, 65535], [65535, 0], [0, 16384]]
    assert values(glb, attributes["COLOR_0"])[:2].tolist() == [[0, 0, 0, 255], [128, 128, 128, 255]]


def test_bark_without_shades_has_no_colours() -> None:
    glb = encode_glb([Part("bark", bark())], CAMERA, provenance=Provenance("treestroke 1"))
    assert "COLOR_0" not in document(glb)["meshes"][0]["primitives"][0]["attributes"]


def test_the_leaf_atlas_keeps_its_alpha_and_its_colours() -> None:
    glb = encode_glb([Part("bark", bark()), Part("leaf", leaves())], CAMERA, provenance=Provenance("treestroke 1"))
    gltf = pygltflib.GLTF2.load_from_bytes(glb)
    view = gltf.bufferViews[gltf.images[1].bufferView]
    content = gltf.binary_blob()[view.byteOffset : view.byteOffset + view.byteLength]
    assert np.array_equal(np.asarray(Image.open(BytesIO(content))), leaves().texture)


@pytest.mark.parametrize(("count", "width"), [(16_383, 5123), (16_384, 5125)])
def test_indices_are_as_narrow_as_they_can_be(count: int, width: int) -> None:
    glb = encode_glb([Part("bark", bark()), Part("leaf", leaves(count))], CAMERA, provenance=Provenance("treestroke 1"))
    gltf = document(glb)
    assert gltf["accessors"][gltf["meshes"][1]["primitives"][0]["indices"]]["componentType"] == width


def test_views_are_aligned_and_positions_bounded() -> None:
    gltf = document(
        encode_glb([Part("bark", bark(2)), Part("leaf", leaves())], CAMERA, provenance=Provenance("treestroke 1"))
    )
    assert all(view["byteOffset"] % 4 == 0 for view in gltf["bufferViews"])
    positions = gltf["accessors"][gltf["meshes"][1]["primitives"][0]["attributes"]["POSITION"]]
    assert (positions["min"], positions["max"]) == ([0, 0, 0], [1, 1, 1])


def test_equal_surfaces_give_equal_bytes() -> None:
    first, second = (
        encode_glb([Part("bark", bark()), Part("leaf", leaves())], CAMERA, provenance=Provenance("treestroke 1"))
        for _ in range(2)
    )
    assert first == second


def test_leaves_let_light_through_in_the_colours_of_their_picture() -> None:
    gltf = document(
        encode_glb([Part("bark", bark()), Part("leaf", leaves())], CAMERA, provenance=Provenance("treestroke 1"))
    )
    wood, leaf = gltf["materials"]
    through = leaf["extensions"]["KHR_materials_diffuse_transmission"]
    assert through["diffuseTransmissionColorTexture"] == leaf["pbrMetallicRoughness"]["baseColorTexture"]
    assert 0.3 <= through["diffuseTransmissionFactor"] <= 0.5
    assert gltf["extensionsUsed"] == ["KHR_materials_diffuse_transmission"]
    assert "extensions" not in wood
    assert "extensionsRequired" not in gltf


def test_a_normal_map_is_a_normal_texture() -> None:
    normal_map = np.full((8, 4, 3), (128, 128, 255), np.uint8)
    surface = Surface(bark().mesh, bark().texture, normal_map)
    gltf = document(encode_glb([Part("bark", surface)], CAMERA, provenance=Provenance("treestroke 1")))
    texture = gltf["textures"][gltf["materials"][0]["normalTexture"]["index"]]
    assert gltf["images"][texture["source"]]["name"] == "bark_relief"
    assert gltf["accessors"][gltf["meshes"][0]["primitives"][0]["attributes"]["TANGENT"]]["type"] == "VEC4"


def test_a_texture_s_sides_must_be_powers_of_two() -> None:
    with pytest.raises(ValueError, match="powers of two"):
        encode_glb([Part("bark", bark(7))], CAMERA, provenance=Provenance("treestroke 1"))


def test_twigs_have_the_same_picture_without_normal_map_and_tangents() -> None:
    normal_map = np.full((8, 4, 3), (128, 128, 255), np.uint8)
    surface = Surface(tubes(fork(child_radius=0.004), TubeParams()), bark().texture, normal_map)
    gltf = document(encode_glb([Part("bark", surface)], CAMERA, provenance=Provenance("treestroke 1")))
    assert [one["name"] for one in gltf["materials"]] == ["bark", "bark_twigs"]
    wood, twigs = (gltf["materials"][one["material"]] for one in gltf["meshes"][0]["primitives"])
    assert wood["pbrMetallicRoughness"] == twigs["pbrMetallicRoughness"]
    assert [("normalTexture" in one) for one in (wood, twigs)] == [True, False]
    assert [("TANGENT" in one["attributes"]) for one in gltf["meshes"][0]["primitives"]] == [True, False]
    counts = [gltf["accessors"][one["indices"]]["count"] for one in gltf["meshes"][0]["primitives"]]
    assert sum(counts) == surface.mesh.triangles.size
    assert min(counts) > 0
