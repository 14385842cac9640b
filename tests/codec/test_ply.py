from io import BytesIO

import numpy as np
import trimesh
from tests.builders import stick

from treestroke.codec.ply import encode_ply
from treestroke.core.geometry.mesh import Mesh, Surface
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.mesh.tubes import tubes
from treestroke.core.paint.atlas import Atlas


def bark() -> Surface:
    return Surface(tubes(stick()), np.full((8, 4, 3), (90, 60, 30), np.uint8))


def atlas() -> Atlas:
    """Draw two tiles beside each other: the right half of one is opaque, the middle square of the other."""
    image = np.zeros((16, 32, 4), np.uint8)
    image[:, 8:16] = image[4:12, 20:28] = (10, 200, 30, 255)
    return Atlas(image, np.array([[0, 0, 0.5, 1], [0.5, 0, 1, 1]]), np.array([[10.0, 200, 30]] * 2))


def leaves(tile: int = 0, flip: bool = False, shade: float = 1.0) -> Leaves:
    centre, right, up = (np.array([v], dtype=float) for v in ((5, 5, 5), (2, 0, 0), (0, 3, 0)))
    return Leaves(centre, right, up, np.array([tile]), np.array([flip]), np.array([shade]), np.array([0]))


def read(ply: bytes) -> trimesh.Trimesh:
    return trimesh.load(BytesIO(ply), file_type="ply", process=False)


def test_trimesh_reads_the_bark() -> None:
    mesh = read(encode_ply(bark(), None, None))
    assert np.array_equal(mesh.vertices, bark().mesh.positions)
    assert np.array_equal(mesh.faces, bark().mesh.triangles)
    assert (mesh.visual.vertex_colors[:, :3] == (90, 60, 30)).all()


def test_normals_are_those_of_the_bark() -> None:
    raw = read(encode_ply(bark(), None, None)).metadata["_ply_raw"]["vertex"]["data"]
    assert np.array_equal(np.stack([raw[name] for name in ("nx", "ny", "nz")], axis=1), bark().mesh.normals)


def test_the_header_explains_the_frame_and_the_labels_and_names_no_tool() -> None:
    head = encode_ply(bark(), leaves(), atlas()).split(b"end_header\n")[0].decode()
    assert [line for line in head.splitlines() if line.startswith("comment")] == [
        "comment treestroke: metres, right-handed, +Y up; label 0 bark, 1 leaf"
    ]
    assert "http" not in head


def test_the_same_tree_gives_the_same_bytes() -> None:
    assert encode_ply(bark(), leaves(), atlas()) == encode_ply(bark(), leaves(), atlas())


def test_faces_are_labelled() -> None:
    faces = read(encode_ply(bark(), leaves(), atlas())).metadata["_ply_raw"]["face"]["data"]
    assert faces["label"].ravel().tolist() == [0] * len(bark().mesh.triangles) + [1, 1]


def test_a_card_becomes_a_rhombus_of_its_spray_s_height_and_area() -> None:
    mesh = read(encode_ply(bark(), leaves(tile=1), atlas()))
    rhombus = mesh.vertices[-4:] - (5, 5, 5)
    assert np.allclose(rhombus, [[0, -1.5, 0], [2, 0, 0], [0, 1.5, 0], [-2, 0, 0]])
    assert np.isclose(mesh.area_faces[-2:].sum(), 4 * 6 / 4)  # a quarter of the card of 4 m by 6 m


def test_a_mirrored_card_lies_on_the_other_side_and_faces_the_same_way() -> None:
    plain, mirrored = (read(encode_ply(bark(), leaves(flip=flip), atlas())) for flip in (False, True))
    assert plain.vertices[-4:, 0].mean() > 5.5
    assert np.isclose(plain.vertices[-4:, 0].mean() - 5, 5 - mirrored.vertices[-4:, 0].mean())
    assert all((mesh.face_normals[-2:, 2] > 0.99).all() for mesh in (plain, mirrored))


def test_shades_darken_the_colour_as_light_does() -> None:
    bright, dark = (read(encode_ply(bark(), leaves(shade=s), atlas())).visual.vertex_colors[-1] for s in (1.0, 0.5))
    assert bright[:3].tolist() == [10, 200, 30]
    assert dark[:3].tolist() == [7, 146, 22]


def test_bark_takes_its_colours_from_where_it_lies_on_the_texture() -> None:
    triangle = Mesh(
        np.eye(3, dtype=np.float32),
        np.eye(3, dtype=np.float32),
        np.array([[0.1, 0.1], [0.9, 1.1], [-0.1, -0.1]], np.float32),
        np.array([[0, 1, 2]], np.uint32),
    )
    texture = np.array([[[1, 1, 1], [2, 2, 2]], [[3, 3, 3], [4, 4, 4]]], np.uint8)
    colours = read(encode_ply(Surface(triangle, texture), None, None)).visual.vertex_colors
    assert colours[:, 0].tolist() == [1, 2, 4]
