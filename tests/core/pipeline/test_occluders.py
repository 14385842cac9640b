from dataclasses import replace

import cv2
import numpy as np
import pytest
from tests.conftest import DATA, EXAMPLES

from treestroke.core.pipeline.evidence import read_photo
from treestroke.core.pipeline.growing import grow_tree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.strokes import Stroke, Strokes
from treestroke.service.loading import load_photo, load_strokes


def maple_behind_a_pole() -> tuple[np.ndarray, np.ndarray, Strokes]:
    """Return the photo of a tree, the same with a pole before its crown, and the strokes."""
    photo = load_photo(EXAMPLES / "sugar_maple_autumn.jpg")
    crossed = cv2.line(photo.copy(), (190, -5), (190, 590), (215, 215, 210), 10, cv2.LINE_AA)
    return photo, crossed, load_strokes(EXAMPLES / "sugar_maple_autumn.strokes.json")


def test_a_pole_is_no_hole_in_the_crown_and_a_warning_tells_of_it() -> None:
    photo, crossed, strokes = maple_behind_a_pole()
    whole, seen = read_photo(photo, strokes), read_photo(crossed, strokes)
    pole = (slice(150, 450), slice(184, 197))
    assert whole.foliage.covered[pole].mean() > 0.9
    assert seen.foliage.covered[pole].mean() > 0.85
    assert not np.array_equal(seen.working.photo, crossed)
    assert [one.code for one in seen.warnings] == ["pole_removed"]
    assert [one.code for one in whole.warnings] == []


def test_what_is_known_of_lines_is_kept_until_a_stroke_follows_one() -> None:
    _, crossed, strokes = maple_behind_a_pole()
    first = read_photo(crossed, strokes)
    limb = Stroke(np.array([[330.0, 420.0], [400.0, 300.0]]))
    more = read_photo(crossed, replace(strokes, branches=(*strokes.branches, limb)), first)
    assert more.working.poles is first.working.poles
    assert more.foliage is first.foliage
    along = Stroke(np.array([[190.0, 580.0], [190.0, 200.0]]))
    other = read_photo(crossed, replace(strokes, branches=(*strokes.branches, along)), first)
    assert other.working.poles == ()
    assert np.array_equal(other.working.photo, crossed)


def test_nothing_is_looked_for_before_the_trunk_is_drawn() -> None:
    _, crossed, strokes = maple_behind_a_pole()
    only_crown = read_photo(crossed, replace(strokes, branches=()))
    assert only_crown.working.poles == ()
    assert len(read_photo(crossed, strokes, only_crown).working.poles) == 1


def oak_behind_a_hedge(through: bool) -> tuple[np.ndarray, Strokes, float]:
    """Return a photo with a hedge before a tree's foot, strokes to the hedge or through it, and the foot's row."""
    photo, strokes = load_photo(EXAMPLES / "oak_02.jpg").copy(), load_strokes(EXAMPLES / "oak_02.strokes.json")
    trunk = strokes.branches[0].points
    foot = float(trunk[0, 1])
    top = int(foot - 0.11 * (foot - strokes.crown.points[:, 1].min()))
    noise = np.random.default_rng(0).normal(0, 14, (int(foot) + 12 - top, photo.shape[1], 1))
    photo[top : int(foot) + 12] = np.clip(np.array([45, 75, 38]) + noise, 0, 255)
    if not through:
        rows = np.linspace(top - 3, trunk[-1, 1], 30)
        columns = np.interp(-rows, -trunk[:, 1], trunk[:, 0])
        strokes = replace(strokes, branches=(Stroke(np.column_stack([columns, rows])), *strokes.branches[1:]))
    return photo, strokes, foot


@pytest.mark.parametrize("through", [True, False])
def test_a_trunk_behind_a_hedge_goes_on_to_the_ground_as_wide_as_above(through: bool) -> None:
    photo, strokes, foot = oak_behind_a_hedge(through)
    seen = read_photo(photo, strokes)
    whole = read_photo(load_photo(EXAMPLES / "oak_02.jpg"), load_strokes(EXAMPLES / "oak_02.strokes.json"))
    assert seen.traced is not None
    assert whole.traced is not None
    root = seen.traced.skeleton.points[0]
    assert root[1] == pytest.approx(foot, abs=0.02 * whole.height_px)
    assert seen.working.strokes.branches[0].points[0, 1] == pytest.approx(root[1])
    assert seen.traced.skeleton.radii[0] == pytest.approx(whole.traced.skeleton.radii[0], rel=0.25)
    assert ("trunk_completed" in [one.code for one in seen.warnings]) == (not through)
    reading = grow_tree(seen, ModelSettings(iterations=0), np.random.default_rng(0)).reading
    assert reading.completed == (() if through else ("foot",))


def test_a_trunk_stroke_that_begins_above_the_foot_goes_on_down_the_visible_trunk() -> None:
    photo, strokes = load_photo(EXAMPLES / "oak_02.jpg"), load_strokes(EXAMPLES / "oak_02.strokes.json")
    whole = read_photo(photo, strokes)
    trunk = strokes.branches[0].points
    rows = np.linspace(trunk[0, 1] - 0.08 * whole.height_px, trunk[-1, 1], 30)
    short = Stroke(np.column_stack([np.interp(-rows, -trunk[:, 1], trunk[:, 0]), rows]))
    seen = read_photo(photo, replace(strokes, branches=(short, *strokes.branches[1:])), whole)
    assert seen.traced is not None
    assert seen.traced.skeleton.points[0] == pytest.approx(trunk[0], abs=0.02 * whole.height_px)
    assert "trunk_lengthened" in [one.code for one in seen.warnings]
    assert "trunk_lengthened" not in [one.code for one in whole.warnings]


def test_a_trunk_stroke_from_the_foot_is_not_led_on_into_dark_mulch() -> None:
    photo, strokes = load_photo(DATA / "boxelder_lawn.jpg"), load_strokes(DATA / "boxelder_lawn.strokes.json")
    seen = read_photo(photo, strokes)
    assert seen.warnings == ()
    assert np.array_equal(seen.working.strokes.branches[0].points, strokes.branches[0].points)
