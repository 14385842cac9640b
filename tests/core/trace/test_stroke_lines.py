import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.sketches import ARMS, SIZE, TRUNK, apart, away, dense, height, inked, sketch

from treestroke.core.errors import StrokesError
from treestroke.core.strokes import Sketch
from treestroke.core.trace.branch_lines import STEP
from treestroke.core.trace.drawing import trace_sketch

places = st.tuples(st.integers(0, 900), st.integers(0, 1100))


@settings(deadline=None, max_examples=15)
@given(st.lists(st.lists(places, min_size=2, max_size=6, unique=True), max_size=6))
def test_every_stroke_lies_along_one_tree(arms: list[list[tuple[float, float]]]) -> None:
    drawing = trace_sketch(sketch(TRUNK, *arms))
    gaps = away(drawing.tree, dense([np.array(line) for line in (TRUNK, *arms)]))
    # A stroke may begin a little beyond its parent; that is cut off.
    assert np.quantile(gaps, 0.98) < 2 or gaps.max() < 6.5
    assert (drawing.tree.skeleton.parents[1:] >= 0).all()


def test_a_simple_tree_is_covered_within_a_pixel_by_nothing_else() -> None:
    drawing = trace_sketch(sketch(TRUNK, *ARMS))
    assert away(drawing.tree, dense([TRUNK, *ARMS])).max() < 1
    assert apart(drawing.tree, [TRUNK, *ARMS]).max() < 1
    assert sorted(drawing.tree.levels().tolist()) == [0, 1, 1, 2]
    assert drawing.warnings == ()


def test_joints_are_no_further_apart_than_a_step() -> None:
    drawing = trace_sketch(sketch(TRUNK, *ARMS))
    skeleton = drawing.tree.skeleton
    edges = np.linalg.norm(skeleton.points[1:] - skeleton.points[skeleton.parents[1:]], axis=1)
    assert 0 < edges.min() <= edges.max() <= STEP * height(drawing) * (1 + 1e-9)


def test_a_trunk_drawn_downward_is_turned() -> None:
    turned = trace_sketch(sketch(TRUNK[::-1], *ARMS))
    assert [(one.code, one.stroke) for one in turned.warnings] == [("stroke_turned", "branches/0")]
    assert turned.tree.skeleton.points[0].tolist() == TRUNK[0]


def test_a_branch_drawn_inward_is_turned_without_a_warning() -> None:
    drawing = trace_sketch(sketch(TRUNK, *(arm[::-1] for arm in ARMS)))
    assert drawing.warnings == ()
    tips = [drawing.tree.skeleton.points[chain[-1]].tolist() for chain in drawing.tree.chains()]
    assert sorted(tips) == sorted([TRUNK[-1], *(arm[-1] for arm in ARMS)])


def test_the_order_of_branches_does_not_matter() -> None:
    first, other = trace_sketch(sketch(TRUNK, *ARMS)), trace_sketch(sketch(TRUNK, *ARMS[::-1]))
    assert sorted(first.tree.levels()) == sorted(other.tree.levels())


def test_a_bud_lies_on_the_parent_s_line_where_the_branch_begins() -> None:
    drawing = trace_sketch(sketch([[450, 1050], [450, 50]], [[453, 613.7], [700, 500]]))
    bud = drawing.tree.skeleton.points[drawing.tree.chains()[1][0]]
    assert np.allclose(bud, [450, 613.7])


def test_a_branch_that_runs_along_its_parent_leaves_it_where_they_part() -> None:
    drawing = trace_sketch(sketch([[450, 1050], [450, 50]], [[450.5, 800], [450.5, 600], [700, 500]]))
    bud = drawing.tree.skeleton.points[drawing.tree.chains()[1][0]]
    assert bud[1] == pytest.approx(600, abs=3)


