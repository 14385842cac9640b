"""What runs in a tracing process: photos and drawings from outside, read where a crash costs nothing.

Each process remembers the photos that it saw last, with their foliage, so that one more stroke is answered at once.
"""

import json
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from treestroke.codec.image import decode_photo, decode_stored, encode_stored
from treestroke.codec.project import VIEWS
from treestroke.codec.sketch import parse_sketch, sketch_from
from treestroke.codec.strokes import parse_strokes, strokes_from
from treestroke.core.errors import PhotoError, TreestrokeError
from treestroke.core.pipeline.sides import draw_side
from treestroke.core.pipeline.sketching import read_sketches
from treestroke.core.stroke_rules import Place, mend_strokes
from treestroke.core.strokes import Sketch, StrokeWarning
from treestroke.core.types import Picture
from treestroke.service.bodies import check_keys, inside, read_object, take_rev_and_grow
from treestroke.service.sketch import trace_sketches
from treestroke.service.trace import Trace, trace
from treestroke.store.blobs import Blobs, read_blob

P = ParamSpec("P")
T = TypeVar("T")
_KEPT_PIXELS = 60_000_000
"""Of the photos that one process remembers."""


@dataclass
class Known:
    """A photo's pixels and its last trace."""

    picture: Picture
    last: Trace | None = None


_known: OrderedDict[Path, Known] = OrderedDict()


class NoRoom(Exception):
    """All photos together would take more than they may."""


def keep_photo(folder: Path, content: bytes, most: int, room: int) -> dict[str, Any]:
    """Decode an uploaded photo and store its upright pixels; give what its row says of them.

    Raises
    ------
    PhotoError
        As `decode_photo`; or it would take more than ``most`` bytes.
    NoRoom
        It would take more than ``room`` bytes.
    """
    mended: list[StrokeWarning] = []
    picture = decode_photo(content, "photo", warn=mended.append)
    stored = encode_stored(picture)
    if len(stored) > most:
        what = f"kept as PNG it takes {len(stored) / 1e6:.1f} MB, at most {most / 1e6:g} MB are allowed"
        raise PhotoError(f"photo: {what}; resize it", code="photo_too_large_stored")
    if len(stored) > room:
        raise NoRoom
    height, width, _ = picture.shape
    kept = {"blob": Blobs(folder).put(stored), "bytes": len(stored), "width": width, "height": height}
    return {**kept, "warnings": [asdict(warning) for warning in mended]}


def trace_answer(photo: Path, body: bytes, mended: Sequence[Mapping[str, str]] = ()) -> bytes:
    """Trace a stored photo by a request's body; give the answer as JSON.

    What was ``mended`` in the photo comes before the other warnings.

    Raises
    ------
    StrokesError
        The body is no such request, or its strokes cannot be used.
    """
    request = read_object(body)
    rev, grow = take_rev_and_grow(request)
    side = _within(("side",), sketch_from, request.pop("side")) if "side" in request else None
    known = _recall(photo)
    known.last = trace(known.picture, strokes_from(request), known.last, grow, side)
    answer = known.last.answer()
    return _answer(rev, {**answer, "warnings": [*mended, *answer["warnings"]]})


def sketch_answer(body: bytes) -> bytes:
    """Trace sketches by a request's body; give the answer as JSON.

    Raises
    ------
    TreestrokeError
        The body is no such request, or a sketch cannot be used.
    """
    request = read_object(body)
    rev, grow = take_rev_and_grow(request)
    check_keys(request, ("front",), ("side",))
    sketches = {view: _within((view,), sketch_from, value) for view, value in request.items()}
    return _answer(rev, trace_sketches(sketches["front"], sketches.get("side"), grow).answer())


def check_wish(photo: Path | None, parts: Mapping[str, bytes], within: Place = ()) -> None:
    """Check what was drawn, and against the photo what was drawn over it, so that what is accepted can be made.

    Raises
    ------
    StrokesError
        It cannot be used; the pointer leads into the request, whose sketches are ``within``.
    """
    picture = None if photo is None else _recall(photo).picture
    sketches = {view: parse_sketch(parts[view], view) for view in VIEWS if view in parts}
    if picture is not None and "strokes" in parts:
        height, width = picture.shape[:2]
        _within(("strokes",), mend_strokes, parse_strokes(parts["strokes"], "strokes"), width, height)
    _within(within, _draw_up, sketches, picture)


def _draw_up(sketches: Mapping[str, Sketch], picture: Picture | None) -> None:
    if "front" in sketches:
        read_sketches(sketches["front"], sketches.get("side"), picture)
    elif "side" in sketches:
        draw_side(sketches["side"], "side")


def _recall(photo: Path) -> Known:
    """Remember a photo, or read it, and forget those that were used longest ago."""
    known = _known.pop(photo, None) or Known(decode_stored(read_blob(photo)))
    _known[photo] = known
    while len(_known) > 1 and sum(one.picture.size // 3 for one in _known.values()) > _KEPT_PIXELS:
        _known.popitem(last=False)
    return known


def _answer(rev: int | None, answer: Mapping[str, Any]) -> bytes:
    return json.dumps({"rev": rev, **answer}, separators=(",", ":")).encode()


def _within(place: Place, read: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
    """Do what may refuse a part of a request; a refusal's pointer then leads from the whole request."""
    try:
        return read(*args, **kwargs)
    except TreestrokeError as error:
        raise inside(place, error) from error
