"""Strokes: JSON in and out."""

import json
import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np

from treestroke.codec.json_text import read_json
from treestroke.core.errors import StrokesError, shown
from treestroke.core.stroke_rules import MAX_POINTS, MAX_STROKES, Place, check_count
from treestroke.core.strokes import Length, Stroke, Strokes

_MOST_SIGNS = {b"[": 1.1 * MAX_STROKES * MAX_POINTS, b"{": 1000 * MAX_STROKES, b",": 2.2 * MAX_STROKES * MAX_POINTS}
"""What the longest strokes need, and some for names and unknown keys, which are told from them later."""
_MOST_WIDE_BYTES = 1_000_000
"""Of text with signs that are no ASCII, each of which may make all of it four times as large in memory."""


def parse_strokes(text: str | bytes, name: str) -> Strokes:
    """Read strokes from JSON text; ``name`` appears in messages.

    Raises
    ------
    StrokesError
        No JSON, a wrong type, an unknown or missing key, NaN or infinity, too many strokes or points; the message
        names the file and the stroke.
    """
    try:
        data = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
        check_extent(data)
        check_plain(data)
        return strokes_from(read_json(data, StrokesError, "the strokes are", "save them anew"))
    except StrokesError as error:
        raise error.within(name) from error


def strokes_from(value: object) -> Strokes:
    """Read strokes from plain mappings, lists and numbers, of the JSON form.

    Raises
    ------
    StrokesError
        As `parse_strokes`.
    """
    table = table_of(value, (), ("crown", "branches", "erase", "scale"))
    if "crown" not in table:
        raise StrokesError.at(("crown",), "it is missing; draw one stroke around the foliage", "crown_missing")
    branches, erase = (list_of(table.get(key, []), (key,)) for key in ("branches", "erase"))
    check_count(1 + len(branches) + len(erase))
    return Strokes(
        crown=stroke_of(table["crown"], ("crown",), ("points",)),
        branches=tuple(stroke_of(one, ("branches", i), ("points", "width")) for i, one in enumerate(branches)),
        erase=tuple(stroke_of(one, ("erase", i), ("points",)) for i, one in enumerate(erase)),
        scale=_length(table["scale"]) if "scale" in table else None,
    )


def encode_strokes(strokes: Strokes) -> str:
    """Write strokes as JSON that `parse_strokes` reads back."""
    value: dict[str, object] = {
        "crown": plain_stroke(strokes.crown),
        "branches": [plain_stroke(stroke) for stroke in strokes.branches],
        "erase": [plain_stroke(stroke) for stroke in strokes.erase],
    }
    if strokes.scale is not None:
        value["scale"] = {"points": strokes.scale.points.tolist(), "metres": strokes.scale.metres}
    return json.dumps(value)


def plain_stroke(stroke: Stroke) -> dict[str, object]:
    """Give one stroke as plain mappings, lists and numbers."""
    width = {} if stroke.width is None else {"width": stroke.width}
    return {"points": stroke.points.tolist(), **width}


def check_extent(text: bytes) -> None:
    """Refuse JSON that holds more than the longest strokes need: to read it would take minutes and gigabytes.

    Raises
    ------
    StrokesError
        It does.
    """
    if any(text.count(sign) > most for sign, most in _MOST_SIGNS.items()):
        most = f"more than {MAX_STROKES} strokes of {MAX_POINTS} points need"
        raise StrokesError(f"it holds {most}; thin them out", code="too_many_points")


def check_plain(text: bytes) -> None:
    """Refuse long JSON of strokes with signs that strokes do not need.

    Raises
    ------
    StrokesError
        It is such.
    """
    if len(text) > _MOST_WIDE_BYTES and not text.isascii():
        raise StrokesError("strokes need no other signs than ASCII; leave them out", code="malformed_json")


def table_of(value: object, place: Place, known: Sequence[str]) -> Mapping[str, Any]:
    """Take a value for an object that has the known keys only.

    Raises
    ------
    StrokesError
        It is another type, or has another key; it names the place.
    """
    if not isinstance(value, Mapping):
        what = f"it must be an object with {', '.join(known)}, not {kind_of(value)}"
        raise StrokesError.at(place, what, "wrong_type")
    for key in value:
        if key not in known:
            what = f"the key {shown(key)} is unknown; allowed are {', '.join(known)}"
            raise StrokesError.at(place, what, "unknown_key", key=str(key))
    return value


def list_of(value: object, place: Place) -> Sequence[Any]:
    """Take a value for a list.

    Raises
    ------
    StrokesError
        It is another type; it names the place.
    """
    if not isinstance(value, list | tuple):
        raise StrokesError.at(place, f"it must be a list, not {kind_of(value)}", "wrong_type")
    return value


def stroke_of(value: object, place: Place, known: Sequence[str]) -> Stroke:
    """Take a value for a stroke: ``points`` and what else is known.

    Raises
    ------
    StrokesError
        It is none; it names the place.
    """
    table = table_of(value, place, known)
    if "points" not in table:
        raise StrokesError.at(place, "it has no points; give [[x, y], ...]", "missing_key")
    points = list_of(table["points"], (*place, "points"))
    if len(points) > MAX_POINTS:
        what = f"it has {len(points)} points, at most {MAX_POINTS} are allowed; thin them out"
        raise StrokesError.at(place, what, "too_many_points")
    pairs = [_pair(one, (*place, "points", i)) for i, one in enumerate(points)]
    width = _number(table["width"], (*place, "width")) if "width" in table else None
    return Stroke(np.array(pairs, dtype=np.float64).reshape(-1, 2), width)


def _length(value: object) -> Length:
    place: Place = ("scale",)
    table = table_of(value, place, ("points", "metres"))
    if "metres" not in table:
        raise StrokesError.at(place, "it has no metres; give the line's length", "missing_key")
    metres = _number(table["metres"], (*place, "metres"))
    return Length(stroke_of({"points": table.get("points", [])}, place, ("points",)).points, metres)


def _pair(value: object, place: Place) -> tuple[float, float]:
    pair = list_of(value, place)
    if len(pair) != 2:
        raise StrokesError.at(place, f"a point is a pair [x, y], not {len(pair)} values", "wrong_type")
    return _number(pair[0], place), _number(pair[1], place)


def _number(value: object, place: Place) -> float:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise StrokesError.at(place, f"a number is needed, not {kind_of(value)}", "wrong_type")
    try:
        number = float(value)
    except OverflowError:
        number = float("inf")
    if not math.isfinite(number):
        what = f"{json.dumps(number)} is not finite; give pixels of the photo"
        raise StrokesError.at(place, what, "non_finite_number")
    return number


def kind_of(value: object) -> str:
    """Call a value's type as a message does."""
    names = {dict: "an object", list: "a list", str: "text", bool: "true or false", type(None): "null"}
    return names.get(type(value), "a number" if isinstance(value, Real) else type(value).__name__)
