"""A trunk that was drawn in one shot is placed in space by the others."""

import cv2
import numpy as np
from tests.core.segment.walked_tree import HEIGHT, WIDTH, camera_at

from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.segment.view_mattes_trunk import around_trunk, standing_trunk, trunk_seen
from treestroke.core.types import Mask

AXIS = np.column_stack([0.1 * np.linspace(0, 2, 30), np.linspace(0, 2, 30), 0.15 * np.linspace(0, 2, 30)])
HALF = 0.12
CAMERAS = [camera_at(turn) for turn in np.linspace(0, 2 * np.pi, 7, endpoint=False)]


def seen(camera: PerspectiveCamera) -> Mask:
    """Draw a trunk that leans to the right and toward the first camera."""
    drawn = np.zeros((HEIGHT, WIDTH), np.uint8)
    half_px = HALF / camera.pixel_size(AXIS)
    for (x, y), half in zip(camera.pixels_from_world(AXIS), half_px, strict=True):
        cv2.rectangle(drawn, (round(x - half), round(y) - 1), (round(x + half) - 1, round(y) + 1), 1, -1)
    return drawn > 0


def test_a_leaning_trunk_is_found_and_seen_where_it_is() -> None:
    masks = [seen(camera) for camera in CAMERAS]
    odds = [np.where(mask, 3.0, -3.0).astype(np.float32) for mask in masks]
    trunk = standing_trunk(masks[0], CAMERAS[0], CAMERAS[1:], odds[1:])
    assert trunk is not None
    true_z = np.interp(trunk.axis[:, 1], AXIS[:, 1], AXIS[:, 2])
    assert np.abs(trunk.axis[:, 2] - true_z).max() < 0.5 * HALF
    for mask, camera in zip(masks, CAMERAS, strict=True):
        found = trunk_seen(trunk, camera)
        assert (found & mask).sum() / (found | mask).sum() > 0.7
    beside = np.array([[0.1, 1.0, 0.15], [0.6, 1.0, 0.15]])
    assert around_trunk(trunk, beside, 0.05).tolist() == [True, False]


def test_no_trunk_drawn_stands_nowhere() -> None:
    assert standing_trunk(np.zeros((HEIGHT, WIDTH), bool), CAMERAS[0], CAMERAS[1:], []) is None
