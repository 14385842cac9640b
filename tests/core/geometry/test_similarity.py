"""Changes of frame that keep shapes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.geometry.similarity import Similarity

POSE = np.array([[1.0, 0.0, 0.0, 0.5], [0.0, -1.0, 0.0, 1.5], [0.0, 0.0, -1.0, 9.0]])
CAMERA = PerspectiveCamera(640, 480, POSE, 500.0, (320.0, 240.0))
POINTS = np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 0.5], [-0.7, 1.1, 2.0]])


def turned(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])


@given(st.floats(-3, 3), st.floats(0.1, 20), st.floats(-5, 5))
def test_a_camera_shows_the_same_in_another_frame(angle: float, scale: float, shift: float) -> None:
    frame = Similarity(np.array([shift, 0.3, -shift]), turned(angle), scale)
    before, after = CAMERA.pixels_from_world(POINTS), frame.camera(CAMERA).pixels_from_world(frame.points(POINTS))
    np.testing.assert_allclose(after, before, atol=1e-6)
    np.testing.assert_allclose(frame.camera(CAMERA).depth(frame.points(POINTS)), scale * CAMERA.depth(POINTS))


def test_the_origin_becomes_the_origin_and_lengths_are_scaled() -> None:
    frame = Similarity(POINTS[1], turned(0.4), 3.0)
    moved = frame.points(POINTS)
    np.testing.assert_allclose(moved[1], 0, atol=1e-12)
    assert np.linalg.norm(moved[0] - moved[2]) == pytest.approx(3 * np.linalg.norm(POINTS[0] - POINTS[2]))


def test_what_is_no_rotation_is_refused() -> None:
    with pytest.raises(ValueError, match="rotation"):
        Similarity(np.zeros(3), 2 * np.eye(3), 1.0)


def test_a_resized_camera_shows_the_same_at_another_size() -> None:
    larger = CAMERA.resized(1280, 960)
    np.testing.assert_allclose(larger.pixels_from_world(POINTS), 2 * CAMERA.pixels_from_world(POINTS))
