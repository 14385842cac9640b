import numpy as np
import pytest
from tests.core.grow.crowns import trunk_case

from treestroke.core.geometry.vectors import UP
from treestroke.core.grow.branches import Chain
from treestroke.core.grow.form import UP_IN_PICTURE, BranchTable, Form, VisibleTree, curve_shoots
from treestroke.core.grow.growth_space import GrowthSpace
from treestroke.core.skeleton.skeleton import Skeleton


@pytest.fixture
def crown() -> GrowthSpace:
    return trunk_case().space()


def curved(crown: GrowthSpace) -> tuple[Form, np.ndarray]:
    """Curve one shoot from the middle of an upright stem; return the form and the shoot's tip."""
    low, high = np.array([160.0, 275.0, 0.0]), np.array([160.0, 120.0, 0.0])
    stem = Skeleton(np.stack([low, high]), np.array([4.0, 2.0]), np.array([-1, 0]))
    tip = np.array([200.0, 180.0, 10.0])
    table = BranchTable(np.array([-1, 0]), np.array([0.0, 0.5]), np.stack([high, tip]), np.array([0, 3]))
    return curve_shoots(VisibleTree(stem, 2, [Chain(np.array([0, 1]), 1)]), table, crown, np.random.default_rng(0)), tip


def test_the_picture_s_up_is_the_world_s_with_y_down() -> None:
    assert UP_IN_PICTURE.tolist() == [UP[0], -UP[1], UP[2]]


def test_visible_joints_stay_and_a_joint_is_inserted_where_a_shoot_begins(crown: GrowthSpace) -> None:
    form, _ = curved(crown)
    assert form.points[:3] == pytest.approx(np.array([[160, 275, 0], [160, 197.5, 0], [160, 120, 0]]))
    assert form.measured[:3] == pytest.approx([4, 3, 2])
    assert form.parents[:4].tolist() == [-1, 0, 1, 1]


def test_a_shoot_ends_at_its_tip_and_counts_as_grown_in_its_iteration(crown: GrowthSpace) -> None:
    form, tip = curved(crown)
    assert form.points[-1] == pytest.approx(tip)
    assert (form.born[3:] == 3).all()
    assert (form.measured[3:] == 0).all()
