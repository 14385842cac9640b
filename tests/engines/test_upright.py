import numpy as np
import pytest
from tests.engines.rendered_set import camera_at, ring

from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.types import Floats
from treestroke.engines.upright import up_direction, upright_turn

UP = np.array([0.0, 1.0, 0.0])


def ground(slope: float = 0.0) -> Floats:
    rng = np.random.default_rng(2)
    x, z = rng.uniform(-5, 5, (2, 800))
    return np.column_stack([x, slope * x + rng.normal(0, 0.01, 800), z])


def crown() -> Floats:
    return np.asarray(np.random.default_rng(4).normal([0, 3, 0], 1.0, (400, 3)))


def off_deg(cameras: list[PerspectiveCamera], points: Floats) -> float:
    """Measure how far from up the direction found is, in a frame that stands upside down and askew."""
    askew = upright_turn(np.array([0.48, -0.8, 0.36]))
    turns = np.array([camera.camera_from_world[:, :3] @ askew.T for camera in cameras])
    up = up_direction(turns, np.array([camera.centre for camera in cameras]) @ askew.T, points @ askew.T)
    return float(np.degrees(np.arccos(np.clip(up @ askew @ UP, -1, 1))))


@pytest.mark.parametrize("arc", [60.0, 150.0, 345.0])
def test_cameras_held_level_tell_what_is_up(arc: float) -> None:
    assert off_deg(ring(9, arc), crown()) < 1.5


def test_the_ground_helps() -> None:
    cameras = ring(6, 40.0)
    assert off_deg(cameras, crown()) > 5.0
    assert off_deg(cameras, np.concatenate([crown(), ground()])) < 2.0


def test_a_slope_does_not_tip_the_tree() -> None:
    assert off_deg(ring(18, 200.0), np.concatenate([crown(), ground(0.15)])) < 2.5


def test_a_photo_on_its_side_does_not_matter() -> None:
    cameras = ring(9, 150.0)
    eye = cameras[4].centre
    cameras[4] = camera_at(eye, np.array([0.0, 1.0, 0.0]), roll_rad=np.pi / 2)
    assert off_deg(cameras, crown()) < 1.5


def test_photos_straight_down_in_one_row() -> None:
    cameras = [
        PerspectiveCamera(400, 300, np.column_stack([turn, -turn @ [x, 9.0, 0.0]]), 300.0, (200.0, 150.0))
        for turn in [np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])]
        for x in range(6)
    ]
    assert off_deg(cameras, ground()) < 1.0
