"""Strokes over the photos of a capture: JSON to values and back."""

import json
from typing import TYPE_CHECKING

import numpy as np

from treestroke.codec.json_text import check_ascii, read_json
from treestroke.codec.strokes import plain_length, plain_strokes, stroke_of
from treestroke.core.errors import StrokesError
from treestroke.core.stroke_rules import check_count
from treestroke.core.strokes import CameraDistance, CaptureStrokes, Length, LengthInPhoto, Strokes

if TYPE_CHECKING:
    from treestroke.wire_strokes import CameraDistance as DescribedDistance
    from treestroke.wire_strokes import CaptureStrokes as DescribedStrokes
    from treestroke.wire_strokes import LengthInPhoto as DescribedLength


def parse_capture_strokes(text: str | bytes, name: str) -> CaptureStrokes:
    """Return the strokes over several photos that JSON text describes; ``name`` appears in messages.

    Raises
    ------
    StrokesError
        It is not JSON, not as `wire_strokes.CaptureStrokes` describes it, or names a photo twice.
    """
    data = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
    try:
        check_ascii(data, StrokesError)
        return capture_strokes_from(read_json(data, StrokesError, "the strokes are", "save them again"))
    except StrokesError as error:
        raise error.within(name) from error


def capture_strokes_from(value: object) -> CaptureStrokes:
    """Return the strokes over several photos that plain mappings, lists and numbers describe.

    Raises
    ------
    StrokesError
        As `parse_capture_strokes`.
    """
    from treestroke.codec.refusals import checked
    from treestroke.wire_strokes import CaptureStrokes as DescribedStrokes

    return capture_strokes_of(checked(DescribedStrokes, value, StrokesError))


def capture_strokes_of(described: "DescribedStrokes") -> CaptureStrokes:
    """Return the values of strokes that were checked by their description.

    Raises
    ------
    StrokesError
        There are too many strokes, or two views of one photo.
    """
    check_count(sum(1 + len(view.branches) + len(view.erase) for view in described.views))
    by_photo: dict[str, Strokes] = {}
    for index, view in enumerate(described.views):
        if view.photo in by_photo:
            fault = f"{view.photo} has strokes already; put all its strokes into one view"
            raise StrokesError.at(("views", index, "photo"), fault, "photo_twice")
        by_photo[view.photo] = Strokes(
            crown=stroke_of(view.crown),
            branches=tuple(stroke_of(stroke) for stroke in view.branches),
            erase=tuple(stroke_of(stroke) for stroke in view.erase),
        )
    return CaptureStrokes(by_photo, None if described.scale is None else _scale_of(described.scale))


def encode_capture_strokes(drawn: CaptureStrokes) -> str:
    """Return strokes over several photos as JSON that `parse_capture_strokes` reads back."""
    views = [{"photo": name, **plain_strokes(strokes)} for name, strokes in drawn.by_photo.items()]
    scale = {} if drawn.scale is None else {"scale": _plain_scale(drawn.scale)}
    return json.dumps({"views": views, **scale})


def _plain_scale(scale: LengthInPhoto | CameraDistance) -> dict[str, object]:
    if isinstance(scale, CameraDistance):
        return {"photos": list(scale.photos), "metres": scale.metres}
    return {"photo": scale.photo, **plain_length(scale.length)}


def _scale_of(described: "DescribedLength | DescribedDistance") -> LengthInPhoto | CameraDistance:
    from treestroke.wire_strokes import CameraDistance as DescribedDistance

    if isinstance(described, DescribedDistance):
        first, second = described.photos
        return CameraDistance((first, second), described.metres)
    return LengthInPhoto(described.photo, Length(np.array(described.points, dtype=np.float64), described.metres))
