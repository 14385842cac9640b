"""The trace of a walk around a small tree: leafy balls on a post."""

from functools import cache
from typing import Any

import cv2
import numpy as np
import pytest
from tests.core.pipeline.walked_capture import HEIGHT, structure_of
from tests.core.segment.walked_tree import cover, strokes_on, walk

from treestroke.core.capture import CapturedPhoto
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.skeleton.branch_edits import Add, BranchEdit, Remove
from treestroke.core.strokes import CaptureStrokes
from treestroke.service.capture_trace import MOST_TRIANGLES, CaptureReading, read_capture, trace_capture

SHOTS, _ = walk(8)
NAMES = [shot.name for shot in SHOTS]
LARGER = 4
"""Times that the photos are larger than they are read."""


@cache
def reading() -> CaptureReading:
    """Read photos that are larger than their cameras' pictures, which stay smaller than what is read at most."""
    photos = [CapturedPhoto(shot.name, shot.picture, None, (LARGER * 200, LARGER * 150)) for shot in SHOTS]
    strokes = {SHOTS[0].name: strokes_on(SHOTS[0])}
    drawn = {
        name: type(one)(
            type(one.crown)(LARGER * one.crown.points),
            tuple(type(one.crown)(LARGER * branch.points) for branch in one.branches),
        )
        for name, one in strokes.items()
    }
    return read_capture(photos, structure_of(SHOTS), CaptureStrokes(drawn))


@cache
def traced(height: float = HEIGHT, grow: bool = False) -> dict[str, Any]:
    """Trace the walk; a tree that is to grow is given a limb, since its crown shows none."""
    edits = [limb()] if grow else []
    return trace_capture(reading(), edits, ModelSettings(height=height, iterations=3), grow)


def limb() -> BranchEdit:
    """Add a branch from the top of the trunk into the crown."""
    skeleton, back = reading().evidence.seen.skeleton, reading().evidence.frame.inverse
    share = reading().evidence.height_m / HEIGHT
    line = np.array([skeleton.points[-1], share * np.array([0.0, 2.5, 0.0]), share * np.array([0.3, 3.8, 0.2])])
    placed = back.points(line)
    return Add(placed[0], placed[1:])


def in_tree(found: dict[str, Any], points: Any) -> np.ndarray:
    """Carry points of the capture's frame to the tree's."""
    matrix = np.array(found["tree_from_capture"])
    return np.asarray(np.array(points) @ matrix[:, :3].T + matrix[:, 3])


def test_each_photo_has_rings_around_its_tree_in_its_own_pixels() -> None:
    assert [photo["photo"] for photo in traced()["photos"]] == NAMES
    for shot, photo in zip(SHOTS, traced()["photos"], strict=True):
        mask = np.zeros((LARGER * 150, LARGER * 200), np.uint8)
        cv2.fillPoly(mask, [np.rint(ring).astype(np.int32) for ring in photo["foliage"]], 1)
        tree = cv2.resize(np.logical_or(*cover(shot.camera)).astype(np.uint8), mask.shape[::-1])
        assert (mask & tree).sum() / (mask | tree).sum() > 0.7


def test_branches_and_crown_stay_where_they_are_whatever_the_height() -> None:
    low, high = traced(HEIGHT), traced(3 * HEIGHT)
    assert low["photos"] == high["photos"]
    assert low["crown"] == high["crown"]
    assert np.allclose(low["skeleton"]["points"], high["skeleton"]["points"], atol=1e-4)
    assert np.allclose(low["skeleton"]["radii"], high["skeleton"]["radii"], atol=1e-4)
    assert np.allclose(3 * np.array(low["tree_from_capture"]), high["tree_from_capture"])


def test_the_tree_stands_on_the_origin_of_its_own_frame() -> None:
    found = traced()
    skeleton, crown = found["skeleton"], found["crown"]
    assert len({len(skeleton[name]) for name in ("points", "radii", "parents", "seen")}) == 1
    assert in_tree(found, skeleton["points"])[0] == pytest.approx([0, 0, 0], abs=0.01)
    surface = in_tree(found, crown["points"])
    assert surface[:, 1].max() == pytest.approx(HEIGHT, rel=0.1)
    assert np.abs(surface[:, 0]).max() == pytest.approx(1.5, abs=0.4)
    assert 100 < len(crown["triangles"]) <= MOST_TRIANGLES
    assert len(crown["guessed"]) == len(crown["points"])


def test_the_whole_tree_grows_in_metres() -> None:
    assert "grown" not in traced()
    low, high = traced(HEIGHT, True), traced(3 * HEIGHT, True)
    heights = [np.array(found["grown"]["points"])[:, 1].max() for found in (low, high)]
    assert heights[0] == pytest.approx(HEIGHT, rel=0.2)
    assert heights[1] == pytest.approx(3 * heights[0], rel=0.15)
    assert len(low["grown"]["points"]) > len(low["skeleton"]["points"])
    assert low["skeleton"]["points"] == high["skeleton"]["points"]
    assert low["photo"] == low["grown"]["photo"]


def test_edits_change_the_branches_and_those_that_are_lost_are_told() -> None:
    points = np.array(traced()["skeleton"]["points"])
    edits: list[BranchEdit] = [Remove(points[-1]), Remove(points[-1] + 99)]
    found = trace_capture(reading(), edits, ModelSettings(height=HEIGHT), False)
    assert len(found["skeleton"]["points"]) < len(points)
    assert [(one["code"], one["stroke"]) for one in found["warnings"] if one["code"] == "edit_lost"] == [
        ("edit_lost", "edits/1")
    ]
    assert traced()["photos"] == found["photos"]
