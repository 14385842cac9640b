import numpy as np
import pytest
from tests.core.grow.sketched import tree

from treestroke.core.grow.parent_branches import BARE, across, parents_from_main, parents_from_small


def test_no_small_branch_grows_below_a_stem_s_lowest_limb_or_at_a_limb_s_base() -> None:
    main = tree()
    parents = parents_from_main(main, 0.3, 4)
    on_stem = parents.branch == 0
    assert (parents.weight[on_stem & (parents.points[:, 1] < 3.5)] == 0).all()
    assert (parents.weight[on_stem & (parents.points[:, 1] > 3.6)] > 0).all()
    assert np.array_equal(parents.weight[~on_stem] > 0, parents.place[~on_stem] >= BARE)


def test_first_parts_begin_at_the_bud_and_run_along_their_chord_with_length_1() -> None:
    shapes = parents_from_main(tree(), 0.3, 4).shapes
    assert np.linalg.norm(np.diff(shapes, axis=1), axis=2).sum(axis=1) == pytest.approx(1)
    assert shapes[:, 0] == pytest.approx(0)
    assert shapes[:, -1] == pytest.approx(np.tile([1.0, 0.0, 0.0], (len(shapes), 1)))


def test_cut_joints_of_small_branches_are_not_nodes() -> None:
    points = np.array([[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0]]])
    parents = parents_from_small(points, np.array([[3, 7, -1]]), 0.5, 1)
    assert parents.joints.tolist() == [7]
    assert parents.along == pytest.approx(np.array([[0.0, 1.0, 0.0]]))
    assert parents.lengths == pytest.approx([2])


def test_across_gives_two_unit_vectors_perpendicular_to_each_direction() -> None:
    directions = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.6, 0.0, 0.8]])
    side, other = across(directions)
    for first, second in ((directions, side), (directions, other), (side, other)):
        assert (first * second).sum(axis=1) == pytest.approx(0)
    assert np.linalg.norm(other, axis=1) == pytest.approx(1)
