"""A hasty trunk stroke on a real photo."""

from dataclasses import replace

import numpy as np
from tests.conftest import EXAMPLES

from treestroke.core.pipeline.photo import trace_photo
from treestroke.service.loading import load_photo, load_strokes

MAPLE, OAK = EXAMPLES / "sugar_maple_autumn", EXAMPLES / "oak_02"


def test_a_trunk_stroke_beside_its_trunk_is_moved_onto_it_with_a_warning() -> None:
    photo, strokes = load_photo(MAPLE.with_suffix(".jpg")), load_strokes(MAPLE.with_suffix(".strokes.json"))
    trunk, *others = strokes.branches
    beside = replace(strokes, branches=(replace(trunk, points=trunk.points + np.array([20.0, 0.0])), *others))
    drawn, moved = trace_photo(photo, strokes), trace_photo(photo, beside)
    assert "trunk_moved" not in [warning.code for warning in drawn.warnings]
    (warning,) = [warning for warning in moved.warnings if warning.code == "trunk_moved"]
    assert "beside the trunk" in warning.detail
    assert drawn.skeleton is not None
    assert moved.skeleton is not None
    assert np.linalg.norm(moved.skeleton.points[0] - drawn.skeleton.points[0]) < 8


def test_a_trunk_stroke_far_beside_its_trunk_is_doubted_and_stays() -> None:
    photo, strokes = load_photo(MAPLE.with_suffix(".jpg")), load_strokes(MAPLE.with_suffix(".strokes.json"))
    trunk, *others = strokes.branches
    beside = replace(strokes, branches=(replace(trunk, points=trunk.points - np.array([56.0, 0.0])), *others))
    traced = trace_photo(photo, beside)
    (warning,) = [warning for warning in traced.warnings if warning.stroke == "branches/0"]
    assert warning.code == "trunk_unclear"
    assert "px to its right; draw it on the trunk" in warning.detail
    assert traced.skeleton is not None
    assert abs(traced.skeleton.points[0, 0] - (trunk.points[0, 0] - 56)) < 15


def test_a_trunk_stroke_where_no_trunk_is_is_doubted() -> None:
    photo, strokes = load_photo(OAK.with_suffix(".jpg")), load_strokes(OAK.with_suffix(".strokes.json"))
    trunk = strokes.branches[0]
    nowhere = replace(trunk, points=trunk.points + np.array([0.3 * np.ptp(strokes.crown.points[:, 0]), 0.0]))
    traced, drawn = (trace_photo(photo, replace(strokes, branches=(stroke,))) for stroke in (nowhere, trunk))
    details = [warning.detail for warning in traced.warnings if warning.code == "trunk_unclear"]
    assert details == ["no trunk is seen under it; draw it on the trunk, from where that stands"]
    assert "trunk_unclear" not in [warning.code for warning in drawn.warnings]


def test_a_trunk_stroke_from_the_grass_before_the_trunk_begins_at_its_foot() -> None:
    photo, strokes = load_photo(OAK.with_suffix(".jpg")), load_strokes(OAK.with_suffix(".strokes.json"))
    trunk, *others = strokes.branches
    height = np.ptp(np.vstack([strokes.crown.points, trunk.points])[:, 1])
    longer = np.vstack([trunk.points[0] + [0.0, 0.07 * height], trunk.points])
    grass = replace(strokes, branches=(replace(trunk, points=longer), *others))
    drawn, shortened = trace_photo(photo, strokes), trace_photo(photo, grass)
    assert "trunk_shortened" not in [warning.code for warning in drawn.warnings]
    (warning,) = [warning for warning in shortened.warnings if warning.code == "trunk_shortened"]
    assert "on the ground" in warning.detail
    assert drawn.skeleton is not None
    assert shortened.skeleton is not None
    assert np.linalg.norm(shortened.skeleton.points[0] - drawn.skeleton.points[0]) < 0.02 * height
