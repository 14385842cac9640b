from collections import Counter

import numpy as np
import pytest
import trimesh

from treestroke.core.geometry.clumped_crown import Cells
from treestroke.core.geometry.surface_nets import surface

SIDE = 0.1


def ball(radius: int = 20) -> Cells:
    """Give a ball of cells around the origin."""
    middle = np.arange(2 * radius + 4) + 0.5 - (radius + 2)
    x, y, z = np.meshgrid(middle, middle, middle, indexing="ij")
    return Cells(x * x + y * y + z * z < radius**2, np.full(3, -SIDE * (radius + 2)), SIDE)


@pytest.mark.parametrize("most", [300, 3000])
def test_a_ball_of_cells_has_the_surface_of_a_ball(most: int) -> None:
    points, triangles = surface(ball(), most)
    assert most / 2 < len(triangles) <= most
    away = np.linalg.norm(points, axis=1)
    assert away == pytest.approx(np.full(len(points), 2.0), abs=0.2)
    mesh = trimesh.Trimesh(points, triangles, process=False)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(4 / 3 * np.pi * 8, rel=0.05)  # and not minus that: its outside is outside


def test_the_surface_of_any_cells_is_closed() -> None:
    filled = np.random.default_rng(3).random((14, 20, 11)) < 0.3
    points, triangles = surface(Cells(filled, np.zeros(3), SIDE), 4000)
    edges = Counter(
        tuple(sorted(edge)) for face in triangles.tolist() for edge in zip(face, face[1:] + face[:1], strict=True)
    )
    assert all(count % 2 == 0 for count in edges.values())
    assert len(np.unique(triangles)) == len(points)


@pytest.mark.parametrize("shape", [(1, 1, 1), (1, 9, 1), (60, 2, 2)])
def test_a_few_cells_have_a_surface_around_them(shape: tuple[int, int, int]) -> None:
    points, triangles = surface(Cells(np.ones(shape, np.bool_), np.array([1.0, 2.0, 3.0]), SIDE), 4000)
    assert len(triangles) >= 8
    middle = np.array([1.0, 2.0, 3.0]) + SIDE * np.array(shape) / 2
    assert points.mean(axis=0) == pytest.approx(middle, abs=SIDE)
    assert (points.min(axis=0) > np.array([1.0, 2.0, 3.0]) - SIDE).all()
