"""Strokes: JSON to values and back."""

import json
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from treestroke.codec.json_text import check_ascii, read_json
from treestroke.core.errors import StrokesError
from treestroke.core.stroke_rules import check_count
from treestroke.core.strokes import FrameStrokes, Length, Stroke, Strokes

if TYPE_CHECKING:
    from treestroke.wire_strokes import BranchStroke, CrownStroke, EraseStroke
    from treestroke.wire_strokes import FrameStrokes as DescribedFrameStrokes
    from treestroke.wire_strokes import Strokes as DescribedStrokes

T = TypeVar("T")


def parse_strokes(text: str | bytes, name: str) -> Strokes:
    """Return the strokes that JSON text describes; ``name`` appears in messages.

    Raises
    ------
    StrokesError
        It is not JSON, or not as `wire_strokes.Strokes` describes it: a wrong type, an unknown or missing key, NaN or
        infinity, too many or too few points, too many strokes. The message names the file and the stroke.
    """
    return _parsed(text, name, strokes_from)


def parse_frame_strokes(text: str | bytes, name: str) -> FrameStrokes:
    """Return the strokes over a frame of a clip that JSON text describes; ``name`` appears in messages.

    Raises
    ------
    StrokesError
        As `parse_strokes`; or the frame is no whole number from 0.
    """
    return _parsed(text, name, frame_strokes_from)


def _parsed(text: str | bytes, name: str, from_plain: Callable[[object], T]) -> T:
    data = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
    try:
        check_ascii(data, StrokesError)
        return from_plain(read_json(data, StrokesError, "the strokes are", "save them again"))
    except StrokesError as error:
        raise error.within(name) from error


def strokes_from(value: object) -> Strokes:
    """Return the strokes that plain mappings, lists and numbers describe.

    Raises
    ------
    StrokesError
        As `parse_strokes`.
    """
    from treestroke.codec.refusals import checked
    from treestroke.wire_strokes import Strokes as DescribedStrokes

    return strokes_of(checked(DescribedStrokes, value, StrokesError))


def frame_strokes_from(value: object) -> FrameStrokes:
    """Return the strokes over a frame of a clip that plain mappings, lists and numbers describe.

    Raises
    ------
    StrokesError
        As `parse_frame_strokes`.
    """
    from treestroke.codec.refusals import checked
    from treestroke.wire_strokes import FrameStrokes as DescribedFrameStrokes

    return frame_strokes_of(checked(DescribedFrameStrokes, value, StrokesError))


def frame_strokes_of(described: "DescribedFrameStrokes") -> FrameStrokes:
    """Return the value of strokes over a frame that were checked by their description.

    Raises
    ------
    StrokesError
        There are too many strokes.
    """
    return FrameStrokes(strokes_of(described), described.frame)


def strokes_of(described: "DescribedStrokes") -> Strokes:
    """Return the values of strokes that were checked by their description.

    Raises
    ------
    StrokesError
        There are too many strokes.
    """
    branches, erase, scale = described.branches, described.erase, described.scale
    check_count(1 + len(branches) + len(erase))
    return Strokes(
        crown=stroke_of(described.crown),
        branches=tuple(stroke_of(stroke) for stroke in branches),
        erase=tuple(stroke_of(stroke) for stroke in erase),
        scale=None if scale is None else Length(np.array(scale.points, dtype=np.float64), scale.metres),
    )


def stroke_of(described: "CrownStroke | BranchStroke | EraseStroke") -> Stroke:
    """Return the value of one stroke, its points (n, 2) in px; only a branch's may have a width, px."""
    return Stroke(np.array(described.points, dtype=np.float64), getattr(described, "width", None))


def encode_strokes(strokes: Strokes) -> str:
    """Return strokes as JSON that `parse_strokes` reads back."""
    return json.dumps(_plain(strokes))


def encode_frame_strokes(drawn: FrameStrokes) -> str:
    """Return strokes over a frame of a clip as JSON that `parse_frame_strokes` reads back."""
    return json.dumps({"frame": drawn.frame, **_plain(drawn.strokes)})


def plain_strokes(strokes: Strokes) -> dict[str, object]:
    """Return strokes, a scale apart, as plain mappings, lists and numbers."""
    return {
        "crown": plain_stroke(strokes.crown),
        "branches": [plain_stroke(stroke) for stroke in strokes.branches],
        "erase": [plain_stroke(stroke) for stroke in strokes.erase],
    }


def _plain(strokes: Strokes) -> dict[str, object]:
    scale = {} if strokes.scale is None else {"scale": plain_length(strokes.scale)}
    return {**plain_strokes(strokes), **scale}


def plain_length(length: Length) -> dict[str, object]:
    """Return a known length as plain lists and numbers."""
    return {"points": length.points.tolist(), "metres": length.metres}


def plain_stroke(stroke: Stroke) -> dict[str, object]:
    """Return one stroke as plain mappings, lists and numbers."""
    width = {} if stroke.width is None else {"width": stroke.width}
    return {"points": stroke.points.tolist(), **width}
