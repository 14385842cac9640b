"""A hasty trunk stroke on a real photo."""

from dataclasses import replace

import numpy as np
from tests.conftest import EXAMPLES

from treestroke.core.pipeline.photo import trace_photo
from treestroke.service.loading import load_photo, load_strokes

MAPLE = EXAMPLES / "sugar_maple_autumn"


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
