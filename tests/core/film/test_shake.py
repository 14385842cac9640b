import numpy as np
import pytest
from tests.swaying import crown_mask, sway_px, swaying

from treestroke.core.film.shake import FEWEST, camera_motion, without_camera
from treestroke.core.film.tracks import Tracks, follow


def test_a_shaking_camera_is_found_and_taken_out() -> None:
    frames = swaying(shake_px=5.0)
    motion = camera_motion(follow(frames, 0, ~crown_mask(), most=150), (200, 160))
    shake = 5.0 * np.sin(2.0 * np.pi * 0.7 * np.arange(48) / 24.0)
    assert motion.to_frame[:, 0, 2] == pytest.approx(shake, abs=0.5)
    tracks = without_camera(follow(frames, 0, crown_mask()), motion)
    truth = sway_px(tracks.rest, np.arange(48))
    assert np.median(np.abs(tracks.moved[..., 0] - truth)[tracks.seen]) < 0.4


def test_a_camera_that_stands_still_changes_nothing() -> None:
    frames = swaying()
    motion = camera_motion(follow(frames, 0, ~crown_mask(), most=150), (200, 160))
    tracks = follow(frames, 0, crown_mask())
    assert without_camera(tracks, motion).points == pytest.approx(tracks.points)


def test_without_a_background_the_camera_is_taken_to_stand_still() -> None:
    few = Tracks(np.zeros((5, FEWEST - 1, 2)), np.ones((5, FEWEST - 1), dtype=bool), np.zeros((FEWEST - 1, 2)))
    motion = camera_motion(few, (200, 160))
    assert not motion.shift_px.any()
