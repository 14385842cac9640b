import numpy as np
import pytest
from tests.sketched import Stroke, neat, sketched

from treestroke.core.lift.path_pairs import PathPair, PathTrie, align_paths
from treestroke.core.lift.pruning import TOLERANCE, prune
from treestroke.core.lift.retrieval import PAIRED
from treestroke.core.lift.sketch_tree import prepare_sketch

STEM = [(0.0, 300.0), (0.0, 1000.0)]
RIGHT: Stroke = (0, 1, [(300.0, 700.0)])
LEFT: Stroke = (0, 1, [(-200.0, 700.0)])


def begun(front: tuple[Stroke, ...] = (RIGHT, LEFT), side: tuple[Stroke, ...] = (RIGHT, LEFT)) -> PathTrie:
    """Begin a tree with the stems of two sketches."""
    sketches = prepare_sketch(sketched(STEM, *front), 6.0), prepare_sketch(sketched(STEM, *side), 6.0)
    tree = PathTrie(sketches)
    insert(tree, 0, 0)
    return tree


def insert(tree: PathTrie, front: int, side: int) -> None:
    """Add the aligned paths of a branch of the front and one of the side."""
    found = align_paths(tree.sketches, tree.sketches[0].paths[front], tree.sketches[1].paths[side])
    tree.insert(0, found, np.full(found.joints.shape[1], PAIRED))


def along(lead: list[tuple[float, float]], follow: list[tuple[float, float]]) -> PathPair:
    """Return a path pair with the given positions."""
    places = np.array([lead, follow], dtype=np.float64)
    joints = np.tile(np.arange(len(lead)), (2, 1))
    return PathPair(
        joints, np.concatenate([places, np.zeros((2, len(lead), 1))], axis=2), np.zeros(len(lead), dtype=bool)
    )


def test_aligned_paths_keep_to_equal_heights() -> None:
    front, side = (prepare_sketch(sketch, 6.0) for sketch in neat())
    found = align_paths((front, side), front.paths[1], side.paths[1])
    assert np.abs(found.apart).max() < 2.0
    assert [set(chain) for chain in found.joints] == [set(front.paths[1]), set(side.paths[1])]


def test_at_unequal_heights_the_path_that_moves_gives_the_height_and_the_other_s_view_is_unsupported() -> None:
    found = along([(0, 0), (0, 10), (0, 10), (0, 10)], [(0, 0), (0, 10), (30, 30), (60, 50)])
    assert found.uneven_runs.tolist() == [[2, 4]]
    assert found.leader_height.tolist() == [True, True, False, False]
    assert found.unsupported == pytest.approx(np.array([[0, 0, 20, 20], [0, 0, 0, 0]]))
    assert found.lengths()[2] == pytest.approx(30)


def test_at_equal_heights_nothing_is_unsupported() -> None:
    found = along([(0, 0), (3, 10), (6, 23)], [(0, 0), (5, 8), (9, 20)])
    assert found.leader_height.all()
    assert not found.unsupported.any()


def test_a_pair_inserted_twice_adds_its_joints_once() -> None:
    tree = begun()
    insert(tree, 1, 1)
    count = len(tree.points)
    insert(tree, 1, 1)
    assert len(tree.points) == count
    assert tree.parents[0] == -1
    assert all(parent < joint for joint, parent in enumerate(tree.parents))


def test_a_pair_leaves_the_tree_where_either_path_does() -> None:
    tree = begun()
    stem = len(tree.points)
    insert(tree, 1, 0)
    bud = tree.points[tree.parents[stem]]
    assert bud[:3] == pytest.approx([0, 300, 0], abs=6)
    insert(tree, 1, 2)
    points = np.array(tree.points)
    assert points[-1, :3] == pytest.approx([300, 700, -200])


def test_both_sketches_joints_are_used_where_heights_agree() -> None:
    tree = begun()
    insert(tree, 1, 2)
    front, side = tree.sketches
    assert tree.used[0][front.branch_joints[1]].all()
    assert tree.used[1][side.branch_joints[2]].mean() > 0.95
    assert not tree.used[0][front.branch_joints[2]].any()


def test_ends_that_show_nothing_new_are_pruned() -> None:
    tree = begun()
    for front, side in ((1, 1), (2, 2), (1, 2)):
        insert(tree, front, side)
    found, _, _ = prune(tree)
    tips = {
        tuple(found.skeleton.points[found.branch == b][-1].round().tolist()) for b in range(1, found.branch.max() + 1)
    }
    assert tips == {(300.0, 700.0, 300.0), (-200.0, 700.0, -200.0)}


def test_pruning_keeps_the_shape_with_fewer_joints() -> None:
    tree = begun()
    insert(tree, 1, 2)
    found, joints, origins = prune(tree)
    assert len(found) == joints.shape[1] == len(origins) < 0.5 * len(tree.points)
    limb = found.skeleton.points[found.branch == 1]
    for x, y, z, _ in np.array(tree.points)[np.array(tree.pair_number) == 1]:
        near = [np.interp(y, limb[:, 1], limb[:, axis]) for axis in (0, 2)]
        assert near == pytest.approx([x, z], abs=2 * TOLERANCE)
