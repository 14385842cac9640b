from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.conftest import DATA

from treestroke.core.errors import StrokesError
from treestroke.core.stroke_rules import mend_strokes, require_trunk
from treestroke.core.strokes import Length, MendedStrokes, Stroke, Strokes
from treestroke.service.loading import load_photo, load_strokes

WIDTH, HEIGHT = 400, 300
CROWN = [[100, 40], [300, 40], [300, 160], [100, 160]]
TRUNK = [[200, 290], [200, 150]]


def mend(crown: object = CROWN, branches: object = (TRUNK,), erase: object = ()) -> MendedStrokes:
    strokes = Strokes(
        Stroke(np.array(crown, float)), *(tuple(Stroke(np.array(p, float)) for p in s) for s in (branches, erase))
    )
    return mend_strokes(strokes, WIDTH, HEIGHT)


def test_good_strokes_stay_as_they_are() -> None:
    mended = mend(branches=(TRUNK, [[203, 200], [280, 120]]), erase=([[1, 2], [3, 4]],))
    assert mended.warnings == ()
    assert mended.strokes.branches[1].points.tolist() == [[203, 200], [280, 120]]


def test_points_outside_are_clamped_to_the_photo() -> None:
    mended = mend(crown=[[-50, -50], [450, -50], [450, 160], [-50, 160]])
    assert mended.strokes.crown.points.tolist() == [[0, 0], [400, 0], [400, 160], [0, 160]]


def test_a_trunk_begun_below_the_photo_has_no_level_run_along_its_edge() -> None:
    mended = mend(branches=([[150, 340], [165, 325], [190, 310], [200, 290], [200, 150]],))
    assert mended.strokes.branches[0].points.tolist() == [[190, 300], [200, 290], [200, 150]]


@pytest.mark.parametrize(
    ("strokes", "message", "code"),
    [
        ({"crown": [[10, 10], [90, 90], [10, 10]]}, "^crown: it has 2 distinct points", "stroke_too_short"),
        ({"crown": [[10, 10], [20, 10], [20, 20], [10, 20]]}, r"^crown: it encloses 0\.0", "crown_too_small"),
        ({"crown": [[10, 10], [50, 50], [90, 90]]}, r"^crown: it encloses 0\.00%", "crown_too_small"),
        ({"branches": ([[200, 290], [200, 290]],)}, "^branches/0: it has 1 distinct point ", "stroke_too_short"),
        ({"branches": (TRUNK, [[500, 50], [600, 50]])}, "^branches/1: it has 1 distinct point ", "stroke_too_short"),
        ({"erase": ([[5, 5], [5, 5]],)}, "^erase/0: it has 1 distinct point ", "stroke_too_short"),
        ({"branches": ([[200, 290], [np.nan, 150]],)}, "^branches/0: a coordinate is not", "non_finite_number"),
        ({"branches": ([[200, 290], [200, np.inf]],)}, "^branches/0: a coordinate is not", "non_finite_number"),
        ({"branches": ([[20, 290], [20, 180]],)}, "^branches/0: the trunk neither touches", "trunk_outside_crown"),
        ({"branches": ([[200, 200], [200, 290]],)}, "^branches/0: the trunk neither touches", "trunk_outside_crown"),
        ({"branches": (TRUNK,) * 200}, "^strokes: there are 201", "too_many_strokes"),
        ({"branches": ([[200, 290], *([[200, 150]] * 10_000)],)}, "^branches/0: it has 10001", "too_many_points"),
    ],
)
def test_unusable_strokes_are_refused_by_name(strokes: dict[str, object], message: str, code: str) -> None:
    with pytest.raises(StrokesError, match=message) as refused:
        mend(**strokes)
    place = str(refused.value).partition(":")[0]
    assert (refused.value.code, refused.value.pointer) == (code, "" if place == "strokes" else f"/{place}")


def test_a_width_that_is_not_positive_is_refused() -> None:
    strokes = Strokes(Stroke(np.array(CROWN, float)), (Stroke(np.array(TRUNK, float), width=0.0),))
    with pytest.raises(StrokesError, match="^branches/0: width") as refused:
        mend_strokes(strokes, WIDTH, HEIGHT)
    assert (refused.value.code, refused.value.pointer) == ("width_invalid", "/branches/0/width")


def with_length(points: object, metres: float) -> MendedStrokes:
    strokes = Strokes(Stroke(np.array(CROWN, float)), (Stroke(np.array(TRUNK, float)),))
    return mend_strokes(replace(strokes, scale=Length(np.array(points, float), metres)), WIDTH, HEIGHT)


