import json
from io import BytesIO
from pathlib import Path

import numpy as np
import trimesh
from PIL import Image
from tests.builders import stick

from treestroke.codec.gltf.loose import encode_gltf
from treestroke.codec.gltf.tree import Part, Provenance, encode_glb
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import Surface
from treestroke.core.mesh.tubes import tubes

CAMERA = OrthographicCamera(640, 480, 0.01, (320.5, 450.25))


def parts() -> list[Part]:
    mesh = tubes(stick())
    atlas = np.arange(64, dtype=np.uint8).reshape(4, 4, 4)
    return [Part("bark", Surface(mesh, np.full((8, 4, 3), 90, np.uint8))), Part("leaf", Surface(mesh, atlas))]


def test_files_are_named_by_the_stem() -> None:
    files = encode_gltf(parts(), CAMERA, provenance=Provenance("x"), stem="my oak")
    assert list(files) == ["my oak.gltf", "my oak.bin", "my oak_bark.jpg", "my oak_leaf.png"]
    document = json.loads(files["my oak.gltf"])
    assert document["buffers"] == [{"byteLength": len(files["my oak.bin"]), "uri": "my%20oak.bin"}]
    assert [image["uri"] for image in document["images"]] == ["my%20oak_bark.jpg", "my%20oak_leaf.png"]


def test_pictures_are_those_of_the_glb() -> None:
    files = encode_gltf(parts(), CAMERA, provenance=Provenance("x"), stem="oak")
    assert np.array_equal(np.asarray(Image.open(BytesIO(files["oak_leaf.png"]))), parts()[1].surface.texture)


def test_the_document_says_what_the_glb_says() -> None:
    glb = encode_glb(parts(), CAMERA, provenance=Provenance("x"))
    inside = json.loads(glb[20 : 20 + int.from_bytes(glb[12:16], "little")])
    beside = json.loads(encode_gltf(parts(), CAMERA, provenance=Provenance("x"), stem="oak")["oak.gltf"])
    for table in ("asset", "scenes", "nodes", "meshes", "materials", "textures", "samplers", "extensionsUsed"):
        assert beside[table] == inside[table]


def test_trimesh_reads_it(tmp_path: Path) -> None:
    for name, content in encode_gltf(parts(), CAMERA, provenance=Provenance("x"), stem="oak").items():
        (tmp_path / name).write_bytes(content)
    scene = trimesh.load(tmp_path / "oak.gltf", process=False)
    mesh = parts()[0].surface.mesh
    assert np.array_equal(scene.geometry["bark"].vertices, mesh.positions)
    assert np.array_equal(scene.geometry["bark"].faces, mesh.triangles)
