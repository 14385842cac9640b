from dataclasses import replace

import cv2
import numpy as np
import pytest
from tests.sketches import ARMS, TRUNK, apart, away, dense, inked, middle, sketch

from treestroke.core.errors import StrokesError
from treestroke.core.strokes import Sketch
from treestroke.core.trace.drawing import trace_sketch


@pytest.mark.parametrize("width", [1, 2, 3])
def test_a_pens_strokes_are_covered_and_give_no_radius(width: int) -> None:
    tree = trace_sketch(inked(sketch(TRUNK, *ARMS), width)).tree
    assert away(tree, dense([TRUNK, *ARMS])).max() < 2
    assert apart(tree, [TRUNK, *ARMS]).max() < 2.5
    assert not tree.skeleton.radii.any()
    assert sorted(tree.levels().tolist()) == [0, 1, 1, 2]


def test_a_brushs_width_gives_the_radius_within_a_tenth() -> None:
    widths = (40, 20, 12, 8)
    tree = trace_sketch(inked(sketch(TRUNK, *ARMS, widths=widths))).tree
    for line, width in zip((TRUNK, *ARMS), widths, strict=True):
        for share in (0.3, 0.5, 0.8):
            gaps = np.linalg.norm(tree.skeleton.points - middle(line, share), axis=1)
            assert gaps.min() < 8
            assert tree.skeleton.radii[gaps.argmin()] == pytest.approx(width / 2, rel=0.1)


def test_a_brushs_strokes_are_covered_to_their_ends() -> None:
    drawn = sketch(TRUNK, *ARMS, widths=(30, 16, 16, 12))
    tree = trace_sketch(inked(drawn)).tree
    gaps = away(tree, dense([TRUNK, *ARMS]))
    assert np.quantile(gaps, 0.95) < 2
    assert gaps.max() < 8
    assert len(tree.chains()) == 4


@pytest.mark.parametrize("rise", [-90, -40, -15, -5, 0, 5, 15, 40, 90])
@pytest.mark.parametrize("width", [8, 24])
def test_a_nearly_horizontal_brush_stroke_is_found(rise: float, width: int) -> None:
    arm = [[450, 600], [800, 600 - rise]]
    tree = trace_sketch(inked(sketch([[450, 1050], [450, 50]], arm, widths=(30, width)))).tree
    assert tree.levels().tolist() == [0, 1]
    own = tree.skeleton.points[tree.branch == 1]
    assert np.quantile(away(tree, dense([np.array(arm)])), 0.95) < 1.5
    assert own[-1] == pytest.approx([800 + width / 2, 600 - rise], abs=5)


@pytest.mark.parametrize("width", [2, 3, 4, 5, 7, 10])
def test_thinning_does_not_shorten_slanted_strokes(width: int) -> None:
    seen = np.zeros((1100, 900), dtype=np.uint8)
    lines = [
        np.array([[450, 1050], [450, 50]]),
        *(np.array([[450, 1000 - 60 * i], [850, 990 - 100 * i]]) for i in range(9)),
    ]
    for line in lines:
        cv2.line(seen, *line.tolist(), 1, width)
    tree = trace_sketch(Sketch((900, 1100), ink=seen > 0)).tree
    assert np.quantile(away(tree, 0.5 + dense(lines)), 0.98) < 2


def test_the_root_is_the_lowest_end() -> None:
    root = trace_sketch(inked(sketch(TRUNK[::-1], *ARMS, widths=(30,)))).tree.skeleton.points[0]
    assert root[0] == pytest.approx(TRUNK[0][0], abs=2)
    assert root[1] == pytest.approx(TRUNK[0][1] + 15, abs=2)


def test_a_blunt_trunk_base_makes_no_branches() -> None:
    seen = inked(sketch([[450, 900], [450, 50]], widths=(60,)))
    assert seen.ink is not None
    cv2.rectangle(foot := seen.ink.astype(np.uint8), (420, 800), (480, 1050), 1, cv2.FILLED)
    tree = trace_sketch(replace(seen, ink=foot > 0)).tree
    assert len(tree.chains()) == 1
    assert tree.skeleton.points[0] == pytest.approx([450.5, 1050], abs=2)


def test_a_small_gap_is_bridged_with_a_warning() -> None:
    arm = np.array([[463, 600], [800, 500]])
    drawing = trace_sketch(inked(sketch([[450, 1050], [450, 50]], arm)))
    assert [one.code for one in drawing.warnings] == ["branch_joined"]
    assert away(drawing.tree, dense([arm])).max() < 2
    assert drawing.tree.levels().tolist() == [0, 1]


def test_specks_are_dropped() -> None:
    seen = inked(sketch(TRUNK, *ARMS))
    assert seen.ink is not None
    ink = seen.ink.copy()
    ink[900:903, 100:103] = ink[50, 800] = True
    drawing = trace_sketch(replace(seen, ink=ink))
    assert len(drawing.tree.chains()) == 4
    assert drawing.warnings == ()


