import numpy as np
import pytest
from tests.builders import fork

from treestroke.core.geometry.mesh import Mesh, submesh
from treestroke.core.mesh.tubes import tubes


def columns(**changes: np.ndarray) -> dict[str, np.ndarray]:
    corners = np.eye(3, dtype=np.float32)
    table = {
        "positions": corners,
        "normals": corners,
        "uvs": np.zeros((3, 2), np.float32),
        "triangles": np.array([[0, 1, 2]], np.uint32),
    }
    return {**table, **changes}


def test_shades_may_be_absent() -> None:
    assert Mesh(**columns()).shades is None


def test_a_mesh_may_be_empty() -> None:
    none = np.empty((0, 3), np.float32)
    assert len(Mesh(none, none, np.empty((0, 2), np.float32), np.empty((0, 3), np.uint32)).positions) == 0


@pytest.mark.parametrize(
    ("name", "array"),
    [
        ("positions", np.zeros((3, 2), np.float32)),
        ("normals", np.zeros((2, 3), np.float32)),
        ("uvs", np.zeros((3, 3), np.float32)),
        ("shades", np.zeros(2, np.float32)),
        ("triangles", np.zeros((1, 4), np.uint32)),
        ("triangles", np.zeros(3, np.uint32)),
    ],
)
def test_columns_that_do_not_fit_are_refused(name: str, array: np.ndarray) -> None:
    with pytest.raises(ValueError, match=r"must be|need 2|need 3|3 vertices"):
        Mesh(**columns(**{name: array}))


def test_a_triangle_without_its_vertex_is_refused() -> None:
    with pytest.raises(ValueError, match="refers to a vertex that does not exist"):
        Mesh(**columns(triangles=np.array([[0, 1, 3]], np.uint32)))


def test_two_submeshes_make_up_the_whole() -> None:
    mesh = tubes(fork(child_radius=0.004))
    upper = mesh.positions[mesh.triangles].mean(axis=1)[:, 1] > 1.0
    for kept in (upper, ~upper):
        part, vertices = submesh(mesh, kept)
        assert np.array_equal(part.positions[part.triangles], mesh.positions[mesh.triangles[kept]])
        assert np.array_equal(part.positions, mesh.positions[vertices])
        assert part.attachment is not None
        assert mesh.attachment is not None
        assert np.array_equal(part.attachment.joints, mesh.attachment.joints[vertices])
