"""Work of a tracing process: photos and requests from outside are read where a crash costs nothing.

Each process remembers the photos it saw last, with their foliage, so that one more stroke is answered at once.
"""

import hashlib
import json
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import cv2

from treestroke.codec.exif import exif_focal_px
from treestroke.codec.gltf.document import encode_picture
from treestroke.codec.image import decode_photo, decode_stored, encode_stored
from treestroke.codec.refusals import checked, inside
from treestroke.codec.sketch import sketch_of
from treestroke.codec.strokes import strokes_of
from treestroke.codec.structure import decode_structure
from treestroke.core.errors import PhotoError, StrokesError, TreestrokeError
from treestroke.core.film.judged import require_frame
from treestroke.core.pipeline.drawn_views import check_used, mend_views
from treestroke.core.pipeline.sides import draw_side
from treestroke.core.pipeline.sketching import read_sketches
from treestroke.core.stroke_rules import Place, mend_strokes
from treestroke.core.strokes import CaptureStrokes, FrameStrokes, Sketch, StrokeWarning
from treestroke.core.types import Picture
from treestroke.service.model_request import Drawing, read_body
from treestroke.service.trace import Trace, trace, trace_sketches
from treestroke.store.atomic_write import write_synced
from treestroke.store.objects import read_blob
from treestroke.wire_requests import SketchTraceRequest, TraceRequest

P = ParamSpec("P")
T = TypeVar("T")
_KEPT_PIXELS, _KEPT_PHOTOS = 60_000_000, 16
"""Most that one process remembers: pixels of all photos, and photos, each with a trace of up to 25 MB."""


@dataclass
class Known:
    """A photo's pixels (h, w, 3) uint8 and its last trace."""

    picture: Picture
    last: Trace | None = None


_known: OrderedDict[Path, Known] = OrderedDict()


class NoRoom(Exception):
    """All stored photos and clips together would take more bytes than they may."""


def read_photo(path: Path, content: bytes, most: int, room: int) -> dict[str, Any]:
    """Decode an uploaded photo, write its upright pixels to ``path``, and return the columns of its row.

    Raises
    ------
    PhotoError
        As `decode_photo`; or it would take more than ``most`` bytes.
    NoRoom
        It would take more than ``room`` bytes.
    OSError
        It cannot be written.
    """
    mended: list[StrokeWarning] = []
    picture = decode_photo(content, "photo", warn=mended.append)
    stored = encode_stored(picture)
    if len(stored) > most:
        fault = f"kept as PNG it takes {len(stored) / 1e6:.1f} MB, at most {most / 1e6:g} MB are allowed"
        raise PhotoError(f"photo: {fault}; resize it", code="photo_too_large_stored")
    if len(stored) > room:
        raise NoRoom
    write_synced(path, stored)
    height, width, _ = picture.shape
    blob = hashlib.sha256(stored).hexdigest()
    warnings = [asdict(warning) for warning in mended]
    return {"blob": blob, "bytes": len(stored), "width": width, "height": height, "warnings": warnings}


def read_capture_photo(path: Path, content: bytes, most: int, room: int) -> dict[str, Any]:
    """Read a photo of a capture as `read_photo` does, whose metadata also has the focal length."""
    return {**read_photo(path, content, most, room), "focal_length_px": exif_focal_px(content)}


def trace_answer(photo: Path, body: bytes, mended: Sequence[Mapping[str, str]] = ()) -> bytes:
    """Trace a stored photo by a request's body and return the answer as JSON.

    What was ``mended`` in the photo comes before the other warnings.

    Raises
    ------
    StrokesError, SettingsError
        The body is not such a request, or its strokes or a setting cannot be used.
    """
    request = checked(TraceRequest, read_body(body), StrokesError)
    strokes = strokes_of(request)
    side = None if request.side is None else _within(("side",), sketch_of, request.side)
    settings = request.settings.model_dump()
    known = _recall(photo)
    known.last = trace(known.picture, strokes, known.last, request.grow, side=side, settings=settings)
    answer = known.last.as_dict()
    return answer_of(request.rev, {**answer, "warnings": [*mended, *answer["warnings"]]})


