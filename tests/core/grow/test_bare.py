import numpy as np

from treestroke.core.grow.bare import grown_as_traced
from treestroke.core.skeleton.skeleton import Skeleton

TREE = Skeleton(np.zeros((4, 3)) + np.arange(4)[:, None], np.array([3.0, 2.0, 2.5, 1.0]), np.array([-1, 0, 1, 1]))


def test_the_tree_stays_and_no_joint_is_thicker_than_its_parent() -> None:
    grown = grown_as_traced(TREE, 1, 0.9)
    assert np.array_equal(grown.skeleton.points, TREE.points)
    assert grown.skeleton.radii.tolist() == [3.0, 2.0, 2.0, 1.0]


def test_hidden_joints_count_as_grown() -> None:
    assert grown_as_traced(TREE, 1, 0.9).born.tolist() == [0, 0, 0, 1]
    assert grown_as_traced(TREE, 0, 0.9).born.tolist() == [0, 0, 0, 0]
