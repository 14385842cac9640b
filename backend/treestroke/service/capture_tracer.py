"""Work of the process that traces captures: the photos of the last one, and what was read of them, are remembered.

It has a process of its own, since a reading takes many seconds: photos and sketches are traced meanwhile by others.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from treestroke.codec.branch_edits import edits_of
from treestroke.codec.capture_strokes import capture_strokes_of, encode_capture_strokes
from treestroke.codec.refusals import checked
from treestroke.codec.structure import decode_structure
from treestroke.core.capture import CapturedPhoto, Structure
from treestroke.core.errors import StrokesError
from treestroke.core.pipeline.captured_photos import TRACED_SIDE, reduced
from treestroke.core.pipeline.drawn_views import check_used, mend_views
from treestroke.core.pipeline.settings import settings_from
from treestroke.core.strokes import CaptureStrokes
from treestroke.service.loading import load_stored_capture
from treestroke.service.model_request import read_body
from treestroke.service.tracer import answer_of
from treestroke.store.objects import read_blob
from treestroke.wire_requests import CaptureTraceRequest

if TYPE_CHECKING:
    from treestroke.service.capture_trace import CaptureReading


class StoredPhoto(NamedTuple):
    """A stored photo of a capture: its name, its (width, height), px, and its file."""

    name: str
    size_px: tuple[int, int]
    path: Path


@dataclass(frozen=True, eq=False)
class _Solved:
    """A solved capture that is remembered: by which files, its photos, and its cameras."""

    key: tuple[Path, tuple[StoredPhoto, ...]]
    photos: tuple[CapturedPhoto, ...]
    structure: Structure


class _Known:
    """What the process remembers: one capture, and what was read of it for the strokes that were drawn last."""

    solved: _Solved | None = None
    drawn: str = ""
    reading: "CaptureReading | None" = None


def trace_answer(
    structure: Path, photos: Sequence[StoredPhoto], body: bytes, mended: Sequence[Mapping[str, Any]] = ()
) -> bytes:
    """Trace a solved capture by a request's body and return the answer as JSON.

    What was ``mended`` in the photos comes before the other warnings.

    Raises
    ------
    StrokesError, SettingsError, CaptureError
        The body is not such a request, or something in it cannot be used.
    """
    from treestroke.service.capture_trace import trace_capture  # with scipy, which the web process does not need

    request = checked(CaptureTraceRequest, read_body(body), StrokesError)
    settings = settings_from(request.settings.model_dump())
    reading = _read(structure, tuple(photos), capture_strokes_of(request))
    traced = trace_capture(reading, edits_of(request.edits), settings, request.grow)
    return answer_of(request.rev, {**traced, "warnings": [*mended, *traced["warnings"]]})


def _read(structure: Path, photos: tuple[StoredPhoto, ...], drawn: CaptureStrokes) -> "CaptureReading":
    """Return what the photos show, from memory where these strokes were the last to be drawn over them."""
    from treestroke.service.capture_trace import read_capture  # with scipy, which the web process does not need

    key, text = (structure, photos), encode_capture_strokes(drawn)
    solved = _Known.solved
    if solved is not None and solved.key == key and _Known.drawn == text and _Known.reading is not None:
        return _Known.reading
    mend_views(drawn, {photo.name: photo.size_px for photo in photos})  # faults are told at once
    if solved is None or solved.key != key:
        cameras = decode_structure(read_blob(structure))
        check_used(drawn, {photo.name for photo in cameras.photos})
        _Known.reading = _Known.solved = None  # never two captures in memory
        solved = _Known.solved = _Solved(key, tuple(_load(photo) for photo in photos), cameras)
    _Known.drawn, _Known.reading = text, None
    _Known.reading = read_capture(solved.photos, solved.structure, drawn)
    return _Known.reading


def _load(photo: StoredPhoto) -> CapturedPhoto:
    return reduced(load_stored_capture(photo.name, read_blob(photo.path)), TRACED_SIDE)
