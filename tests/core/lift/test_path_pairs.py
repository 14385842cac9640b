import numpy as np
import pytest
from tests.sketched import Stroke, neat, sketched

from treestroke.core.lift.path_pairs import Walk, Weave, walk
from treestroke.core.lift.retrieval import PAIRED
from treestroke.core.lift.sheet import sheet
from treestroke.core.lift.trimming import TOLERANCE, trimmed

STEM = [(0.0, 300.0), (0.0, 1000.0)]
RIGHT: Stroke = (0, 1, [(300.0, 700.0)])
LEFT: Stroke = (0, 1, [(-200.0, 700.0)])


def weave(front: tuple[Stroke, ...] = (RIGHT, LEFT), side: tuple[Stroke, ...] = (RIGHT, LEFT)) -> Weave:
    """Begin a tree with the stems of two sketches."""
    sheets = sheet(sketched(STEM, *front), 6.0), sheet(sketched(STEM, *side), 6.0)
    begun = Weave(sheets, (np.zeros(len(sheets[0].points), dtype=bool), np.zeros(len(sheets[1].points), dtype=bool)))
    laid(begun, 0, 0)
    return begun


def laid(tree: Weave, front: int, side: int) -> None:
    """Walk a branch of the front with one of the side, all from the root."""
    found = walk(tree.sheets, tree.sheets[0].paths[front], tree.sheets[1].paths[side])
    tree.lay(0, found, np.full(found.joints.shape[1], PAIRED))


def along(lead: list[tuple[float, float]], follow: list[tuple[float, float]]) -> Walk:
    """Give a walk by its places."""
    places = np.array([lead, follow], dtype=np.float64)
    joints = np.tile(np.arange(len(lead)), (2, 1))
    return Walk(joints, np.concatenate([places, np.zeros((2, len(lead), 1))], axis=2), np.zeros(len(lead), dtype=bool))


def test_walkers_keep_to_equal_heights() -> None:
    front, side = (sheet(sketch, 6.0) for sketch in neat())
    found = walk((front, side), front.paths[1], side.paths[1])
    assert np.abs(found.apart).max() < 2.0
    assert [set(chain) for chain in found.joints] == [set(front.paths[1]), set(side.paths[1])]


def test_at_unequal_heights_the_one_that_moves_leads_and_the_other_s_view_is_invented() -> None:
    found = along([(0, 0), (0, 10), (0, 10), (0, 10)], [(0, 0), (0, 10), (30, 30), (60, 50)])
    assert found.runs.tolist() == [[2, 4]]
    assert found.led.tolist() == [True, True, False, False]
    assert found.invented == pytest.approx(np.array([[0, 0, 20, 20], [0, 0, 0, 0]]))
    assert found.lengths()[2] == pytest.approx(30)


def test_at_equal_heights_nothing_is_invented() -> None:
    found = along([(0, 0), (3, 10), (6, 23)], [(0, 0), (5, 8), (9, 20)])
    assert found.led.all()
    assert not found.invented.any()


def test_what_is_laid_twice_stands_once() -> None:
    tree = weave()
    laid(tree, 1, 1)
    count = len(tree.points)
    laid(tree, 1, 1)
    assert len(tree.points) == count
    assert tree.parents[0] == -1
    assert all(parent < joint for joint, parent in enumerate(tree.parents))


def test_a_walk_leaves_the_tree_where_either_path_does() -> None:
    tree = weave()
    stem = len(tree.points)
    laid(tree, 1, 0)
    bud = tree.points[tree.parents[stem]]
    assert bud[:3] == pytest.approx([0, 300, 0], abs=6)
    laid(tree, 1, 2)
    points = np.array(tree.points)
    assert points[-1, :3] == pytest.approx([300, 700, -200])


def test_both_sketches_joints_are_used_where_heights_agree() -> None:
    tree = weave()
    laid(tree, 1, 2)
    front, side = tree.sheets
    assert tree.used[0][front.own[1]].all()
    assert tree.used[1][side.own[2]].mean() > 0.95
    assert not tree.used[0][front.own[2]].any()


def test_ends_that_show_nothing_new_are_trimmed() -> None:
    tree = weave()
    for front, side in ((1, 1), (2, 2), (1, 2)):
        laid(tree, front, side)
    found, _, _ = trimmed(tree)
    tips = {
        tuple(found.skeleton.points[found.branch == b][-1].round().tolist()) for b in range(1, found.branch.max() + 1)
    }
    assert tips == {(300.0, 700.0, 300.0), (-200.0, 700.0, -200.0)}


def test_trimming_keeps_the_course_with_fewer_joints() -> None:
    tree = weave()
    laid(tree, 1, 2)
    found, joints, origins = trimmed(tree)
    assert len(found) == joints.shape[1] == len(origins) < 0.5 * len(tree.points)
    limb = found.skeleton.points[found.branch == 1]
    for x, y, z, _ in np.array(tree.points)[np.array(tree.walks) == 1]:
        near = [np.interp(y, limb[:, 1], limb[:, axis]) for axis in (0, 2)]
        assert near == pytest.approx([x, z], abs=2 * TOLERANCE)