def test_a_known_length_is_clamped_to_the_photo() -> None:
    scale = with_length([[50, 200], [50, 900]], 2.0).strokes.scale
    assert scale is not None
    assert scale.points.tolist() == [[50, 200], [50, 300]]


@pytest.mark.parametrize(
    ("points", "metres", "message", "code"),
    [
        ([[50, 200]], 2.0, "^scale: it has 1 points", "scale_invalid"),
        ([[50, 200], [60, 210], [70, 220]], 2.0, "^scale: it has 3 points", "scale_invalid"),
        ([[50, 200], [50, 200]], 2.0, "^scale: it has 1 distinct point", "stroke_too_short"),
        ([[50, 200], [np.nan, 250]], 2.0, "^scale: a coordinate", "non_finite_number"),
        ([[50, 200], [50, 250]], 0.0, "^scale: 0.0 metres is not a length", "scale_invalid"),
        ([[50, 200], [50, 250]], np.nan, "^scale: nan metres is not a length", "scale_invalid"),
        ([[50, 200], [50, 250]], 100.0, "^scale: by it the tree is 500 m high", "scale_unlikely"),
        ([[50, 50], [50, 299]], 0.01, "^scale: by it the tree is 0.01 m high", "scale_unlikely"),
    ],
)
def test_a_length_that_makes_no_tree_is_refused(points: object, metres: float, message: str, code: str) -> None:
    with pytest.raises(StrokesError, match=message) as refused:
        with_length(points, metres)
    assert refused.value.code == code
    assert refused.value.pointer.startswith("/scale")


def test_a_trunk_that_points_into_the_crown_from_afar_is_taken() -> None:
    assert mend(branches=([[200, 290], [201, 260]],)).warnings == ()


def test_a_trunk_may_pass_the_crown_by_a_loose_hand() -> None:
    assert mend(branches=([[304, 290], [304, 30]],)).warnings == ()


def test_a_branch_that_hangs_in_the_air_is_joined_to_the_nearest() -> None:
    mended = mend(branches=(TRUNK, [[230, 180], [280, 120]]))
    assert mended.strokes.branches[1].points.tolist() == [[200, 180], [230, 180], [280, 120]]
    assert [(w.code, w.stroke) for w in mended.warnings] == [("branch_joined", "branches/1")]


def test_a_branch_may_be_joined_to_another_branch() -> None:
    mended = mend(branches=(TRUNK, [[200, 180], [280, 120]], [[280, 140], [290, 100]]))
    assert "branches/1" in mended.warnings[0].detail


def test_a_second_stem_beside_the_root_is_not_joined() -> None:
    small = np.array([[190, 140], [210, 140], [210, 160], [190, 160]]) * 1.0
    mended = mend(crown=np.vstack([small, [[100, 10], [300, 10]]]), branches=(TRUNK, [[208.2, 290], [240, 150]]))
    assert mended.warnings == ()
    assert len(mended.strokes.branches[1].points) == 2


@pytest.mark.parametrize(
    ("start", "points"), [(286, [[204, 290], [204, 286]]), (290, [[204, 290]]), (292, [[204, 292]])]
)
def test_a_second_stem_stands_on_the_ground(start: int, points: list[list[float]]) -> None:
    mended = mend(branches=(TRUNK, [[204, start], [240, 150]]))
    assert mended.warnings == ()
    assert mended.strokes.branches[1].points.tolist() == [*points, [240, 150]]


def test_a_stroke_from_the_ground_that_touches_no_other_is_a_stem_of_its_own() -> None:
    mended = mend(branches=(TRUNK, [[240, 288], [250, 150]], [[270, 291], [270, 140]]))
    assert mended.warnings == ()
    assert [stroke.points.tolist() for stroke in mended.strokes.branches[1:]] == [
        [[240, 290], [240, 288], [250, 150]],
        [[270, 291], [270, 140]],
    ]


def test_a_stroke_that_starts_well_above_the_ground_is_joined() -> None:
    mended = mend(branches=(TRUNK, [[240, 260], [280, 150]]))
    assert [warning.code for warning in mended.warnings] == ["branch_joined"]


@pytest.mark.parametrize(
    "trunk",
    [[[110, 100], [290, 95]], [[200, 60], [205, 130]], [[120, 140], [160, 130], [280, 150]]],
    ids=["level", "downward", "nearly level"],
)
def test_a_trunk_that_does_not_rise_is_refused_with_advice(trunk: list[list[float]]) -> None:
    with pytest.raises(StrokesError, match="from the ground up; .* turn the photo first") as refused:
        mend(branches=(trunk,))
    assert (refused.value.code, refused.value.pointer) == ("trunk_level", "/branches/0")