def photo_jpeg(photo: Path, longest: int) -> bytes:
    """Return a stored photo as a JPEG whose sides have at most ``longest`` px."""
    picture = _recall(photo).picture
    scale = longest / max(picture.shape[:2])
    if scale < 1.0:
        size = round(picture.shape[1] * scale) or 1, round(picture.shape[0] * scale) or 1
        picture = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)  # type: ignore[assignment]
    return encode_picture(picture)[1]


def sketch_answer(body: bytes) -> bytes:
    """Trace sketches by a request's body and return the answer as JSON.

    Raises
    ------
    TreestrokeError
        The body is not such a request, or a sketch cannot be used.
    """
    request = checked(SketchTraceRequest, read_body(body), StrokesError)
    front = _within(("front",), sketch_of, request.front)
    side = None if request.side is None else _within(("side",), sketch_of, request.side)
    return answer_of(request.rev, trace_sketches(front, side, request.grow).as_dict())


def check_drawing(photo: Path | None, drawing: Drawing, within: Place = ()) -> None:
    """Check sketches, and strokes against the photo under them, so that every accepted model can be made.

    Raises
    ------
    StrokesError
        One cannot be used; the pointer leads into the request, whose sketches are ``within``.
    """
    picture = None if photo is None else _recall(photo).picture
    if picture is not None and drawing.strokes is not None:
        height, width = picture.shape[:2]
        _within(("strokes",), mend_strokes, drawing.strokes, width, height)
    _within(within, _check_sketches, drawing.sketches, picture)


def check_views(structure: Path, drawn: CaptureStrokes, sizes_px: Mapping[str, tuple[int, int]]) -> None:
    """Check strokes over a capture, whose photos have (width, height), so that every accepted model can be made.

    Raises
    ------
    StrokesError
        One cannot be used; the pointer leads into the request.
    """
    solved = decode_structure(read_blob(structure))
    _within(("views",), mend_views, drawn, sizes_px)
    _within(("views",), check_used, drawn, {photo.name for photo in solved.photos})


def check_frame(drawn: FrameStrokes, size_px: tuple[int, int], frames: int) -> None:
    """Check strokes over a clip, whose frames have (width, height), so that every accepted model can be made.

    Raises
    ------
    StrokesError, ClipError
        One cannot be used, or there is no such frame; the pointer leads into the request.
    """
    _within(("strokes",), require_frame, drawn.frame, frames)
    _within(("strokes",), mend_strokes, drawn.strokes, *size_px)


def _check_sketches(sketches: Mapping[str, Sketch], picture: Picture | None) -> None:
    if "front" in sketches:
        read_sketches(sketches["front"], sketches.get("side"), picture)
    elif "side" in sketches:
        draw_side(sketches["side"], "side")


def _recall(photo: Path) -> Known:
    """Return a photo from memory or disk; those used longest ago are forgotten."""
    known = _known.pop(photo, None) or Known(decode_stored(read_blob(photo)))
    _known[photo] = known
    while len(_known) > 1 and _too_much_is_known():
        _known.popitem(last=False)
    return known


def _too_much_is_known() -> bool:
    return len(_known) > _KEPT_PHOTOS or sum(one.picture.size // 3 for one in _known.values()) > _KEPT_PIXELS


def answer_of(rev: int | None, answer: Mapping[str, Any]) -> bytes:
    """Return an answer, and the number that its request had, as JSON."""
    return json.dumps({"rev": rev, **answer}, separators=(",", ":")).encode()


def _within(place: Place, read: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
    """Return what reading a part of a request returns; an error's pointer leads from the whole request."""
    try:
        return read(*args, **kwargs)
    except TreestrokeError as error:
        raise inside(place, error) from error
