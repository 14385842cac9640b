"""Sketches: JSON strokes or a PNG of them in, JSON out."""

import base64
import binascii
import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from treestroke.codec.json_text import read_json
from treestroke.codec.sketch_picture import MAX_SKETCH_BYTES, PNG, read_picture
from treestroke.codec.strokes import check_extent, check_plain, kind_of, list_of, plain_stroke, stroke_of, table_of
from treestroke.core.errors import StrokesError
from treestroke.core.stroke_rules import check_count
from treestroke.core.strokes import Sketch, Stroke

MIN_CANVAS, MAX_CANVAS = 16, 16_384
"""Px, of a side."""
MARGIN = 0.05
"""Of the strokes' box: room around them where no canvas is given."""


def parse_sketch(data: bytes, name: str) -> Sketch:
    """Read a sketch: a PNG (known by its first bytes), else JSON; ``name`` appears in messages.

    Raises
    ------
    StrokesError
        No JSON, a wrong type, an unknown key, NaN or infinity, too many strokes or points; a picture that is damaged,
        too large or empty. The message names the file and the stroke.
    """
    try:
        if data.startswith(PNG):
            return read_picture(data)
        check_extent(data)
        check_plain(data)
        return sketch_from(read_json(data, StrokesError, "the sketch is neither PNG nor JSON:", "save it anew"))
    except StrokesError as error:
        raise error.within(name) from error


def sketch_from(value: object) -> Sketch:
    """Read a sketch from plain mappings, lists and numbers: strokes, or a ``picture``, a PNG in base 64.

    Strokes are `crown` (may be absent), `branches` and `canvas` [width, height], px; without a canvas it is as large as
    the strokes ask for.

    Raises
    ------
    StrokesError
        As `parse_sketch`.
    """
    if isinstance(value, dict) and "picture" in value:
        return _pictured(table_of(value, (), ("picture",))["picture"])
    table = table_of(value, (), ("crown", "branches", "canvas"))
    branches = list_of(table.get("branches", []), ("branches",))
    check_count(1 + len(branches))
    crown = stroke_of(table["crown"], ("crown",), ("points",)) if table.get("crown") is not None else None
    strokes = tuple(stroke_of(one, ("branches", i), ("points", "width")) for i, one in enumerate(branches))
    if not strokes:
        what = "there is none; draw one stroke from the tree's root up its trunk"
        raise StrokesError.at(("branches",), what, "trunk_missing")
    given = table.get("canvas")
    canvas = _around(strokes if crown is None else (crown, *strokes)) if given is None else _canvas(given)
    return Sketch(canvas, crown, strokes)


def encode_sketch(sketch: Sketch) -> bytes:
    """Write a sketch of lines as JSON that `parse_sketch` reads back.

    Raises
    ------
    ValueError
        It is a picture.
    """
    if sketch.ink is not None:
        raise ValueError("a sketch that is a picture has no lines to write")
    crown = {} if sketch.crown is None else {"crown": plain_stroke(sketch.crown)}
    branches = [plain_stroke(stroke) for stroke in sketch.branches]
    return json.dumps({"canvas": list(sketch.canvas), **crown, "branches": branches}).encode()


def _pictured(value: object) -> Sketch:
    if not isinstance(value, str):
        raise StrokesError.at(("picture",), f"it must be a PNG in base 64, not {kind_of(value)}", "wrong_type")
    if len(value) > MAX_SKETCH_BYTES * 4 // 3 + 4:
        what = f"the picture has more than {MAX_SKETCH_BYTES // 10**6} MB; save it smaller"
        raise StrokesError.at(("picture",), what, "sketch_too_large_file")
    try:
        data = base64.b64decode(value, validate=True)
    except (ValueError, binascii.Error) as error:
        what = f"it is no base 64 ({error}); send a PNG file encoded so"
        raise StrokesError.at(("picture",), what, "sketch_unreadable") from error
    try:
        return read_picture(data)
    except StrokesError as error:
        raise StrokesError(f"picture: {error}", code=error.code, pointer="/picture") from error


def _canvas(value: object) -> tuple[int, int]:
    sides: Sequence[Any] = list_of(value, ("canvas",))
    whole = all(isinstance(side, int) and not isinstance(side, bool) for side in sides)
    if len(sides) != 2 or not whole or not all(MIN_CANVAS <= side <= MAX_CANVAS for side in sides):
        what = f"it must be [width, height], whole numbers from {MIN_CANVAS} to {MAX_CANVAS}"
        raise StrokesError.at(("canvas",), f"{what}; give the size, px, of what was drawn on", "canvas_invalid")
    return int(sides[0]), int(sides[1])


def _around(strokes: Sequence[Stroke]) -> tuple[int, int]:
    """Give the canvas on which strokes have some room."""
    points = np.concatenate([stroke.points for stroke in strokes])
    if not len(points):
        points = np.zeros((1, 2))
    low, high = points.min(axis=0), points.max(axis=0)
    far = high + MARGIN * (high - low)
    return _side(float(far[0])), _side(float(far[1]))


def _side(far: float) -> int:
    if far > MAX_CANVAS:
        what = f"strokes reach to {far:.0f} px, at most {MAX_CANVAS} px are allowed; draw smaller"
        raise StrokesError.at(("branches",), what, "canvas_invalid")
    return max(MIN_CANVAS, math.ceil(far))