@pytest.mark.parametrize(
    "trunk", [[[200, 150], [200, 290]], [[200, 60], [205, 150]], [[190, 30], [180, 120], [220, 290]]]
)
def test_a_trunk_drawn_from_its_top_down_is_turned(trunk: list[list[float]]) -> None:
    mended = mend(branches=(trunk, [[203, 100], [280, 120]]))
    assert mended.strokes.branches[0].points.tolist() == trunk[::-1]
    assert ("stroke_turned", "branches/0") in [(one.code, one.stroke) for one in mended.warnings]


def test_a_trunk_that_stands_on_its_head_is_refused_and_not_turned() -> None:
    crown = [[100, 140], [300, 140], [300, 260], [100, 260]]
    with pytest.raises(StrokesError, match="turn the photo") as refused:
        mend(crown=crown, branches=([[200, 10], [200, 180]],))
    assert refused.value.code == "trunk_level"


@pytest.mark.parametrize(
    "trunk",
    [
        [[120, 290], [280, 150]],
        [[110, 270], [290, 120]],
        [[60, 290], [200, 130], [320, 290]],
        [[200, 290], [120, 270], [260, 200], [150, 140]],
        [[140, 180], [150, 120], [200, 110], [290, 290]],
    ],
    ids=["leaning", "40 degrees from level", "arched", "winding", "cascade"],
)
def test_a_trunk_may_lean_arch_and_wind(trunk: list[list[float]]) -> None:
    assert mend(branches=(trunk,)).warnings == ()


def test_strokes_of_the_photo_before_it_was_turned_are_warned_of() -> None:
    strokes = Strokes(
        Stroke(np.array([[40, 100], [200, 100], [200, 300], [40, 300]], float)),
        (Stroke(np.array([[130, 395], [150, 120]], float)),),
    )
    warnings = mend_strokes(strokes, 400, 220).warnings
    assert [(one.code, one.stroke) for one in warnings] == [("outside_photo", "crown"), ("outside_photo", "branches/0")]
    assert all("before it was turned upright" in one.detail for one in warnings)


@pytest.mark.parametrize("strokes", sorted(DATA.glob("*.strokes.json")), ids=lambda path: path.name)
def test_strokes_of_real_trees_are_doubted_or_refused_only_where_the_photo_was_turned(strokes: Path) -> None:
    height, width = load_photo(DATA / f"{strokes.name.split('.')[0]}.jpg").shape[:2]
    given = load_strokes(strokes)

    def doubted(turn: Callable[[np.ndarray], np.ndarray]) -> bool:
        crown, *branches = (Stroke(turn(one.points)) for one in (given.crown, *given.branches))
        try:
            mended = mend_strokes(Strokes(crown, tuple(branches)), width, height)
        except StrokesError as refused:
            return refused.code == "trunk_level"
        return "outside_photo" in {one.code for one in mended.warnings}

    assert not doubted(lambda points: points)
    assert doubted(lambda points: np.column_stack([points[:, 1], width - points[:, 0]]))
    assert doubted(lambda points: np.column_stack([height - points[:, 1], points[:, 0]]))
    assert doubted(lambda points: (width, height) - points)


def test_a_stroke_from_far_beyond_is_told_at_once() -> None:
    far = [[-1e308, 40], *([[1e308, 40], [-1e308, 50]] * 4_000), [1e308, 160], [200, 160]]
    assert {one.code for one in mend(crown=far).warnings} >= {"outside_photo"}


def test_a_crown_that_is_cut_by_the_photo_s_edge_is_not_warned_of() -> None:
    assert mend(crown=[[100, -15], [300, -15], [300, 160], [100, 160]]).warnings == ()


def test_a_crown_that_crosses_itself_is_kept_with_a_warning() -> None:
    eight = [[100, 40], [300, 160], [300, 40], [100, 160]]
    mended = mend(crown=eight, branches=([[150, 290], [150, 150]],))
    assert mended.strokes.crown.points.tolist() == eight
    assert [(w.code, w.stroke) for w in mended.warnings] == [("crown_crosses_itself", "crown")]


def test_a_model_needs_a_trunk_but_a_trace_does_not() -> None:
    mended = mend(branches=())
    assert mended.strokes.branches == ()
    with pytest.raises(StrokesError, match="branches") as refused:
        require_trunk(mended.strokes)
    assert (refused.value.code, refused.value.pointer) == ("trunk_missing", "/branches")
