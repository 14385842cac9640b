"""What a form makes of the limbs that nobody sees: measured on trees grown from a trunk alone."""

import numpy as np
import pytest
from tests.core.grow.crowns import trunk_case

from treestroke.core.grow.grown import Grown
from treestroke.core.grow.habit import HABITS, UNSTEERED, Habit, Rise, habit_of
from treestroke.core.grow.library import choose_library
from treestroke.core.grow.params import growth_for
from treestroke.core.grow.replacement import Replacement, grow
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.types import TREE_FORMS, Floats, TreeForm

CASE = trunk_case(top=200.0)


def grown(form: TreeForm) -> Grown:
    method = Replacement(choose_library("auto", "leaves", CASE.skeleton, form), growth_for("leaves", 150, form))
    return grow(CASE.skeleton, CASE.crown, method, np.random.default_rng(0))


GROWN = {form: grown(form) for form in TREE_FORMS}


def limbs(form: TreeForm) -> tuple[Floats, Floats]:
    """Heights (n,), metres, at which limbs leave the stem, and the sine of their rise (n,) over their first stretch."""
    tree = GROWN[form].skeleton
    stem = np.hypot(tree.points[:, 0], tree.points[:, 2]) < 1e-6
    first = np.flatnonzero(~stem & stem[np.maximum(tree.parents, 0)] & (tree.parents >= 0))
    way = tree.points[first] - tree.points[tree.parents[first]]
    return tree.points[tree.parents[first], 1], way[:, 1] / np.linalg.norm(way, axis=1)


def from_stem_deg(form: TreeForm) -> float:
    """Angle, degrees, between the upright stem and its limbs' mean rise."""
    return float(np.degrees(np.arccos(limbs(form)[1].mean())))


def rise(form: TreeForm) -> float:
    """Mean sine of the rise of all new wood, by its length."""
    tree = GROWN[form]
    way = tree.skeleton.points - tree.skeleton.points[tree.skeleton.parents]
    new = (tree.born > 0) & (np.hypot(way[:, 0], way[:, 2]) > 1e-6)
    return float(way[new, 1].sum() / edge_lengths(tree.skeleton)[new].sum())


def test_a_round_tree_is_not_steered() -> None:
    assert HABITS["round"] is UNSTEERED
    assert np.array_equal(UNSTEERED.steering(np.arange(1, 5), np.full(4, 0.4)), [(1.0, 0.0)] * 4)


def test_a_form_steers_limbs_by_their_height_and_leaves_the_finest_shoots() -> None:
    habit = Habit(Rise(0.5, -0.4, 0.4), Rise(0.2, 0.1, 0.1))
    steering = habit.steering(np.array([1, 2, 1, 4]), np.array([0.75, 0.75, 7.0, 0.75]))
    assert steering == pytest.approx(np.array([(0.5, 0.2), (0.2, 0.1), (0.5, 0.4), (1.0, 0.0)]))


def test_a_spires_limbs_are_flatter_and_its_lowest_the_lowest() -> None:
    heights, sines = limbs("spire")
    low = heights < np.median(heights)
    assert np.abs(sines).mean() < 0.55 * np.abs(limbs("round")[1]).mean()
    assert sines[low].mean() < sines[~low].mean() - 0.1


def test_a_spire_of_scales_stands_where_one_of_needles_lies_in_layers() -> None:
    generations, heights = np.array([1, 1, 2]), np.array([0.2, 0.9, 0.5])
    needles, scales = (habit_of("spire", kind).steering(generations, heights) for kind in ("needles", "scales"))
    assert (scales[:, 1] > needles[:, 1] + 0.2).all()
    assert habit_of("spire", "needles") is HABITS["spire"]
    assert habit_of("weeping", "scales") is HABITS["weeping"]


def test_columns_and_several_stems_stand_and_weeping_trees_hang() -> None:
    columnar, multi_stem, round_tree = (from_stem_deg(form) for form in ("columnar", "multi_stem", "round"))
    assert max(columnar, multi_stem) < 0.75 * round_tree
    assert rise("columnar") > rise("round") + 0.15
    assert rise("weeping") < -0.2 < rise("round")


@pytest.mark.parametrize("form", ["vase", "multi_stem", "umbrella"])
def test_limbs_leave_the_stem_low_down(form: TreeForm) -> None:
    assert np.quantile(limbs(form)[0], 0.9) < np.quantile(limbs("round")[0], 0.75)


@pytest.mark.parametrize("form", TREE_FORMS)
def test_every_form_fills_the_crown_and_stays_in_it(form: TreeForm) -> None:
    tree = GROWN[form]
    points = tree.skeleton.points[tree.born > 0]
    assert tree.attractors_reached > 0.6
    assert np.quantile(CASE.volume.reach(points), 0.999) <= 1.0