def test_a_loop_is_cut_open_with_a_warning() -> None:
    arc = [[450, 700], [250, 550], [250, 450], [450, 300]]
    drawing = trace_sketch(inked(sketch([[450, 1050], [450, 50]], arc)))
    assert [one.code for one in drawing.warnings] == ["loop_cut"]
    assert away(drawing.tree, dense([np.array(arc)])).max() < 2
    assert drawing.tree.levels().tolist() == [0, 1]
    assert drawing.tree.skeleton.points[drawing.tree.chains()[1]][0] == pytest.approx([450, 700], abs=3)


def test_branches_that_cross_stay_separate() -> None:
    arms = [[450, 800], [800, 450]], [[450, 500], [800, 750]]
    tree = trace_sketch(inked(sketch([[450, 1050], [450, 50]], *arms))).tree
    assert tree.levels().tolist() == [0, 1, 1]
    tips = [tree.skeleton.points[chain[-1]] for chain in tree.chains()[1:]]
    assert sorted(np.round(tip / 50).tolist() for tip in tips) == [[16, 9], [16, 15]]


@pytest.mark.parametrize("width", [1.0, 24.0])
def test_a_stroke_across_the_trunk_becomes_a_branch_on_each_side(width: float) -> None:
    bar = [[150, 600], [750, 560]]
    tree = trace_sketch(inked(sketch([[450, 1050], [450, 50]], bar, widths=(30, width)))).tree
    assert tree.levels().tolist() == [0, 1, 1]
    assert tree.skeleton.points[tree.branch == 0][-1] == pytest.approx([450, 35], abs=3)


def test_at_a_fork_the_branch_goes_on_straight() -> None:
    tree = trace_sketch(inked(sketch([[450, 1050], [450, 50]], [[450, 600], [650, 400]], widths=(20, 20)))).tree
    assert tree.skeleton.points[tree.branch == 0][:, 0] == pytest.approx(450, abs=5)


def test_a_ring_is_cut_and_followed() -> None:
    ring = np.zeros((400, 400), dtype=np.uint8)
    cv2.circle(ring, (200, 200), 150, 1, 2)
    tree = trace_sketch(Sketch((400, 400), ink=ring > 0)).tree
    angle = np.linspace(0, 2 * np.pi, 500)
    assert away(tree, 200.5 + 150 * np.stack([np.cos(angle), np.sin(angle)], axis=1)).max() < 2


def test_a_big_picture_gives_the_tree_in_its_own_pixels() -> None:
    drawn = sketch(*(4 * np.array(line, dtype=float) for line in (TRUNK, *ARMS)), size=(3600, 4400))
    tree = trace_sketch(inked(drawn, 4)).tree
    assert sorted(tree.levels().tolist()) == [0, 1, 1, 2]
    assert away(tree, dense([one.points for one in drawn.branches])).max() < 8


@pytest.mark.parametrize(
    ("ink", "code"),
    [
        (np.zeros((100, 100), dtype=bool), "sketch_empty"),
        (np.ones((100, 100), dtype=bool), "sketch_filled"),
        (np.eye(100, dtype=bool), None),
        (np.arange(10_000).reshape(100, 100) == 5050, "sketch_empty"),
        ((np.indices((300, 300)) % 12 == 0).any(axis=0), "too_many_strokes"),
        ((np.indices((300, 300)) % 12 == 0).all(axis=0), "too_many_strokes"),
        (np.random.default_rng(0).random((300, 300)) < 0.5, "too_many_strokes"),
    ],
)
def test_ink_that_does_not_consist_of_strokes_is_refused(ink: np.ndarray, code: str | None) -> None:
    try:
        drawing = trace_sketch(Sketch((ink.shape[1], ink.shape[0]), ink=ink))
    except StrokesError as error:
        assert error.code == code
    else:
        assert code is None
        assert len(drawing.tree.chains()) == 1


def test_any_scribble_gives_one_tree_or_is_refused() -> None:
    rng = np.random.default_rng(1)
    for _ in range(15):
        seen = np.zeros((300, 260), dtype=np.uint8)
        for _ in range(int(rng.integers(1, 9))):
            line = rng.integers(0, (260, 300), (int(rng.integers(2, 6)), 2))
            cv2.polylines(seen, [line.astype(np.int32)], False, 1, int(rng.integers(1, 14)))
        try:
            tree = trace_sketch(Sketch((260, 300), ink=seen > 0)).tree
        except StrokesError as error:
            assert error.code in ("tree_flat", "sketch_filled")
        else:
            assert (tree.skeleton.parents[1:] >= 0).all()


def test_the_same_picture_gives_the_same_tree_wherever_its_arrays_lie_in_memory() -> None:
    seen = inked(sketch(TRUNK, *ARMS, widths=(30,)), 5)
    trees, held = [], []
    for count in range(6):
        held.append(np.empty(100_000 + 4 * count, dtype=np.float32))
        trees.append(trace_sketch(seen).tree.skeleton)
    assert len({tree.points.tobytes() for tree in trees}) == 1
    assert len({tree.radii.tobytes() for tree in trees}) == 1
