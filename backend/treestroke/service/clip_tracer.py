"""Work of the processes that read and trace clips: the frames of the last one, and what was traced, are remembered.

They are processes of their own, since reading a clip takes many seconds: photos and sketches are traced by others.
"""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2

from treestroke.codec.inputs import BEGINNING
from treestroke.codec.refusals import checked
from treestroke.codec.strokes import frame_strokes_of
from treestroke.codec.video_kinds import MP4, video_kind
from treestroke.core.errors import StrokesError
from treestroke.core.film.judged import check_light, check_motion, cut_notes, cuts_of, require_frame
from treestroke.core.pipeline.settings import settings_from
from treestroke.core.stroke_rules import mend_strokes
from treestroke.core.strokes import FrameStrokes, same_stroke, same_strokes
from treestroke.core.types import Picture
from treestroke.core.video import Video
from treestroke.engines.decoding import Footage, read_footage, read_picture
from treestroke.engines.reel import Reel
from treestroke.service.clip_loading import check_clip, video_of
from treestroke.service.execution import one_thread
from treestroke.service.model_request import read_body
from treestroke.service.tracer import answer_of
from treestroke.wire_requests import ClipTraceRequest

if TYPE_CHECKING:
    from treestroke.core.pipeline.filming import ClipTrace

JPEG_QUALITY = 85


@dataclass
class _Read:
    """A clip that is remembered by its SHA-256: its frames, and what was traced on the frame that was drawn on last."""

    sha256: str
    footage: Footage
    video: Video | None = None
    drawn: FrameStrokes | None = None
    traced: "ClipTrace | None" = None


class _Known:
    """What the process remembers: one clip that was read, and one that frames were asked of."""

    read: _Read | None = None
    reel: tuple[str, Reel] | None = None


def look(path: Path, sha256: str) -> dict[str, Any]:
    """Read an uploaded clip and return the columns of its row.

    Raises
    ------
    ClipError
        It is no video that can be read, is too short or too dark, or nothing moves in it.
    """
    check_clip(path)
    footage = _footage(path, sha256)
    check_light(footage.frames)
    check_motion(footage.frames)
    notes = (*footage.notes, *cut_notes(cuts_of(footage.frames), footage.frames_per_second))
    width, height = footage.size_px
    with path.open("rb") as file:
        kind = video_kind(file.read(BEGINNING)) or MP4
    return {
        "width": width,
        "height": height,
        "frames": len(footage.frames),
        "frames_per_second": footage.frames_per_second,
        "media_type": kind.media_type,
        "warnings": [asdict(note) for note in notes],
    }


def frame_jpeg(path: Path, frame: int, height: int | None) -> bytes:
    """Return one frame of a stored clip as a JPEG, at most ``height`` px high.

    Raises
    ------
    ClipError
        There is no such frame.
    """
    picture = _picture(path, frame)
    if height is not None and height < picture.shape[0]:
        size = max(1, round(picture.shape[1] * height / picture.shape[0])), height
        picture = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)  # type: ignore[assignment]
    bgr = cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)
    return cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1].tobytes()


def trace_answer(path: Path, body: bytes) -> bytes:
    """Trace a stored clip by a request's body and return the answer as JSON.

    Raises
    ------
    StrokesError, SettingsError, ClipError
        The body is not such a request, or something in it cannot be used.
    """
    from treestroke.service.clip_trace import plain_trace  # with scipy, which the web process does not need

    request = checked(ClipTraceRequest, read_body(body), StrokesError)
    drawn, settings = frame_strokes_of(request), settings_from(request.settings.model_dump())
    read = _read(path, drawn)
    assert read.video is not None
    assert read.traced is not None
    answer = plain_trace(read.video, drawn, read.traced, settings if request.grow else None)
    return answer_of(request.rev, answer)


def _read(path: Path, drawn: FrameStrokes) -> _Read:
    """Return a clip with its trace, from memory where these strokes were the last to be drawn over it."""
    from treestroke.core.pipeline.filming import trace_clip  # with scipy, which the web process does not need

    footage = _footage(path, path.name)
    read = _Known.read
    assert read is not None
    require_frame(drawn.frame, len(footage.frames))
    mend_strokes(drawn.strokes, *footage.size_px)  # faults are told at once
    last = read.drawn
    if read.video is None or last is None or last.frame != drawn.frame:
        read.traced = read.drawn = None
        read.video = video_of(footage, drawn.frame, _picture(path, drawn.frame))
    elif not same_stroke(last.strokes.crown, drawn.strokes.crown):
        read.traced = None
    if read.traced is None or last is None or not same_strokes(last.strokes, drawn.strokes):
        with one_thread():
            read.traced = trace_clip(read.video, drawn.strokes, read.traced)
    read.drawn = drawn
    return read


def _footage(path: Path, sha256: str) -> Footage:
    if _Known.read is None or _Known.read.sha256 != sha256:
        _Known.read = None  # never two clips in memory
        _Known.read = _Read(sha256, read_footage(path))
    return _Known.read.footage


def _picture(path: Path, frame: int) -> Picture:
    """Return one frame (h, w, 3), sRGB; the file stays open, since the next one is often wanted next."""
    if _Known.reel is None or _Known.reel[0] != path.name:
        _Known.reel = path.name, Reel(path)
    return read_picture(_Known.reel[1], frame)
