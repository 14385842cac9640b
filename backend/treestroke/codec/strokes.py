"""Strokes: JSON in and out."""

import json
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any, NoReturn

import numpy as np

from treestroke.core.errors import StrokesError
from treestroke.core.stroke_rules import MAX_POINTS, MAX_STROKES
from treestroke.core.strokes import Stroke, Strokes


def parse_strokes(text: str | bytes, name: str) -> Strokes:
    """Read strokes from JSON text; ``name`` appears in messages.

    Raises
    ------
    StrokesError
        No JSON, a wrong type, an unknown or missing key, NaN or infinity, too many strokes or points; the message
        names the file and the stroke.
    """
    try:
        decoded = text.decode("utf-8-sig") if isinstance(text, bytes) else text
        value = json.loads(decoded, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise StrokesError(f"{name}: the strokes are no valid JSON ({error}); save them anew") from error
    try:
        return strokes_from(value)
    except StrokesError as error:
        raise StrokesError(f"{name}: {error}") from error


def strokes_from(value: object) -> Strokes:
    """Read strokes from plain mappings, lists and numbers, of the JSON form.

    Raises
    ------
    StrokesError
        As `parse_strokes`.
    """
    table = _table(value, "strokes", ("crown", "branches", "erase"))
    if "crown" not in table:
        raise StrokesError("crown: it is missing; draw one stroke around the foliage")
    branches, erase = (_list(table.get(key, []), key) for key in ("branches", "erase"))
    count = 1 + len(branches) + len(erase)
    if count > MAX_STROKES:
        raise StrokesError(f"strokes: there are {count}, at most {MAX_STROKES} are allowed; leave some out")
    return Strokes(
        crown=_stroke(table["crown"], "crown", ("points",)),
        branches=tuple(_stroke(one, f"branches/{i}", ("points", "width")) for i, one in enumerate(branches)),
        erase=tuple(_stroke(one, f"erase/{i}", ("points",)) for i, one in enumerate(erase)),
    )


def encode_strokes(strokes: Strokes) -> str:
    """Write strokes as JSON that `parse_strokes` reads back."""
    value = {
        "crown": _plain(strokes.crown),
        "branches": [_plain(stroke) for stroke in strokes.branches],
        "erase": [_plain(stroke) for stroke in strokes.erase],
    }
    return json.dumps(value)


def _plain(stroke: Stroke) -> dict[str, object]:
    width = {} if stroke.width is None else {"width": stroke.width}
    return {"points": stroke.points.tolist(), **width}


def _refuse_constant(token: str) -> NoReturn:
    raise ValueError(f"{token} is no number")


def _table(value: object, pointer: str, known: Sequence[str]) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise StrokesError(f"{pointer}: it must be an object with {', '.join(known)}, not {_kind(value)}")
    for key in value:
        if key not in known:
            raise StrokesError(f"{pointer}: the key {key!r} is unknown; allowed are {', '.join(known)}")
    return value


def _list(value: object, pointer: str) -> Sequence[Any]:
    if not isinstance(value, list | tuple):
        raise StrokesError(f"{pointer}: it must be a list, not {_kind(value)}")
    return value


def _stroke(value: object, pointer: str, known: Sequence[str]) -> Stroke:
    table = _table(value, pointer, known)
    if "points" not in table:
        raise StrokesError(f"{pointer}: it has no points; give [[x, y], ...]")
    points = _list(table["points"], f"{pointer}/points")
    if len(points) > MAX_POINTS:
        raise StrokesError(f"{pointer}: it has {len(points)} points, at most {MAX_POINTS} are allowed; thin them out")
    pairs = [_pair(one, f"{pointer}/points/{i}") for i, one in enumerate(points)]
    width = _number(table["width"], f"{pointer}/width") if "width" in table else None
    return Stroke(np.array(pairs, dtype=np.float64).reshape(-1, 2), width)


def _pair(value: object, pointer: str) -> tuple[float, float]:
    pair = _list(value, pointer)
    if len(pair) != 2:
        raise StrokesError(f"{pointer}: a point is a pair [x, y], not {len(pair)} values")
    return _number(pair[0], pointer), _number(pair[1], pointer)


def _number(value: object, pointer: str) -> float:
    if isinstance(value, bool) or not isinstance(value, Real):
        raise StrokesError(f"{pointer}: a number is needed, not {_kind(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = float("inf")
    if not np.isfinite(number):
        raise StrokesError(f"{pointer}: {number} is not finite; give pixels of the photo")
    return number


def _kind(value: object) -> str:
    names = {dict: "an object", list: "a list", str: "text", bool: "true or false", type(None): "null"}
    return names.get(type(value), "a number" if isinstance(value, Real) else type(value).__name__)
