import numpy as np
import pytest
from tests.core.grow.crowns import limbed_case, trunk_case

from treestroke.core.geometry.vectors import unit
from treestroke.core.grow.growth_space import GrowthSpace, in_mask
from treestroke.core.grow.limb_ends import LEAST_REACH, MOST_REACH, with_limbs_extended
from treestroke.core.grow.stem import foot_of
from treestroke.core.skeleton.skeleton import Skeleton

CROWN_HEIGHT = 240.0


def forked(end_y: float, end_x: float = 200.0) -> tuple[Skeleton, GrowthSpace]:
    """A trunk with one limb of ten joints that leaves it at (160, 330) px and ends at a place."""
    case = trunk_case()
    px = case.visible
    start = int(np.argmin(np.abs(px.points[:, 1] - 330)))
    way = np.linspace(px.points[start], [end_x, end_y, 0.0], 11)[1:]
    parents = np.r_[px.parents, start, len(px) + np.arange(9)]
    tree = Skeleton(np.vstack([px.points, way]), np.r_[px.radii, np.full(10, 4.0)], parents)
    return tree, case.space(foot_of(px, case.mask))


def test_a_limb_that_ends_under_the_crown_goes_on_into_it() -> None:
    tree, crown = forked(end_y=295.0)
    longer = with_limbs_extended(tree, crown)
    assert not in_mask(tree.points[-1:], crown.mask).any()
    assert crown.inside(longer.points[-1:]).all()
    assert longer.parents[len(tree)] == len(tree) - 1


def test_what_is_there_stays_and_what_is_new_stays_in_the_crown() -> None:
    case = limbed_case()
    tree = case.visible
    crown = case.space(foot_of(tree, case.mask))
    longer = with_limbs_extended(tree, crown)
    np.testing.assert_array_equal(longer.points[: len(tree)], tree.points)
    assert len(longer) > len(tree)
    assert crown.inside(longer.points[len(tree) :]).all()


def test_no_limb_that_goes_on_ends_in_a_curl() -> None:
    case = limbed_case()
    crown = case.space(foot_of(case.visible, case.mask))
    longer = with_limbs_extended(case.visible, crown)
    ends = np.setdiff1d(np.arange(len(case.visible), len(longer)), longer.parents)
    outward = unit(longer.points[ends] - crown.foot)
    assert ((longer.points[ends] - longer.points[longer.parents[ends]]) * outward).sum(axis=1).min() > 0


def test_wood_that_goes_on_tapers() -> None:
    tree, crown = forked(end_y=295.0)
    longer = with_limbs_extended(tree, crown)
    new = np.arange(len(tree), len(longer))
    assert (longer.radii[new] < longer.radii[longer.parents[new]]).all()
    assert longer.radii[-1] > 0


def test_a_limb_goes_on_without_a_kink() -> None:
    tree, crown = forked(end_y=295.0)
    longer = with_limbs_extended(tree, crown).points
    before, after = longer[len(tree) - 1] - longer[len(tree) - 2], longer[len(tree)] - longer[len(tree) - 1]
    assert before @ after > 0.95 * np.linalg.norm(before) * np.linalg.norm(after)


@pytest.mark.parametrize("radius", [0.5, 4.0, 40.0])
def test_wood_reaches_as_far_as_its_thickness_lets_it(radius: float) -> None:
    tree, crown = forked(end_y=250.0)
    thick = Skeleton(tree.points, np.r_[tree.radii[:-10], np.full(10, radius)], tree.parents)
    longer = with_limbs_extended(thick, crown).points[len(tree) - 1 :]
    reach = np.clip(55 * radius, LEAST_REACH * CROWN_HEIGHT, MOST_REACH * CROWN_HEIGHT)
    assert 0 < np.linalg.norm(np.diff(longer, axis=0), axis=1).sum() <= 1.4 * reach


def test_a_limb_far_under_the_crown_and_a_spur_stay() -> None:
    far, crown = forked(end_y=420.0, end_x=240.0)
    assert with_limbs_extended(far, crown) is far
    spur, crown = forked(end_y=328.0, end_x=166.0)
    assert with_limbs_extended(spur, crown) is spur


def test_no_limb_grows_over_the_trees_top() -> None:
    case = trunk_case(top=250.0)
    px = case.visible
    assert with_limbs_extended(px, case.space(foot_of(px, case.mask))) is px
