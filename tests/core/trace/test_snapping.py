from itertools import pairwise

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from tests.pictures import wood_mask

from treestroke.core.geometry.polyline import distances_to_segment, resample
from treestroke.core.trace.snapping import blur, snap

STRAIGHT = np.array([[120.0, 280.0], [150.0, 20.0]])
NOWHERE = np.full((300, 300), -6.0, np.float32)


def odds_of(line: np.ndarray, thickness: float = 8.0) -> np.ndarray:
    """Return the log odds of wood, blurred as the tracer blurs them."""
    return gaussian_filter(np.where(wood_mask([(line, thickness)], 300, 300), 6.0, -6.0).astype(np.float32), 2.0)


def away(points: np.ndarray, line: np.ndarray) -> np.ndarray:
    return np.min([distances_to_segment(points, a, b) for a, b in pairwise(line)], axis=0)


@pytest.mark.parametrize("seed", range(5))
def test_a_jittered_stroke_comes_back_to_its_line(seed: int) -> None:
    drawn = resample(STRAIGHT, 25.0)
    shaken = drawn + np.random.default_rng(seed).uniform(-2.1, 2.1, drawn.shape)
    assert away(snap(shaken, odds_of(STRAIGHT), 6.0, 2.0)[5:-5], STRAIGHT).max() < 1.5


@pytest.mark.parametrize("aside", [-4.0, 4.0])
def test_a_stroke_beside_its_line_is_pulled_onto_it(aside: float) -> None:
    found = snap(STRAIGHT + np.array([aside, 0.0]), odds_of(STRAIGHT), 6.0, 2.0)
    assert np.median(away(found, STRAIGHT)) < 1.0


def test_a_bend_is_followed() -> None:
    y = np.linspace(280, 20, 30)
    bend = np.stack([150 + 30 * np.sin(y / 60), y], axis=1)
    assert away(snap(bend + np.array([3.0, 0.0]), odds_of(bend), 6.0, 2.0)[5:-5], bend).max() < 2.0


def test_without_evidence_the_stroke_stays() -> None:
    assert away(snap(STRAIGHT, NOWHERE, 6.0, 2.0), STRAIGHT).max() < 1e-6


def test_no_point_is_moved_beyond_reach() -> None:
    found = snap(STRAIGHT, odds_of(STRAIGHT + np.array([9.0, 0.0])), 6.0, 2.0)
    assert away(found, STRAIGHT).max() <= 6.0 + 1e-6


def test_a_stroke_of_two_near_points_is_kept() -> None:
    dot = np.array([[100.0, 100.0], [101.0, 100.0]])
    assert snap(dot, NOWHERE, 6.0, 2.0) == pytest.approx(dot)


def test_blurring_keeps_a_straight_line_and_any_line_s_ends() -> None:
    ramp = np.stack([np.arange(20.0), 3 * np.arange(20.0)], axis=1)
    rough = np.random.default_rng(0).normal(size=(20, 2))
    assert blur(ramp, 4.0) == pytest.approx(ramp)
    assert blur(rough, 4.0)[[0, -1]] == pytest.approx(rough[[0, -1]])
    assert np.diff(blur(rough, 4.0), axis=0).std() < 0.2 * np.diff(rough, axis=0).std()
