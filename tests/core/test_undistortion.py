import cv2
import numpy as np
import pytest

from treestroke.core.capture import SolvedPhoto
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.undistortion import distorted_points, undistorted, undistorted_points

CAMERA = PerspectiveCamera(400, 300, np.column_stack([np.eye(3), np.zeros(3)]), 320.0, (200.0, 150.0))
PHOTO = SolvedPhoto("a.jpg", CAMERA, -0.15)
POINTS = np.array([[-0.4, -0.3, 1.0], [0.45, 0.2, 1.0], [0.1, 0.35, 1.0], [0.0, 0.0, 1.0]])


def seen() -> np.ndarray:
    """Where the lens shows the points, px."""
    x, y = POINTS[:, 0], POINTS[:, 1]
    bent = 1 + PHOTO.radial * (x**2 + y**2)
    return np.column_stack([200 + 320 * x * bent, 150 + 320 * y * bent])


def test_drawn_points_go_where_the_shot_sees_them() -> None:
    shot = undistorted(np.zeros((300, 400, 3), np.uint8), PHOTO)
    found = undistorted_points(seen(), PHOTO)
    np.testing.assert_allclose(found, shot.camera.pixels_from_world(POINTS), atol=0.01)


def test_points_of_a_shot_go_back_to_where_the_lens_shows_them() -> None:
    shot = undistorted(np.zeros((300, 400, 3), np.uint8), PHOTO)
    np.testing.assert_allclose(distorted_points(shot.camera.pixels_from_world(POINTS), PHOTO), seen(), atol=1e-9)
    np.testing.assert_allclose(distorted_points(undistorted_points(seen(), PHOTO), PHOTO), seen(), atol=0.01)


def test_the_picture_is_unbent_as_its_points() -> None:
    picture = np.zeros((300, 400, 3), np.uint8)
    for x, y in seen():
        cv2.circle(picture, (round(16 * (x - 0.5)), round(16 * (y - 0.5))), 64, (255, 255, 255), -1, shift=4)
    shot = undistorted(picture, PHOTO)
    _, _, _, middles = cv2.connectedComponentsWithStats((shot.picture[..., 0] > 127).astype(np.uint8))
    expected = shot.camera.pixels_from_world(POINTS)
    off = np.linalg.norm(middles[1:, None] + 0.5 - expected[None], axis=2).min(axis=1)
    assert len(off) == len(POINTS)
    assert off.max() < 0.4


def test_a_picture_of_another_size_than_its_cameras_is_refused() -> None:
    with pytest.raises(ValueError, match="does not fit its camera"):
        undistorted(np.zeros((150, 200, 3), np.uint8), PHOTO)
