import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.builders import fork, oak, stick
from tests.core.mesh.test_coarse import any_tree

from treestroke.core.geometry.mesh import Mesh
from treestroke.core.mesh.collision import MAX_TRIANGLES, collision


def solid(mesh: Mesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.positions, mesh.triangles, process=False)


@given(st.integers(0, 100_000))
@settings(max_examples=40, deadline=None)
def test_any_tree_gives_closed_solids_of_few_triangles(seed: int) -> None:
    body = solid(collision(any_tree(seed)))
    assert len(body.faces) <= MAX_TRIANGLES
    assert body.is_watertight
    assert body.is_winding_consistent


def test_a_stick_keeps_its_volume() -> None:
    body = solid(collision(stick(radius=0.1, tip_radius=0.1)))
    assert body.volume == pytest.approx(np.pi * 0.1**2 * 4.0, rel=0.1)
    assert body.bounds[:, 1] == pytest.approx([0.0, 4.0])


def test_a_straight_limb_takes_one_prism() -> None:
    assert len(collision(stick(joints=40)).triangles) == 24


def test_each_main_limb_is_a_solid_and_twigs_are_none() -> None:
    assert solid(collision(fork())).body_count == 2
    assert solid(collision(fork(child_radius=0.01))).body_count == 1


def test_vertices_hold_to_the_tree_s_own_joints() -> None:
    tree = oak(orders=5)
    mesh = collision(tree)
    assert mesh.hold is not None
    held = tree.points[mesh.hold.joints[:, 0]]
    assert np.linalg.norm(mesh.positions - held, axis=1).max() < 0.35
