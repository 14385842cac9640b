import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.builders import fork, oak, stick
from tests.core.mesh.test_lod_tubes import any_tree

from treestroke.core.geometry.mesh import Mesh
from treestroke.core.mesh.collision_hulls import MAX_TRIANGLES, collision_hulls
from treestroke.core.skeleton.skeleton import Skeleton


def solid(mesh: Mesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.positions, mesh.triangles, process=False)


@given(st.integers(0, 100_000))
@settings(max_examples=40, deadline=None)
def test_any_tree_gives_closed_hulls_of_few_triangles(seed: int) -> None:
    body = solid(collision_hulls(any_tree(seed)))
    assert len(body.faces) <= MAX_TRIANGLES
    assert body.is_watertight
    assert body.is_winding_consistent
    assert body.volume > 0


def test_each_piece_is_convex() -> None:
    assert all(piece.is_convex for piece in solid(collision_hulls(oak(orders=5))).split())


def test_a_stick_keeps_its_volume() -> None:
    body = solid(collision_hulls(stick(radius=0.1, tip_radius=0.1)))
    assert body.volume == pytest.approx(np.pi * 0.1**2 * 4.0, rel=0.1)
    assert body.bounds[:, 1] == pytest.approx([0.0, 4.0])


def test_a_straight_limb_takes_one_hull() -> None:
    assert len(collision_hulls(stick(joints=40)).triangles) == 20


def test_a_limb_that_turns_back_on_itself_has_solid_hulls() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 0, 0], [1, 0, 0]], dtype=float)
    body = solid(collision_hulls(Skeleton(points, np.full(4, 0.1), np.array([-1, 0, 1, 2]))))
    assert body.is_watertight
    assert body.volume > 0


def test_the_same_tree_gives_the_same_hulls() -> None:
    first, second = (collision_hulls(oak(orders=5)) for _ in range(2))
    assert np.array_equal(first.positions, second.positions)
    assert np.array_equal(first.triangles, second.triangles)


def test_each_main_limb_has_hulls_and_twigs_have_none() -> None:
    def joints(tree: Skeleton) -> set[int]:
        attachment = collision_hulls(tree).attachment
        assert attachment is not None
        return set(attachment.joints.ravel().tolist())

    tip = len(fork()) - 1
    assert tip in joints(fork())
    assert tip not in joints(fork(child_radius=0.01))


def test_vertices_are_attached_to_the_tree_s_own_joints() -> None:
    tree = oak(orders=5)
    mesh = collision_hulls(tree)
    assert mesh.attachment is not None
    held = tree.points[mesh.attachment.joints[:, 0]]
    assert np.linalg.norm(mesh.positions - held, axis=1).max() < 0.35
