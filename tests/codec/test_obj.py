from io import BytesIO
from pathlib import Path

import numpy as np
import trimesh
from PIL import Image
from tests.builders import oak, stick

from treestroke.codec.obj import encode_obj
from treestroke.core.geometry.mesh import Mesh, Surface
from treestroke.core.mesh.tubes import tubes


def bark() -> Surface:
    return Surface(tubes(oak()), np.full((8, 4, 3), 90, np.uint8))


def leaf() -> Surface:
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    uvs = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    atlas = np.arange(64, dtype=np.uint8).reshape(4, 4, 4)
    return Surface(Mesh(square, np.tile(np.float32([0, 0, 1]), (4, 1)), uvs, faces), atlas)


def test_files_are_named_by_the_stem_and_by_each_other() -> None:
    files = encode_obj(bark(), leaf(), "oak")
    assert list(files) == ["oak.obj", "oak.mtl", "oak_bark.jpg", "oak_leaf.png", "oak_leaf_alpha.png"]
    named = [line.split()[1] for line in files["oak.mtl"].decode().splitlines() if line.startswith("map_")]
    assert named == ["oak_bark.jpg", "oak_leaf.png", "oak_leaf_alpha.png"]
    assert files["oak.obj"].startswith(b"mtllib oak.mtl\n")


def test_trimesh_reads_both_objects(tmp_path: Path) -> None:
    for name, content in encode_obj(bark(), leaf(), "oak").items():
        (tmp_path / name).write_bytes(content)
    scene = trimesh.load(tmp_path / "oak.obj", process=False)
    for name, surface in (("bark", bark()), ("leaf", leaf())):
        read = scene.geometry[name]
        assert np.allclose(read.triangles, surface.mesh.positions[surface.mesh.triangles], atol=1e-5)
        assert read.visual.material.name == name


def test_v_points_upward() -> None:
    text = encode_obj(bark(), leaf(), "oak")["oak.obj"].decode()
    after = text[text.index("o leaf") :].splitlines()
    assert [line for line in after if line.startswith("vt")] == [
        "vt 0.00000 0.00000",
        "vt 1.00000 0.00000",
        "vt 1.00000 1.00000",
        "vt 0.00000 1.00000",
    ]


def test_corners_are_counted_from_one_through_both_objects() -> None:
    bare = Surface(tubes(stick()), bark().texture)
    lines = encode_obj(bare, leaf(), "oak")["oak.obj"].decode().splitlines()
    first = len(bare.mesh.positions) + 1
    assert lines[-2:] == [
        "f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}".format(*(first + corner for corner in corners))
        for corners in ((0, 1, 2), (0, 2, 3))
    ]


def test_the_alpha_picture_holds_the_alpha_in_both_channels() -> None:
    picture = Image.open(BytesIO(encode_obj(bark(), leaf(), "oak")["oak_leaf_alpha.png"]))
    assert picture.mode == "LA"
    assert all(np.array_equal(np.asarray(picture)[..., k], leaf().texture[..., 3]) for k in (0, 1))


def test_a_bare_tree_has_one_object() -> None:
    files = encode_obj(bark(), None, "oak")
    assert list(files) == ["oak.obj", "oak.mtl", "oak_bark.jpg"]
    assert b"leaf" not in files["oak.obj"] + files["oak.mtl"]
