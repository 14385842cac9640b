import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.strategies import skeletons

from treestroke.core.geometry.polyline import distances_to_segment
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import child_counts
from treestroke.core.trace.skeleton_builder import SkeletonBuilder, drop_subtrees, simplify

TREES = skeletons(dimensions=2, stems=False)
STEM = np.array([[0.0, 90.0], [0.0, 60.0], [0.0, 30.0], [0.0, 0.0]])


def drafted(spur_px: float) -> SkeletonBuilder:
    """Draw a stem of 90 px and a found side of the given length at its second joint."""
    builder = SkeletonBuilder()
    builder.add_chain(-1, STEM, 5.0, stroke=0)
    builder.add_chain(1, np.array([[0.0, 60.0], [spur_px / 2, 60.0], [spur_px, 60.0]]), 2.0, stroke=-1)
    return builder


def off_line(points: np.ndarray, tree: Skeleton) -> np.ndarray:
    edges = [(tree.points[p], tree.points[j]) for j, p in enumerate(tree.parents.tolist()) if p >= 0]
    return np.min([distances_to_segment(points, start, end) for start, end in edges], axis=0)


def test_a_chain_from_a_parent_begins_with_the_parent() -> None:
    tree = drafted(20.0).skeleton()
    assert tree.parents.tolist() == [-1, 0, 1, 2, 1, 4]
    assert tree.points[4:].tolist() == [[10, 60], [20, 60]]
    assert tree.radii.tolist() == [5, 5, 5, 5, 2, 2]


def test_adding_a_chain_returns_its_last_joint() -> None:
    builder = SkeletonBuilder()
    assert builder.add_chain(-1, STEM, 5.0, stroke=0) == 3
    assert builder.add_chain(3, STEM[-1:], 5.0, stroke=0) == 3


def test_the_nearest_joint_is_found() -> None:
    assert drafted(20.0).nearest(np.array([17.0, 70.0])) == 5


def test_a_point_inside_a_trunk_belongs_to_it_even_if_the_middle_of_a_limb_is_nearer() -> None:
    builder = drafted(20.0)
    builder.radii[:4] = [30.0, 30.0, 30.0, 30.0]
    assert builder.nearest(np.array([18.0, 61.0])) == 1


def test_the_joints_below_one_are_those_of_its_own_stroke() -> None:
    assert drafted(20.0).stem_below(2).tolist() == [0, 1, 2]
    assert drafted(20.0).stem_below(5).tolist() == [4, 5]


@given(TREES, st.data())
def test_dropped_joints_go_with_all_their_descendants(tree: Skeleton, data: st.DataObject) -> None:
    dropped = data.draw(st.sets(st.integers(1, max(1, len(tree) - 1)))) if len(tree) > 1 else set()
    kept, number = drop_subtrees(tree, np.arange(len(tree)), np.array(sorted(dropped), dtype=np.int64))
    for joint in range(len(tree)):
        way = [joint]
        while tree.parents[way[-1]] >= 0:
            way.append(int(tree.parents[way[-1]]))
        assert (joint in number) == dropped.isdisjoint(way)
    assert np.array_equal(number[kept.parents[1:]], tree.parents[number][1:])


@given(TREES, st.floats(0.0, 40.0))
def test_simplifying_keeps_forks_and_ends(tree: Skeleton, tolerance: float) -> None:
    kept, number = simplify(tree, np.arange(len(tree)), tolerance)
    assert np.isin(np.flatnonzero((child_counts(tree) != 1) | (tree.parents < 0)), number).all()
    assert np.array_equal(kept.points, tree.points[number])
    assert np.array_equal(child_counts(kept), child_counts(tree)[number])


@given(skeletons(dimensions=2, stems=False).filter(lambda tree: len(tree) > 1), st.floats(0.1, 40.0))
def test_simplifying_moves_the_line_by_no_more_than_its_tolerance(tree: Skeleton, tolerance: float) -> None:
    kept, _ = simplify(tree, np.zeros(len(tree), dtype=np.int64), tolerance)
    assert off_line(tree.points, kept).max() <= tolerance + 1e-6


def test_a_straight_stem_is_two_joints() -> None:
    tree, stroke = simplify(Skeleton(STEM, np.ones(4), np.arange(4) - 1), np.zeros(4, dtype=np.int64), 0.5)
    assert tree.points.tolist() == [[0, 90], [0, 0]]
    assert stroke.tolist() == [0, 0]


def test_simplifying_keeps_how_thickness_falls() -> None:
    stem = np.column_stack([np.zeros(5), np.arange(5) * -10.0])
    tree, _ = simplify(
        Skeleton(stem, np.array([9.0, 9.0, 9.0, 4.0, 3.5]), np.arange(5) - 1), np.zeros(5, dtype=int), 0.4
    )
    assert np.interp(-stem[:, 1], -tree.points[:, 1], tree.radii) == pytest.approx([9, 9, 9, 4, 3.5], abs=0.4)
