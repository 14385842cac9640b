from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.ndimage import gaussian_filter1d

from treestroke.core.geometry.polyline import (
    arc_lengths,
    directions,
    distances_to_segment,
    normals,
    resample,
    simplified,
    smoothed,
)

CORNER = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]])
CHAINS = st.integers(2, 20).flatmap(lambda n: arrays(np.float64, (n, 2), elements=st.floats(-100, 100, width=32)))


def away_from_line(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    pieces = [distances_to_segment(points, a, b) for a, b in pairwise(line)]
    return np.min(pieces, axis=0)


def test_arc_length_adds_up_the_pieces() -> None:
    assert arc_lengths(CORNER).tolist() == [0.0, 3.0, 7.0]


@given(CHAINS, st.floats(0.5, 50))
def test_resampling_keeps_both_ends_and_stays_on_the_line(line: np.ndarray, step: float) -> None:
    walked = resample(line, step)
    assert np.array_equal(walked[[0, -1]], line[[0, -1]])
    assert away_from_line(walked, line).max() < 1e-6


@pytest.mark.parametrize(("step", "count"), [(1.0, 8), (0.5, 15), (2.0, 5), (100.0, 2)])
def test_resampling_walks_in_equal_steps_near_the_one_asked_for(step: float, count: int) -> None:
    straight = np.array([[0.0, 0.0], [1.0, 0.0], [7.0, 0.0]])
    assert resample(straight, step)[:, 0] == pytest.approx(np.linspace(0, 7, count))


def test_a_lone_point_stays_where_it_is() -> None:
    assert resample(np.array([[5.0, 6.0]]), 1.0).tolist() == [[5.0, 6.0], [5.0, 6.0]]


def test_directions_are_unit_tangents() -> None:
    assert directions(CORNER) == pytest.approx(np.array([[1, 0], [0.6, 0.8], [0, 1]]))


def test_normals_are_a_quarter_turn_from_x_toward_y() -> None:
    assert normals(np.array([[0.0, 0.0], [2.0, 0.0]])).tolist() == [[0.0, 1.0], [0.0, 1.0]]


@given(CHAINS, st.floats(0.1, 30))
def test_a_simplified_line_stays_within_tolerance(line: np.ndarray, tolerance: float) -> None:
    kept = simplified(line, tolerance)
    assert kept[0] == 0
    assert kept[-1] == len(line) - 1
    for start, end in pairwise(kept):
        assert distances_to_segment(line[start : end + 1], line[start], line[end]).max() <= tolerance + 1e-6


def test_a_straight_line_keeps_its_ends_alone() -> None:
    line = np.stack([np.arange(9.0), 2 * np.arange(9.0)], axis=1)
    assert simplified(line, 0.01).tolist() == [0, 8]


def test_a_corner_is_kept() -> None:
    line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0]])
    assert simplified(line, 0.1).tolist() == [0, 2, 4]


def test_distance_is_to_the_segment_and_not_to_its_line() -> None:
    points = np.array([[0.0, 3.0], [5.0, 2.0], [13.0, 4.0]])
    assert distances_to_segment(points, np.zeros(2), np.array([10.0, 0.0])).tolist() == [3.0, 2.0, 5.0]


def test_a_segment_without_length_is_a_point() -> None:
    assert distances_to_segment(np.array([[3.0, 4.0]]), np.zeros(2), np.zeros(2)).tolist() == [5.0]


@pytest.mark.parametrize("count", [0, 1, 2, 40])
def test_smoothing_keeps_length_and_level(count: int) -> None:
    assert smoothed(np.full(count, 3.0), 5.0) == pytest.approx(np.full(count, 3.0))


def test_smoothing_is_that_of_scipy() -> None:
    rough = np.random.default_rng(0).normal(size=(50, 2))
    np.testing.assert_allclose(smoothed(rough, 3.0), gaussian_filter1d(rough, 3.0, axis=0, mode="nearest"), atol=1e-12)