def test_a_branch_that_begins_beyond_its_parent_goes_out_where_it_crosses_it() -> None:
    drawing = trace_sketch(sketch([[450, 1050], [450, 50]], [[445.5, 602], [700, 500]]))
    chain = drawing.tree.skeleton.points[drawing.tree.chains()[1]]
    assert chain[0] == pytest.approx([450, 600], abs=1.5)
    assert (np.diff(chain[:, 0]) > 0).all()


def test_a_stroke_across_the_trunk_becomes_a_branch_on_each_side() -> None:
    drawing = trace_sketch(sketch([[450, 1050], [450, 50]], [[200, 600], [700, 610]]))
    assert drawing.warnings == ()
    assert drawing.tree.levels().tolist() == [0, 1, 1]
    assert away(drawing.tree, dense([np.array([[200, 600], [700, 610]])])).max() < 1


def test_a_stroke_drawn_twice_is_one_branch() -> None:
    assert len(trace_sketch(sketch(TRUNK, ARMS[0], ARMS[0])).tree.chains()) == 2


def test_a_branch_drawn_from_the_trunk_along_another_goes_out_from_that() -> None:
    arm = [*ARMS[0][:2], [100, 300]]
    drawing = trace_sketch(sketch(TRUNK, ARMS[0], arm))
    assert sorted(drawing.tree.levels().tolist()) == [0, 1, 2]
    assert away(drawing.tree, dense([ARMS[0], arm])).max() < 2


def test_a_loose_branch_is_joined_with_a_warning() -> None:
    drawing = trace_sketch(sketch(TRUNK, *ARMS, [[600, 800], [800, 700]]))
    assert [(one.code, one.stroke) for one in drawing.warnings] == [("branch_joined", "branches/4")]
    assert "154 px" in drawing.warnings[0].detail


def test_a_width_is_the_radius_of_its_own_branch() -> None:
    tree = trace_sketch(sketch(TRUNK, *ARMS, widths=(40,))).tree
    assert set(tree.skeleton.radii[tree.branch == 0]) == {20.0}
    assert not tree.skeleton.radii[tree.branch > 0].any()


def test_points_are_clamped_to_the_canvas() -> None:
    points = trace_sketch(sketch([[450, 2000], [450, -300]])).tree.skeleton.points
    assert points[[0, -1]].tolist() == [[450, 1100], [450, 0]]


@pytest.mark.parametrize(
    ("drawn", "message", "code"),
    [
        (sketch(), "^branches: there is no trunk stroke; draw one", "trunk_missing"),
        (sketch(TRUNK, [[5, 5], [5, 5]]), "^branches/1: it has 1 distinct point inside the canvas", "stroke_too_short"),
        (sketch([[450, 1050], [np.nan, 4]]), "^branches/0: a coordinate is not a finite", "non_finite_number"),
        (sketch(TRUNK, widths=(0,)), "^branches/0: width is 0", "width_invalid"),
        (sketch([[50, 500], [850, 499]]), "^branches: the strokes do not rise", "tree_flat"),
        (sketch(*[TRUNK] * 200), "^strokes: there are 201", "too_many_strokes"),
        (sketch(TRUNK, [[0, 500], [900, 500]] * 100), "^branches: all together they are 1", "strokes_too_long"),
        (sketch(TRUNK, [[5, 5]] * 10_001), "^branches/1: it has 10001 points", "too_many_points"),
    ],
)
def test_unusable_strokes_are_refused_by_name(drawn: Sketch, message: str, code: str) -> None:
    with pytest.raises(StrokesError, match=message) as refused:
        trace_sketch(drawn)
    assert refused.value.code == code


def test_lines_and_their_picture_give_the_same_tree() -> None:
    drawn = sketch(TRUNK, *ARMS)
    lines, ink = trace_sketch(drawn), trace_sketch(inked(drawn))
    assert len(lines.tree.chains()) == len(ink.tree.chains())
    assert sorted(lines.tree.levels().tolist()) == sorted(ink.tree.levels().tolist())
    assert away(ink.tree, lines.tree.skeleton.points).max() < 2
    assert away(lines.tree, ink.tree.skeleton.points).max() < 2
    assert lines.size == ink.size == SIZE
