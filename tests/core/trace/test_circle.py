"""A drawn Y, of which just the stem is known: the circle finds the arms."""

import numpy as np
import pytest
from tests.pictures import disc, wood_mask

from treestroke.core.geometry.polyline import resample
from treestroke.core.trace.circle import Circle, trace_forks
from treestroke.core.trace.skeleton_builder import SkeletonBuilder

STEM = [(200.0, 390.0), (200.0, 220.0)]
LEFT, RIGHT = [(200.0, 220.0), (110.0, 60.0)], [(200.0, 220.0), (290.0, 60.0)]
RADIUS = 25.0


def traced(wood: np.ndarray) -> SkeletonBuilder:
    """Follow the stem and let the circle run."""
    builder = SkeletonBuilder()
    builder.add_chain(-1, resample(np.array(STEM), 4.0), 8.0, stroke=0)
    trace_forks(builder, Circle(RADIUS, wood), list(range(0, len(builder.points), 2)))
    return builder


def covered(line: list[tuple[float, float]], builder: SkeletonBuilder, within: float) -> float:
    """Share of a line with a found joint's edge near it."""
    found = [resample(np.stack([builder.points[p], builder.points[j]]), 1.0) for j, p in enumerate(builder.parents)]
    near = np.concatenate(
        [piece for piece, stroke in zip(found, builder.stroke, strict=True) if stroke < 0] or [[[0, 0]]]
    )
    places = resample(np.array(line), 2.0)
    return float((np.linalg.norm(places[:, None] - near, axis=-1).min(axis=1) <= within).mean())


@pytest.mark.parametrize("arm", [LEFT, RIGHT], ids=["left", "right"])
def test_an_arm_without_stroke_is_found(arm: list[tuple[float, float]]) -> None:
    builder = traced(wood_mask([(STEM, 16.0), (arm, 11.0)], 400, 400))
    assert covered(arm, builder, within=6.0) > 0.8


def test_both_arms_of_a_fork_are_found_with_their_thickness() -> None:
    builder = traced(wood_mask([(STEM, 16.0), (LEFT, 11.0), (RIGHT, 11.0)], 400, 400))
    found = np.array(builder.radii)[np.array(builder.stroke) < 0]
    assert min(covered(LEFT, builder, 6.0), covered(RIGHT, builder, 6.0)) > 0.8
    assert np.median(found) == pytest.approx(5.5, abs=1.0)


def test_a_fork_behind_a_fork_is_found() -> None:
    twig = [(145.0, 122.0), (150.0, 30.0)]
    builder = traced(wood_mask([(STEM, 16.0), (LEFT, 11.0), (twig, 9.0)], 400, 400))
    assert covered(twig, builder, within=8.0) > 0.6


def test_found_branches_are_connected_with_the_stem() -> None:
    tree = traced(wood_mask([(STEM, 16.0), (LEFT, 11.0), (RIGHT, 11.0)], 400, 400)).skeleton()
    assert np.count_nonzero(tree.parents < 0) == 1


@pytest.mark.parametrize("centre", [(200.0, 180.0), (240.0, 260.0)])
def test_a_blob_like_dark_leaves_is_not_a_branch(centre: tuple[float, float]) -> None:
    wood = wood_mask([(STEM, 16.0)], 400, 400) | disc(400, 50, centre)
    assert min(traced(wood).stroke) == 0


def test_a_branch_beyond_a_gap_is_not_reached() -> None:
    wood = wood_mask([(STEM, 16.0), ([(240.0, 250.0), (330.0, 100.0)], 10.0)], 400, 400)
    assert min(traced(wood).stroke) == 0


@pytest.mark.parametrize("wood", [np.zeros((400, 400), dtype=bool), np.ones((400, 400), dtype=bool)])
def test_nothing_is_found_where_all_is_alike(wood: np.ndarray) -> None:
    assert min(traced(wood).stroke) == 0


def test_arcs_are_the_middles_of_wood_on_the_circle() -> None:
    wood = wood_mask([([(50, 50), (95, 50)], 8.0), ([(50, 50), (50, 95)], 8.0)], 100, 100)
    arcs = Circle(30.0, wood).arcs(np.array([50.0, 50.0]))
    assert arcs[np.argsort(arcs[:, 0])] == pytest.approx(np.array([[50, 80], [80, 50]]), abs=1.0)


def test_an_arc_through_the_circle_s_first_point_is_one() -> None:
    wood = wood_mask([([(50, 50), (99, 50)], 12.0)], 100, 100)
    assert len(Circle(30.0, wood).arcs(np.array([50.0, 50.0]))) == 1
