"""Edits of visible branches: what is true of every edit of every tree, and what each does to a small one."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.strategies import skeletons

from treestroke.core.geometry.similarity import Similarity
from treestroke.core.skeleton.branch_edits import (
    OF_PARENT,
    Add,
    BranchEdit,
    EditedBranches,
    Join,
    Move,
    Remove,
    SetRadius,
    edited,
    edits_in_frame,
)
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton

EXTENT = 100.0
"""Height of the drawn trees."""
ROOT, FORK, LEFT, LEFT_TIP, RIGHT, RIGHT_TIP = range(6)
SMALL = Skeleton(
    np.array([[0, 0, 0], [0, 1, 0], [-0.5, 1.5, 0], [-1, 2, 0], [0.5, 1.5, 0], [1, 2, 0]], dtype=np.float64),
    np.array([0.2, 0.1, 0.05, 0.02, 0.08, 0.04]),
    np.array([-1, 0, 1, 2, 1, 4]),
)
"""A trunk that forks; all of it is seen but the first joint of the right branch."""
SEEN = np.array([True, True, True, True, False, True])


def apply(*edits: BranchEdit) -> EditedBranches:
    return edited(SMALL, SEEN, edits, 2.0)


def at(joint: int) -> np.ndarray:
    return SMALL.points[joint]


@st.composite
def edits_of(draw: st.DrawFn, tree: Skeleton) -> BranchEdit:
    """Draw an edit that names joints of a tree, or places near them."""
    rng = np.random.default_rng(draw(st.integers(0, 999)))
    one, other = (tree.points[rng.integers(len(tree))] + rng.normal(0, 2, 3) for _ in range(2))
    radius = float(rng.uniform(0.1, 3))
    points = rng.uniform(-60, 60, (draw(st.integers(1, 3)), 3))
    kinds: Sequence[BranchEdit] = (
        Remove(one),
        Add(one, points, draw(st.sampled_from([None, radius]))),
        Move(one, other),
        SetRadius(one, radius),
        Join(one, other),
    )
    return draw(st.sampled_from(kinds))


@st.composite
def edited_trees(draw: st.DrawFn, most: int = 5) -> tuple[Skeleton, np.ndarray, list[BranchEdit]]:
    """Draw a tree of one root whose radii fall outward, which joints are seen, and edits."""
    drawn = draw(skeletons(stems=False))
    radii = drawn.radii + 0.1
    for joint, parent in enumerate(drawn.parents.tolist()):
        radii[joint] = min(radii[joint], radii[max(parent, 0)])
    tree = Skeleton(drawn.points, radii, drawn.parents)
    seen = np.random.default_rng(draw(st.integers(0, 999))).random(len(tree)) < 0.7
    return tree, seen, draw(st.lists(edits_of(tree), max_size=most))


@given(edited_trees())
def test_a_tree_stays_a_tree_with_its_root(drawn: tuple[Skeleton, np.ndarray, list[BranchEdit]]) -> None:
    tree, seen, edits = drawn
    found = edited(tree, seen, edits, EXTENT)
    assert (found.skeleton.parents[1:] >= 0).all()
    assert np.array_equal(found.skeleton.points[0], tree.points[0])
    assert found.seen.shape == found.skeleton.parents.shape
    assert edge_lengths(found.skeleton)[1:].min(initial=1.0) > 0
    assert all(0 <= lost.index < len(edits) for lost in found.lost)


@given(edited_trees())
def test_radii_fall_outward_unless_another_was_asked_for(
    drawn: tuple[Skeleton, np.ndarray, list[BranchEdit]],
) -> None:
    tree, seen, edits = drawn
    unasked = [edit for edit in edits if not isinstance(edit, SetRadius) and getattr(edit, "radius", None) is None]
    found = edited(tree, seen, unasked, EXTENT).skeleton
    assert (found.radii[1:] <= found.radii[found.parents[1:]] * (1 + 1e-9)).all()


@given(edited_trees())
def test_the_same_edits_give_the_same_bits_and_later_ones_change_nothing_that_was_told(
    drawn: tuple[Skeleton, np.ndarray, list[BranchEdit]],
) -> None:
    tree, seen, edits = drawn
    found, again = edited(tree, seen, edits, EXTENT), edited(tree, seen, edits, EXTENT)
    for name in ("points", "radii", "parents"):
        assert getattr(found.skeleton, name).tobytes() == getattr(again.skeleton, name).tobytes()
    before = edited(tree, seen, edits[:-1], EXTENT)
    assert found.lost[: len(before.lost)] == before.lost


@given(edited_trees(most=3))
def test_edits_mean_the_same_in_every_frame(drawn: tuple[Skeleton, np.ndarray, list[BranchEdit]]) -> None:
    tree, seen, edits = drawn
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    frame = Similarity(np.array([1.0, -2.0, 3.0]), turn, 0.25)
    moved = Skeleton(frame.points(tree.points), frame.scale * tree.radii, tree.parents)
    here, there = (
        edited(tree, seen, edits, EXTENT),
        edited(moved, seen, edits_in_frame(edits, frame), frame.scale * EXTENT),
    )
    assert np.allclose(there.skeleton.points, frame.points(here.skeleton.points), atol=1e-6)
    assert np.allclose(there.skeleton.radii, frame.scale * here.skeleton.radii, atol=1e-6)


def test_no_edits_change_no_bit() -> None:
    found = apply()
    assert (found.skeleton, found.lost) == (SMALL, ())
    assert found.seen is SEEN


def test_a_removed_branch_takes_along_what_leaves_it() -> None:
    found = apply(Remove(at(LEFT)))
    assert np.array_equal(found.skeleton.points, SMALL.points[[ROOT, FORK, RIGHT, RIGHT_TIP]])
    assert found.skeleton.parents.tolist() == [-1, 0, 1, 2]
    assert found.seen.tolist() == [True, True, False, True]


def test_an_added_branch_leads_through_its_points_and_tapers() -> None:
    points = np.array([[0.0, 1.2, 0.5], [0.0, 1.8, 1.0]])
    found = apply(Add(at(FORK), points))
    new = np.arange(len(SMALL), len(found.skeleton))
    assert np.array_equal(found.skeleton.points[new[-1]], points[1])
    assert np.linalg.norm(found.skeleton.points[new] - points[0], axis=1).min() == 0
    assert found.skeleton.parents[new[0]] == FORK
    assert not found.seen[new].any()
    radii = found.skeleton.radii[new]
    assert radii[0] < OF_PARENT * SMALL.radii[FORK]
    assert (np.diff(radii) < 0).all()


def test_an_added_branch_has_the_radius_that_was_asked_for() -> None:
    found = apply(Add(at(LEFT_TIP), np.array([[-1.0, 2.001, 0.0], [-1.0, 2.5, 0.0]]), 0.3))
    assert found.skeleton.radii[len(SMALL)] == pytest.approx(0.3, rel=0.01)


def test_a_moved_joint_takes_along_what_is_beyond_and_bends_the_way_to_it() -> None:
    shift = np.array([0.0, 0.2, 0.1])
    found = apply(Move(at(LEFT_TIP), at(LEFT_TIP) + shift)).skeleton.points
    assert np.allclose(found[LEFT_TIP], SMALL.points[LEFT_TIP] + shift)
    assert np.allclose(found[LEFT], SMALL.points[LEFT] + 0.5 * shift)
    others = [ROOT, FORK, RIGHT, RIGHT_TIP]
    assert np.array_equal(found[others], SMALL.points[others])
    beyond = apply(Move(at(LEFT), at(LEFT) + shift)).skeleton.points
    assert np.allclose(beyond[[LEFT, LEFT_TIP]], SMALL.points[[LEFT, LEFT_TIP]] + shift)


def test_a_radius_scales_what_is_beyond_and_fades_towards_the_fork() -> None:
    found = apply(SetRadius(at(LEFT_TIP), 0.04)).skeleton.radii
    assert found[LEFT_TIP] == 0.04
    assert found[LEFT] == pytest.approx(1.5 * 0.05)
    assert found[FORK] == SMALL.radii[FORK]
    assert apply(SetRadius(at(LEFT), 0.1)).skeleton.radii[LEFT_TIP] == pytest.approx(0.04)


def test_a_piece_is_hung_onto_another_joint_and_its_old_bridge_goes() -> None:
    found = apply(Join(at(RIGHT_TIP), at(LEFT)))
    points = found.skeleton.points
    assert not (points == at(RIGHT)).all(axis=1).any()
    tip = int((points == at(RIGHT_TIP)).all(axis=1).argmax())
    way = [tip]
    while not (points[way[-1]] == at(LEFT)).all():
        way.append(int(found.skeleton.parents[way[-1]]))
    assert found.seen[tip]
    assert not found.seen[way[1:-1]].any()
    assert len(way) > 2


def test_where_all_is_seen_a_branch_is_hung_on_from_its_fork() -> None:
    found = apply(Join(at(LEFT_TIP), at(RIGHT)))
    lost = SMALL.points[[LEFT, LEFT_TIP]]
    assert all((found.skeleton.points == point).all(axis=1).any() for point in lost)
    joint = int((found.skeleton.points == at(LEFT)).all(axis=1).argmax())
    while found.skeleton.parents[joint] >= 0 and not (found.skeleton.points[joint] == at(RIGHT)).all():
        joint = int(found.skeleton.parents[joint])
    assert (found.skeleton.points[joint] == at(RIGHT)).all()


FAR_AWAY = np.array([40.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("edit", "why"),
    [
        (Remove(FAR_AWAY), "no branch near"),
        (Remove(at(ROOT)), "whole tree"),
        (Move(at(ROOT), at(FORK)), "the root stays"),
        (Move(at(LEFT), FAR_AWAY), "far away"),
        (Move(at(LEFT), at(FORK)), "on the one before"),
        (Add(at(LEFT), FAR_AWAY[None]), "far away"),
        (Add(at(LEFT), at(LEFT)[None]), "no length"),
        (Add(at(LEFT), np.tile([at(ROOT), at(LEFT_TIP)], (9, 1))), "far longer"),
        (Add(at(LEFT), at(FORK)[None], 9.0), "that thick"),
        (SetRadius(at(LEFT), 9.0), "that thick"),
        (Join(at(LEFT), at(LEFT_TIP)), "to itself"),
        (Join(at(ROOT), at(LEFT)), "joined to nothing"),
    ],
)
def test_an_edit_that_cannot_be_applied_is_left_out_and_told(edit: BranchEdit, why: str) -> None:
    found = apply(edit, Remove(at(LEFT_TIP)))
    assert [lost.index for lost in found.lost] == [0]
    assert why in found.lost[0].detail
    assert np.array_equal(found.skeleton.points, np.delete(SMALL.points, LEFT_TIP, axis=0))
