"""What matches the neighbouring shots far behind a tree is none of it."""

import cv2
import numpy as np
from tests.core.segment.walked_tree import FOCAL, HEIGHT, WIDTH, camera_at

from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.segment.view_mattes_parallax import far_odds
from treestroke.core.types import Picture

CAMERAS = [camera_at(turn) for turn in (-0.15, 0.0, 0.15)]


def wall_at(depth: float, camera: PerspectiveCamera) -> Picture:
    """Show a speckled wall that faces +Z, so far behind the root."""
    fine = np.random.default_rng(3).integers(0, 255, (60, 120, 3), dtype=np.uint8)
    texture = cv2.resize(fine, (960, 480), interpolation=cv2.INTER_CUBIC)
    size = 1.6 * (10.0 + depth) * np.array([WIDTH, HEIGHT]) / FOCAL
    corners = np.array([[-1, 1], [1, 1], [1, -1], [-1, -1]]) * size / 2
    places = np.column_stack([corners[:, 0], corners[:, 1] + 1.6, np.full(4, -depth)])
    there = camera.pixels_from_world(places).astype(np.float32)
    square = np.array([[0, 0], [960, 0], [960, 480], [0, 480]], np.float32)
    turned = cv2.getPerspectiveTransform(square, there)
    return np.asarray(cv2.warpPerspective(texture, turned, (WIDTH, HEIGHT)), dtype=np.uint8)


def odds_of_a_wall(depth: float) -> np.ndarray:
    region = np.zeros((HEIGHT, WIDTH), dtype=bool)
    region[40:80, 70:130] = True
    return far_odds([wall_at(depth, camera) for camera in CAMERAS], CAMERAS, [region] * 3, 2.0)[1][50:70, 80:120]


def test_a_far_wall_is_no_tree_and_a_near_one_may_be() -> None:
    assert np.median(odds_of_a_wall(15.0)) < -4
    assert np.median(odds_of_a_wall(0.0)) > -1
