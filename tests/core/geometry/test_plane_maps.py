import numpy as np
import pytest

from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.geometry.plane_maps import parallax_px, plane_map
from treestroke.core.geometry.vectors import UP


def camera_at(x: float, turn: float) -> PerspectiveCamera:
    """A camera 1.6 m above the ground at x, 8 m before the root, turned about the vertical."""
    sine, cosine = np.sin(turn), np.cos(turn)
    axes = np.array([[cosine, 0.0, sine], [0.0, -1.0, 0.0], [sine, 0.0, -cosine]])
    return PerspectiveCamera(320, 240, np.column_stack([axes, -axes @ [x, 1.6, 8.0]]), 300.0, (160.0, 120.0))


ONE, OTHER = camera_at(-0.5, 0.05), camera_at(0.9, -0.1)


def carried(plane: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Carry what one camera shows of points to the other picture by a map of array columns and rows."""
    columns_rows = np.column_stack([ONE.pixels_from_world(points) - 0.5, np.ones(len(points))]) @ plane.T
    return columns_rows[:, :2] / columns_rows[:, 2:] + 0.5


def test_points_of_a_plane_before_the_camera_go_where_the_other_sees_them() -> None:
    points = ONE.world_from_pixels(np.array([[20.0, 30.0], [160.0, 120.0], [300.0, 200.0]]), 7.0)
    found = carried(plane_map(ONE, OTHER, ONE.ahead, 7.0), points)
    np.testing.assert_allclose(found, OTHER.pixels_from_world(points), atol=1e-6)


def test_points_of_the_ground_go_where_the_other_sees_them() -> None:
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 2.0], [-2.0, 0.0, -3.0]])
    found = carried(plane_map(ONE, OTHER, UP, -1.6), points)
    np.testing.assert_allclose(found, OTHER.pixels_from_world(points), atol=1e-6)


def test_what_is_far_away_is_only_turned() -> None:
    points = ONE.world_from_pixels(np.array([[20.0, 30.0], [300.0, 200.0]]), 1e9)
    found = carried(plane_map(ONE, OTHER, ONE.ahead, np.inf), points)
    np.testing.assert_allclose(found, OTHER.pixels_from_world(points), atol=1e-4)


def test_parallax_is_the_shift_between_level_pictures() -> None:
    one, other = camera_at(0.0, 0.0), camera_at(0.7, 0.0)
    near, far = one.world_from_pixels(np.array([[160.0, 120.0]] * 2), np.array([5.0, 1e9]))
    shift = other.pixels_from_world(np.stack([near, far]))[:, 0]
    assert parallax_px(one, other, 5.0) == pytest.approx(abs(shift[0] - shift[1]), rel=1e-6)
