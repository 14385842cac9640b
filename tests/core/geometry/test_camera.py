import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from treestroke.core.geometry.camera import Camera

CAMERA = Camera(600, 400, 0.02, (300.0, 390.0))
SPOTS = arrays(np.float64, (4, 2), elements=st.floats(-2000, 2000))


def test_the_root_is_the_world_s_origin() -> None:
    assert CAMERA.pixels_from_world(np.zeros((1, 3))).tolist() == [[300.0, 390.0]]


def test_up_in_the_world_is_up_in_the_photo() -> None:
    assert CAMERA.pixels_from_world(np.array([[1.0, 2.0, 0.0]])) == pytest.approx(np.array([[350.0, 290.0]]))


@given(SPOTS, st.floats(-20, 20))
def test_a_photo_point_comes_back_from_the_world_at_any_depth(points_px: np.ndarray, depth_m: float) -> None:
    world = CAMERA.world_from_pixels(points_px, depth_m)
    assert CAMERA.pixels_from_world(world) == pytest.approx(points_px, abs=1e-6)
    assert (world[:, 2] == depth_m).all()


def test_each_point_may_have_its_own_depth() -> None:
    world = CAMERA.world_from_pixels(np.zeros((3, 2)), np.array([1.0, 2.0, 3.0]))
    assert world[:, 2].tolist() == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(
    ("width", "height", "scale"), [(0, 9, 1.0), (9, 0, 1.0), (9, 9, 0.0), (9, 9, -1.0), (9, 9, np.nan)]
)
def test_a_camera_without_size_or_scale_is_refused(width: int, height: int, scale: float) -> None:
    with pytest.raises(ValueError, match="a size and a positive scale"):
        Camera(width, height, scale, (0.0, 0.0))
