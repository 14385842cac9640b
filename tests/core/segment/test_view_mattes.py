"""A tree photographed from all around is found in every shot by the strokes in one."""

from dataclasses import replace

import numpy as np
import pytest
from tests.core.segment.walked_tree import NO_POINTS, cover, strokes_on, walk

from treestroke.core.capture import Shot, TreeMatte
from treestroke.core.segment.view_mattes import view_mattes
from treestroke.core.strokes import Stroke
from treestroke.core.types import Mask

Walk = tuple[tuple[Shot, ...], list[Mask], tuple[TreeMatte, ...]]


def overlap(one: Mask, other: Mask) -> float:
    return float((one & other).sum() / (one | other).sum())


@pytest.fixture(scope="module")
def walked() -> Walk:
    shots, trees = walk(6)
    return shots, trees, view_mattes(shots, {0: strokes_on(shots[0])}, NO_POINTS)


def test_one_stroked_shot_gives_the_tree_in_all(walked: Walk) -> None:
    _, trees, mattes = walked
    assert min(overlap(matte.tree, tree) for matte, tree in zip(mattes, trees, strict=True)) > 0.85


def test_bushes_of_the_same_colours_far_behind_are_left_out(walked: Walk) -> None:
    _, trees, mattes = walked
    wrong = [(matte.tree & ~tree).sum() / tree.sum() for matte, tree in zip(mattes, trees, strict=True)]
    assert max(wrong) < 0.12


def test_the_trunk_is_found_in_all_and_told_from_the_leaves(walked: Walk) -> None:
    shots, _, mattes = walked
    for shot, matte in zip(shots, mattes, strict=True):
        leaves, wood = cover(shot.camera)
        assert matte.tree[wood].mean() > 0.85
        assert matte.wood[wood & matte.tree].mean() > 0.8 > 0.2 > matte.wood[leaves & matte.tree].mean()


def test_an_erasing_stroke_is_obeyed_where_it_is_drawn() -> None:
    shots = walk(6)[0][:3]
    line = shots[2].camera.pixels_from_world(np.array([[0.0, 3.6, 0.0]])).repeat(2, axis=0)
    line[:, 0] += (-10.0, 10.0)
    drawn = {0: strokes_on(shots[0]), 2: strokes_on(shots[2], (Stroke(line, 8.0),))}
    matte = view_mattes(shots, drawn, NO_POINTS)[2]
    x, y = line.mean(axis=0).astype(int).tolist()
    assert not matte.tree[y - 3 : y + 3, x - 5 : x + 5].any()
    assert matte.tree.sum() > 500


def test_it_needs_strokes_on_a_shot_that_is_there(walked: Walk) -> None:
    shots, _, _ = walked
    with pytest.raises(ValueError, match="strokes need one of 6 shots"):
        view_mattes(shots, {8: strokes_on(shots[0])}, NO_POINTS)


def test_a_crate_before_the_trunk_hides_it(walked: Walk) -> None:
    shots, _, mattes = walked
    assert not any(matte.hidden.any() for matte in mattes)
    before = list(shots)
    x, y = before[2].camera.pixels_from_world(np.array([[0.0, 0.8, 0.0]]))[0].astype(int).tolist()
    picture = before[2].picture.copy()
    picture[y - 10 : y + 10, x - 14 : x + 14] = (180, 40, 160)
    before[2] = replace(before[2], picture=picture)
    matte = view_mattes(before[:4], {0: strokes_on(shots[0])}, NO_POINTS)[2]
    assert matte.hidden[y - 5 : y + 5, x].all()
    assert not matte.tree[y - 5 : y + 5, x].any()
