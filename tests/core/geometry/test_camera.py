import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from treestroke.core.geometry.camera import Camera, OrthographicCamera, PerspectiveCamera, in_picture

CAMERA = OrthographicCamera(600, 400, 0.02, (300.0, 390.0))
SPOTS = arrays(np.float64, (4, 2), elements=st.floats(-2000, 2000))


def test_the_root_is_the_world_s_origin() -> None:
    assert CAMERA.pixels_from_world(np.zeros((1, 3))).tolist() == [[300.0, 390.0]]


def test_up_in_the_world_is_up_in_the_photo() -> None:
    assert CAMERA.pixels_from_world(np.array([[1.0, 2.0, 0.0]])) == pytest.approx(np.array([[350.0, 290.0]]))


@given(SPOTS, st.floats(-20, 20))
def test_a_photo_point_comes_back_from_the_world_at_any_depth(points_px: np.ndarray, depth_m: float) -> None:
    world = CAMERA.world_from_pixels(points_px, depth_m)
    assert CAMERA.pixels_from_world(world) == pytest.approx(points_px, abs=1e-6)
    assert (world[:, 2] == -depth_m).all()


def test_each_point_may_have_its_own_depth() -> None:
    world = CAMERA.world_from_pixels(np.zeros((3, 2)), np.array([1.0, 2.0, 3.0]))
    assert world[:, 2].tolist() == [-1.0, -2.0, -3.0]


@pytest.mark.parametrize(
    ("width", "height", "scale"), [(0, 9, 1.0), (9, 0, 1.0), (9, 9, 0.0), (9, 9, -1.0), (9, 9, np.nan)]
)
def test_a_camera_without_size_or_scale_is_refused(width: int, height: int, scale: float) -> None:
    with pytest.raises(ValueError, match="a size and a positive scale"):
        OrthographicCamera(width, height, scale, (0.0, 0.0))


def standing_at(x: float, z: float, turn_rad: float) -> PerspectiveCamera:
    """A camera 2 m up at a place, looking level: along -Z, turned left by an angle."""
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    turn = np.array([[c, 0.0, -s], [0.0, -1.0, 0.0], [-s, 0.0, -c]])
    return PerspectiveCamera(640, 480, np.column_stack([turn, -turn @ [x, 2.0, z]]), 600.0, (320.0, 240.0))


LEFT = OrthographicCamera(600, 400, 0.02, (300.0, 390.0), from_left=True)
CAMERAS = [CAMERA, LEFT, standing_at(0.0, 10.0, 0.0), standing_at(-8.0, 6.0, -0.9)]


@pytest.mark.parametrize("camera", CAMERAS)
def test_every_camera_takes_back_what_it_projects(camera: Camera) -> None:
    points = np.random.default_rng(0).uniform([-2, 0, -2], [2, 4, 2], (50, 3))
    assert (camera.depth(points) > -3).all()
    back = camera.world_from_pixels(camera.pixels_from_world(points), camera.depth(points))
    assert back == pytest.approx(points, abs=1e-9)


@pytest.mark.parametrize("camera", CAMERAS)
def test_what_stands_nearer_to_the_viewer_is_less_deep_and_what_stands_right_is_right(camera: Camera) -> None:
    point = np.array([[0.3, 2.5, -0.2]])
    nearer, righter = point + 0.1 * camera.toward_viewer(point), point + 0.1 * camera.right()
    assert camera.depth(nearer)[0] < camera.depth(point)[0]
    step = camera.pixels_from_world(righter)[0] - camera.pixels_from_world(point)[0]
    assert step == pytest.approx([0.1 / camera.pixel_size(point)[0], 0.0], rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("camera", CAMERAS)
def test_a_part_of_a_picture_counts_from_its_own_corner(camera: Camera) -> None:
    points = np.array([[0.5, 1.0, 0.5], [-0.5, 3.0, 0.2]])
    part = camera.cropped((20.0, 30.5), (64, 48))
    assert part.pixels_from_world(points) == pytest.approx(camera.pixels_from_world(points) - [20.0, 30.5])
    assert (part.width, part.height) == (64, 48)


def test_perspective_makes_what_is_twice_as_far_half_as_large() -> None:
    camera = standing_at(0.0, 10.0, 0.0)
    assert camera.pixel_size(np.array([[0.0, 2.0, 5.0], [0.0, 2.0, 0.0]])) == pytest.approx([5 / 600, 10 / 600])
    assert camera.pixels_from_world(np.array([[1.0, 3.0, 0.0]])) == pytest.approx(np.array([[380.0, 180.0]]))


def test_picture_space_has_pixels_in_all_directions() -> None:
    camera, points = OrthographicCamera(300, 400, 0.02, (150.0, 390.0)), np.array([[1.0, 2.0, 0.5], [0.0, 0.0, 0.0]])
    space = camera.picture_space_from_world(points)
    assert space == pytest.approx(np.array([[200.0, 290.0, 25.0], [150.0, 390.0, 0.0]]))
    assert camera.world_from_picture_space(space) == pytest.approx(points)


def test_nothing_behind_a_perspective_camera_is_in_its_picture() -> None:
    points = np.array([[0.0, 2.0, 0.0], [0.0, 2.0, 20.0], [90.0, 2.0, 0.0]])
    assert in_picture(standing_at(0.0, 10.0, 0.0), points).tolist() == [True, False, False]


def test_the_same_picture_at_its_own_size_shows_points_at_the_same_share_of_it() -> None:
    points = np.array([[1.0, 2.0, 3.0]])
    assert CAMERA.enlarged(0.25, (2400, 1600)).pixels_from_world(points) == pytest.approx(
        4 * CAMERA.pixels_from_world(points)
    )


@pytest.mark.parametrize("pose", [np.eye(3), np.eye(3, 4) * 2, -np.eye(3, 4)])
def test_a_pose_that_is_no_rotation_is_refused(pose: np.ndarray) -> None:
    with pytest.raises(ValueError, match="rotation"):
        PerspectiveCamera(640, 480, pose, 600.0, (320.0, 240.0))


def test_a_camera_to_the_left_shows_the_same_heights_about_the_root() -> None:
    left = CAMERA.to_the_left(250.0)
    assert (left.width, left.height, left.from_left) == (500, 400, True)
    seen = left.pixels_from_world(np.array([[7.0, 2.0, 1.0], [0.0, 0.0, 0.0]]))
    assert seen == pytest.approx(np.array([[300.0, 290.0], [250.0, 390.0]]))
