from dataclasses import replace

import numpy as np
import pytest
from tests.builders import fork, oak

from treestroke.core.geometry.mesh import Mesh
from treestroke.core.geometry.tangents import MIN_TEXTURE_WIDTH, shows_normal_map, tangents
from treestroke.core.mesh.tubes import tubes


def square(uvs: list[list[float]]) -> Mesh:
    """Build a square in the plane z = 0 that faces +Z, its corners counter-clockwise from the lower left."""
    positions = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    normals = np.tile(np.float32([0, 0, 1]), (4, 1))
    return Mesh(positions, normals, np.array(uvs, np.float32), np.array([[0, 1, 2], [0, 2, 3]], np.uint32))


@pytest.mark.parametrize(
    ("uvs", "tangent"),
    [
        ([[0, 1], [1, 1], [1, 0], [0, 0]], [1, 0, 0, 1]),  # the picture as it is: v grows downward
        ([[1, 1], [0, 1], [0, 0], [1, 0]], [-1, 0, 0, -1]),  # mirrored
        ([[0, 0], [0, 1], [1, 1], [1, 0]], [0, 1, 0, 1]),  # a quarter turn to the left
    ],
)
def test_tangents_run_as_the_picture_does(uvs: list[list[float]], tangent: list[float]) -> None:
    assert np.allclose(tangents(square(uvs)), tangent)


def test_bark_s_tangents_are_unit_and_at_right_angles_to_its_normals() -> None:
    mesh = tubes(oak())
    found = tangents(mesh)
    assert np.allclose(np.linalg.norm(found[:, :3], axis=1), 1)
    assert np.abs((found[:, :3] * mesh.normals).sum(axis=1)).max() < 1e-6
    assert set(found[:, 3]) <= {-1.0, 1.0}


def test_without_coordinates_a_tangent_is_still_a_direction() -> None:
    found = tangents(square([[0, 0]] * 4))
    assert np.allclose(np.linalg.norm(found[:, :3], axis=1), 1)
    assert np.allclose(found[:, 2], 0)


def tiled(side: float, repeats: float) -> Mesh:
    """Build a square of ``side`` metres on which the texture repeats."""
    flat = square([[0, 0], [repeats, 0], [repeats, repeats], [0, repeats]])
    return replace(flat, positions=flat.positions * np.float32(side))


def test_a_normal_map_shows_where_the_texture_is_laid_large() -> None:
    limit = 1 / MIN_TEXTURE_WIDTH
    assert shows_normal_map(tiled(10.0, 0.9 * limit)).all()
    assert not shows_normal_map(tiled(10.0, 1.1 * limit)).any()


def test_a_trunk_shows_normal_map_and_a_twig_does_not() -> None:
    mesh = tubes(fork(child_radius=0.004))
    shown = shows_normal_map(mesh)
    aside = mesh.positions[mesh.triangles].mean(axis=1)[:, 0] > 0.4
    assert aside.any()
    assert not shown[aside].any()
    assert shown[~aside].mean() > 0.5
