"""Strokes: JSON in and out."""

import json
import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np

from treestroke.codec.json_text import read_json
from treestroke.core.errors import StrokesError, shown
from treestroke.core.stroke_rules import MAX_POINTS, Place, check_count
from treestroke.core.strokes import Length, Stroke, Strokes


def parse_strokes(text: str | bytes, name: str) -> Strokes:
    """Read strokes from JSON text; ``name`` appears in messages.

    Raises
    ------
    StrokesError
        No JSON, a wrong type, an unknown or missing key, NaN or infinity, too many strokes or points; the message
        names the file and the stroke.
    """
    value = read_json(text, StrokesError, f"{name}: the strokes are", "save them anew")
    try:
        return strokes_from(value)
    except StrokesError as error:
        raise error.within(name) from error


def strokes_from(value: object) -> Strokes:
    """Read strokes from plain mappings, lists and numbers, of the JSON form.

    Raises
    ------
    StrokesError
        As `parse_strokes`.
    """
    table = _table(value, (), ("crown", "branches", "erase", "scale"))
    if "crown" not in table:
        raise StrokesError.at(("crown",), "it is missing; draw one stroke around the foliage", "crown_missing")
    branches, erase = (_list(table.get(key, []), (key,)) for key in ("branches", "erase"))
    check_count(1 + len(branches) + len(erase))
    return Strokes(
        crown=_stroke(table["crown"], ("crown",), ("points",)),
        branches=tuple(_stroke(one, ("branches", i), ("points", "width")) for i, one in enumerate(branches)),
        erase=tuple(_stroke(one, ("erase", i), ("points",)) for i, one in enumerate(erase)),
        scale=_length(table["scale"]) if "scale" in table else None,
    )


def encode_strokes(strokes: Strokes) -> str:
    """Write strokes as JSON that `parse_strokes` reads back."""
    value: dict[str, object] = {
        "crown": _plain(strokes.crown),
        "branches": [_plain(stroke) for stroke in strokes.branches],
        "erase": [_plain(stroke) for stroke in strokes.erase],
    }
    if strokes.scale is not None:
        value["scale"] = {"points": strokes.scale.points.tolist(), "metres": strokes.scale.metres}
    return json.dumps(value)


def _plain(stroke: Stroke) -> dict[str, object]:
    width = {} if stroke.width is None else {"width": stroke.width}
    return {"points": stroke.points.tolist(), **width}


def _table(value: object, place: Place, known: Sequence[str]) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        what = f"it must be an object with {', '.join(known)}, not {_kind(value)}"
        raise StrokesError.at(place, what, "wrong_type")
    for key in value:
        if key not in known:
            what = f"the key {shown(key)} is unknown; allowed are {', '.join(known)}"
            raise StrokesError.at(place, what, "unknown_key", key=str(key))
    return value


def _list(value: object, place: Place) -> Sequence[Any]:
    if not isinstance(value, list | tuple):
        raise StrokesError.at(place, f"it must be a list, not {_kind(value)}", "wrong_type")
    return value


def _stroke(value: object, place: Place, known: Sequence[str]) -> Stroke:
    table = _table(value, place, known)
    if "points" not in table:
        raise StrokesError.at(place, "it has no points; give [[x, y], ...]", "missing_key")
    points = _list(table["points"], (*place, "points"))
    if len(points) > MAX_POINTS:
        what = f"it has {len(points)} points, at most {MAX_POINTS} are allowed; thin them out"
        raise StrokesError.at(place, what, "too_many_points")
    pairs = [_pair(one, (*place, "points", i)) for i, one in enumerate(points)]
    width = _number(table["width"], (*place, "width")) if "width" in table else None
    return Stroke(np.array(pairs, dtype=np.float64).reshape(-1, 2), width)


def _length(value: object) -> Length:
    place: Place = ("scale",)
    table = _table(value, place, ("points", "metres"))
    if "metres" not in table:
        raise StrokesError.at(place, "it has no metres; give the line's length", "missing_key")
    metres = _number(table["metres"], (*place, "metres"))
    return Length(_stroke({"points": table.get("points", [])}, place, ("points",)).points, metres)


def _pair(value: object, place: Place) -> tuple[float, float]:
    pair = _list(value, place)
    if len(pair) != 2:
        raise StrokesError.at(place, f"a point is a pair [x, y], not {len(pair)} values", "wrong_type")
    return _number(pair[0], place), _number(pair[1], place)


def _number(value: object, place: Place) -> float:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise StrokesError.at(place, f"a number is needed, not {_kind(value)}", "wrong_type")
    try:
        number = float(value)
    except OverflowError:
        number = float("inf")
    if not math.isfinite(number):
        what = f"{json.dumps(number)} is not finite; give pixels of the photo"
        raise StrokesError.at(place, what, "non_finite_number")
    return number


def _kind(value: object) -> str:
    names = {dict: "an object", list: "a list", str: "text", bool: "true or false", type(None): "null"}
    return names.get(type(value), "a number" if isinstance(value, Real) else type(value).__name__)
