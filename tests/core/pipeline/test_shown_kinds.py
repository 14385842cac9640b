"""What the twigs of a captured tree bear, by several of its photos."""

import numpy as np
import pytest
from tests.core.carve.walk import painted, sees, shot, walk

from treestroke.core.capture import TreeMatte
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import TurnedOutline, turned_outline
from treestroke.core.pipeline.shown_kinds import odds_by_shots
from treestroke.core.pipeline.taken import ASK_BELOW
from treestroke.core.segment.kind import UNJUDGED, likeliest

BALL = ((0.0, 2.5, 0.0), 1.2)
FRONT = {"leaves": 0.2, "needles": 0.7, "scales": 0.05, "palm": 0.03, "bare": 0.02}


def crown() -> TurnedOutline:
    camera = OrthographicCamera(100, 100, 0.05, (50.0, 90.0))
    x, y = np.meshgrid(np.arange(100) + 0.5, np.arange(100) + 0.5)
    return turned_outline(Silhouette(np.hypot(x - 50, y - 40) <= 24, camera))


def test_shots_that_show_no_tree_leave_it_to_the_front() -> None:
    cameras = walk(6, 360)
    empty = np.zeros((cameras[0].height, cameras[0].width), np.float32)
    mattes = [TreeMatte(empty, empty, empty > 0)] * 6
    found = odds_by_shots(FRONT, [shot(camera) for camera in cameras], mattes, crown())
    assert found == pytest.approx(FRONT)


def test_other_shots_are_asked_too_and_the_odds_are_a_probability() -> None:
    cameras = walk(6, 360)
    masks = [sees(camera, [BALL]).astype(np.float32) for camera in cameras]
    shots = [shot(camera, painted(camera, BALL)) for camera in cameras]
    found = odds_by_shots(FRONT, shots, [TreeMatte(mask, 0 * mask, mask < 0) for mask in masks], crown())
    assert set(found) == set(UNJUDGED)
    assert sum(found.values()) == pytest.approx(1)
    assert found != pytest.approx(FRONT, abs=0.02)


def test_a_tree_of_nothing_but_wood_is_bare_but_not_for_sure() -> None:
    cameras = walk(6, 360)
    masks = [sees(camera, [BALL]).astype(np.float32) for camera in cameras]
    mattes = [TreeMatte(mask, mask, mask < 0) for mask in masks]
    found = odds_by_shots(FRONT, [shot(camera) for camera in cameras], mattes, crown())
    assert likeliest(found) == "bare"
    assert found["bare"] < ASK_BELOW
    assert sum(found.values()) == pytest.approx(1)
    sure = {**FRONT, "needles": 0.0, "leaves": 0.0, "bare": 0.92}
    assert odds_by_shots(sure, [shot(camera) for camera in cameras], mattes, crown()) == sure
