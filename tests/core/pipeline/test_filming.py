from dataclasses import replace

import cv2
import numpy as np
import pytest
from tests import clips, swaying

from treestroke.core.errors import ClipError
from treestroke.core.pipeline.assumed_trunk import with_trunk
from treestroke.core.pipeline.filming import grow_clip, read_clip, trace_clip
from treestroke.core.pipeline.finishing import finish
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.strokes import Stroke, Strokes
from treestroke.core.video import Video

SETTINGS = ModelSettings(iterations=20)
CROWN = Stroke(np.array(clips.STROKES["crown"]["points"], dtype=np.float64))
STROKES = Strokes(CROWN, (Stroke(np.array(clips.STROKES["branches"][0]["points"], dtype=np.float64)),))


@pytest.fixture(scope="module")
def video() -> Video:
    frames = clips.swaying(48, px=4.0)
    grey = np.array([cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY) for frame in frames])
    return Video(grey, 30.0, 0, cv2.cvtColor(frames[0], cv2.COLOR_BGR2RGB), ())


def test_a_filmed_tree_has_an_animation_of_all_its_frames(video: Video) -> None:
    tree = grow_clip(read_clip(video, STROKES), SETTINGS, np.random.default_rng(0))
    model = finish(tree, SETTINGS, np.random.default_rng(0))
    motion = model.motion
    assert motion is not None
    assert motion.frames == len(video.frames)
    assert motion.loop_seconds > motion.frames / motion.frames_per_second
    assert motion.animation.bones
    assert len(motion.animation.times[0]) == round(motion.loop_seconds * motion.frames_per_second) + 1


def test_a_photo_has_no_motion(video: Video) -> None:
    tree = grow_clip(read_clip(video, STROKES), SETTINGS, np.random.default_rng(0))
    assert finish(replace(tree, filmed=None), SETTINGS, np.random.default_rng(0)).motion is None


def test_a_further_stroke_keeps_the_tracks(video: Video) -> None:
    first = trace_clip(video, STROKES)
    more = Strokes(CROWN, (*STROKES.branches, Stroke(np.array([[80.0, 80.0], [60.0, 50.0]]))))
    assert trace_clip(video, more, first).tracks is first.tracks


def test_a_plain_outline_is_refused(video: Video) -> None:
    plain = replace(video, frames=np.full_like(video.frames, 128))
    with pytest.raises(ClipError, match="no texture") as caught:
        read_clip(plain, STROKES)
    assert caught.value.code == "clip_plain"


def test_a_camera_that_moves_far_is_refused() -> None:
    frames = swaying.swaying(shake_px=45.0)
    shaken = Video(frames, 24.0, 0, np.repeat(frames[0][..., None], 3, axis=2), ())
    crown = Stroke(np.array([[50.0, 20.0], [150.0, 20.0], [150.0, 110.0], [50.0, 110.0]]))
    with pytest.raises(ClipError, match="the camera moves by") as caught:
        read_clip(shaken, Strokes(crown, (Stroke(np.array([[100.0, 140.0], [100.0, 80.0]])),)))
    assert caught.value.code == "clip_shaken"


def test_a_trunk_is_assumed_under_an_outline_without_one() -> None:
    photo = np.zeros((200, 300, 3), np.uint8)
    crown = Stroke(np.array([[100.0, 20.0], [200.0, 20.0], [200.0, 100.0], [100.0, 100.0]]))
    strokes, warnings = with_trunk(photo, Strokes(crown))
    assert [warning.code for warning in warnings] == ["trunk_assumed"]
    assert strokes.branches[0].points[0] == pytest.approx([150.0, 100.0 + 0.18 * 80.0])


def test_an_outline_around_the_trunk_shows_its_foot() -> None:
    photo = np.zeros((200, 300, 3), np.uint8)
    outline = [[100, 20], [200, 20], [200, 100], [156, 110], [154, 180], [146, 180], [144, 110], [100, 100]]
    strokes, _ = with_trunk(photo, Strokes(Stroke(np.array(outline, dtype=np.float64))))
    assert strokes.branches[0].points[0] == pytest.approx([150.0, 180.0], abs=1.0)


def test_a_trunk_that_was_drawn_stays() -> None:
    assert with_trunk(np.zeros((200, 300, 3), np.uint8), STROKES) == (STROKES, ())
