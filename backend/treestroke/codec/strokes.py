"""Strokes: JSON to values and back."""

import json
from typing import TYPE_CHECKING

import numpy as np

from treestroke.codec.json_text import check_ascii, read_json
from treestroke.core.errors import StrokesError
from treestroke.core.stroke_rules import check_count
from treestroke.core.strokes import Length, Stroke, Strokes

if TYPE_CHECKING:
    from treestroke.wire_strokes import BranchStroke, CrownStroke, EraseStroke
    from treestroke.wire_strokes import Strokes as DescribedStrokes


def parse_strokes(text: str | bytes, name: str) -> Strokes:
    """Return the strokes that JSON text describes; ``name`` appears in messages.

    Raises
    ------
    StrokesError
        It is not JSON, or not as `wire_strokes.Strokes` describes it: a wrong type, an unknown or missing key, NaN or
        infinity, too many or too few points, too many strokes. The message names the file and the stroke.
    """
    data = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
    try:
        check_ascii(data, StrokesError)
        return strokes_from(read_json(data, StrokesError, "the strokes are", "save them again"))
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
    value = plain_strokes(strokes)
    if strokes.scale is not None:
        value["scale"] = plain_length(strokes.scale)
    return json.dumps(value)


def plain_strokes(strokes: Strokes) -> dict[str, object]:
    """Return strokes, a scale apart, as plain mappings, lists and numbers."""
    return {
        "crown": plain_stroke(strokes.crown),
        "branches": [plain_stroke(stroke) for stroke in strokes.branches],
        "erase": [plain_stroke(stroke) for stroke in strokes.erase],
    }


def plain_length(length: Length) -> dict[str, object]:
    """Return a known length as plain lists and numbers."""
    return {"points": length.points.tolist(), "metres": length.metres}


def plain_stroke(stroke: Stroke) -> dict[str, object]:
    """Return one stroke as plain mappings, lists and numbers."""
    width = {} if stroke.width is None else {"width": stroke.width}
    return {"points": stroke.points.tolist(), **width}
