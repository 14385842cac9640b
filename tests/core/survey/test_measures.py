from dataclasses import replace

import numpy as np
import pytest
from tests.builders import fork, oak, stick

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.outline_volume import TurnedOutline, TwoOutlines
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.survey.measures import Measures, Scale, Stature, measure_tree

CAMERA = OrthographicCamera(400, 500, 0.01, (200.0, 450.0))
ROWS = np.arange(500)
DISC = TurnedOutline(CAMERA, np.full(500, 200.0), np.where((ROWS >= 100) & (ROWS < 300), 100.0, 0.0), ())
GIVEN, KNOWN = Scale(0.01, False, 0.0), Scale(0.01, True, 0.05)


def measured(skeleton: Skeleton, scale: Scale = GIVEN, seen: bool = True, foliage: object = None) -> Measures:
    places = None if foliage is None else np.asarray(foliage, dtype=np.float64)
    return measure_tree(skeleton, Stature(4.0, scale, seen, DISC), places, 12.0)


def test_a_trunk_is_measured_at_breast_height() -> None:
    diameter = measured(stick(9, height=4.0, radius=0.1, tip_radius=0.05)).figures["trunk_diameter"]
    assert diameter.value == pytest.approx(2 * (0.1 - 0.05 * 1.3 / 4.0))
    assert (diameter.unit, diameter.basis) == ("m", "measured")


def test_of_several_stems_the_thickest_counts() -> None:
    one, two = stick(5, radius=0.1, tip_radius=0.1), stick(5, radius=0.2, tip_radius=0.2)
    parents = np.concatenate([one.parents, np.where(two.parents < 0, -1, two.parents + len(one))])
    both = Skeleton(
        np.vstack([one.points, two.points + np.array([1, 0, 0])]), np.concatenate([one.radii, two.radii]), parents
    )
    assert measured(both).figures["trunk_diameter"].value == pytest.approx(0.4)


def test_a_low_tree_has_no_trunk_at_breast_height() -> None:
    diameter = measured(stick(height=1.2)).figures["trunk_diameter"]
    assert (diameter.value, diameter.low, diameter.high) == (None, None, None)


def test_a_hidden_trunk_is_less_sure_than_one_that_is_seen() -> None:
    seen, hidden = (measured(stick(), seen=shown).figures["trunk_diameter"] for shown in (True, False))
    assert (seen.basis, hidden.basis) == ("measured", "derived")
    assert hidden.high - hidden.low > seen.high - seen.low


def test_a_crown_is_as_wide_and_as_deep_as_its_leaves_but_for_the_outermost() -> None:
    rng = np.random.default_rng(0)
    leaves = rng.uniform([-2, 1, -1], [2, 3, 1], (20_000, 3))
    leaves[0] = (50, 2, -50)
    figures = measured(stick(), foliage=leaves).figures
    assert figures["crown_width"].value == pytest.approx(4 * 0.98, rel=0.02)
    assert figures["crown_depth"].value == pytest.approx(2 * 0.98, rel=0.02)


def test_the_volume_is_that_of_the_turned_crown() -> None:
    assert measured(stick()).figures["crown_volume"].value == pytest.approx(np.pi * 1.0**2 * 2.0)


def test_a_given_height_is_taken_as_it_is_and_a_known_length_bounds_it() -> None:
    given, known = (measured(stick(), scale).figures["height"] for scale in (GIVEN, KNOWN))
    assert (given.value, given.low, given.high, given.basis) == (4.0, 4.0, 4.0, "given")
    assert known.basis == "measured"
    assert known.low < 4.0 * 0.95
    assert known.high > 4.0 * 1.05


def test_an_unsure_scale_counts_as_often_as_metres_are_in_the_unit() -> None:
    sure, unsure = (measured(oak(), replace(KNOWN, error=error)).figures for error in (0.0, 0.1))
    for name, power in (("crown_width", 1), ("leaf_area", 2), ("crown_volume", 3)):
        assert unsure[name].high / sure[name].high == pytest.approx(1.1**power)


def test_every_range_holds_its_value() -> None:
    for figure in measured(oak(), KNOWN).figures.values():
        assert figure.low < figure.value < figure.high


def test_branches_are_counted_by_order() -> None:
    assert measured(stick()).branches_by_order == (1,)
    assert measured(fork()).branches_by_order == (1, 1)
    assert measured(oak(3)).branches_by_order[0] == 1


def test_a_drawn_side_makes_the_depth_as_sure_as_the_width_and_the_volume_that_of_ellipses() -> None:
    slim = TwoOutlines(CAMERA, DISC.middle_px, DISC.radius_px, (), np.zeros(500), 0.5 * DISC.radius_px)
    figures = measure_tree(oak(), Stature(4.0, GIVEN, True, slim), None, 12.0).figures
    width, depth = figures["crown_width"], figures["crown_depth"]
    assert (depth.basis, figures["crown_volume"].basis) == ("measured", "derived")
    assert depth.high / depth.value == pytest.approx(width.high / width.value)
    assert figures["crown_volume"].value == pytest.approx(np.pi * 1.0 * 0.5 * 2.0)
    assert "left side" in depth.meaning
    assert "ellipses" in figures["crown_volume"].meaning
