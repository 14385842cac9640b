import numpy as np
from tests.builders import fork

from treestroke.core.geometry.mesh import Mesh
from treestroke.core.geometry.parts import LEAST_RELIEF, part_of, shows_relief
from treestroke.core.mesh.tubes import tubes


def square(side: float, repeats: float) -> Mesh:
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    return Mesh(corners * side, np.tile(np.float32([0, 0, 1]), (4, 1)), corners[:, :2] * repeats, faces)


def test_relief_shows_where_the_texture_is_laid_large() -> None:
    limit = 1 / LEAST_RELIEF
    assert shows_relief(square(10.0, 0.9 * limit)).all()
    assert not shows_relief(square(10.0, 1.1 * limit)).any()


def test_a_trunk_shows_relief_and_a_twig_does_not() -> None:
    mesh = tubes(fork(child_radius=0.004))
    shown = shows_relief(mesh)
    aside = mesh.positions[mesh.triangles].mean(axis=1)[:, 0] > 0.4
    assert aside.any()
    assert not shown[aside].any()
    assert shown[~aside].mean() > 0.5


def test_two_parts_make_the_whole() -> None:
    mesh = tubes(fork(child_radius=0.004))
    shown = shows_relief(mesh)
    for kept in (shown, ~shown):
        part, vertices = part_of(mesh, kept)
        assert np.array_equal(part.positions[part.triangles], mesh.positions[mesh.triangles[kept]])
        assert np.array_equal(part.positions, mesh.positions[vertices])
        assert part.hold is not None
        assert mesh.hold is not None
        assert np.array_equal(part.hold.joints, mesh.hold.joints[vertices])
