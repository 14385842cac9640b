"""Sketches: JSON strokes or a PNG of them to values, and back to JSON."""

import base64
import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from treestroke.codec.json_text import check_ascii, read_json
from treestroke.codec.sketch_picture import PNG, read_picture
from treestroke.codec.strokes import plain_stroke, stroke_of
from treestroke.core.errors import StrokesError
from treestroke.core.stroke_rules import check_count
from treestroke.core.strokes import Sketch, Stroke
from treestroke.limits import MAX_CANVAS, MIN_CANVAS

if TYPE_CHECKING:
    from treestroke.wire_strokes import PictureSketch
    from treestroke.wire_strokes import Sketch as DescribedSketch

MARGIN = 0.05
"""Room around the strokes where no canvas is given, as a share of their box."""


def parse_sketch(data: bytes, name: str) -> Sketch:
    """Return the sketch that a PNG (known by its first bytes) or else JSON describes; ``name`` appears in messages.

    Raises
    ------
    StrokesError
        It is not JSON, or not as `wire_strokes.Sketch` describes it; a picture that is damaged, too large or empty.
        The message names the file and the stroke.
    """
    try:
        if data.startswith(PNG):
            return read_picture(data)
        check_ascii(data, StrokesError)
        return sketch_from(read_json(data, StrokesError, "the sketch is neither PNG nor JSON:", "save it again"))
    except StrokesError as error:
        raise error.within(name) from error


def sketch_from(value: object) -> Sketch:
    """Return the sketch that plain mappings, lists and numbers describe.

    Raises
    ------
    StrokesError
        As `parse_sketch`.
    """
    from treestroke.codec.refusals import checked
    from treestroke.wire_strokes import Sketch as DescribedSketch

    return sketch_of(checked(DescribedSketch, value, StrokesError))


def sketch_of(described: "DescribedSketch") -> Sketch:
    """Return the value of a sketch that was checked by its description; without a canvas it fits what was drawn.

    Raises
    ------
    StrokesError
        Its picture cannot be read; there are too many strokes; they reach further than any canvas.
    """
    from treestroke.wire_strokes import PictureSketch

    drawn = described.root
    if isinstance(drawn, PictureSketch):
        return picture_of(drawn)[1]
    check_count(1 + len(drawn.branches))
    crown = None if drawn.crown is None else stroke_of(drawn.crown)
    strokes = tuple(stroke_of(stroke) for stroke in drawn.branches)
    canvas = drawn.canvas or _around(strokes if crown is None else (crown, *strokes))
    return Sketch(canvas, crown, strokes)


def picture_of(described: "PictureSketch") -> tuple[bytes, Sketch]:
    """Return a sketch's PNG, decoded from base64, and its value.

    Raises
    ------
    StrokesError
        It is not base64, or the picture cannot be read.
    """
    try:
        data = base64.b64decode(described.picture, validate=True)
    except ValueError as error:
        fault = f"it is not base64 ({error}); send a PNG file in base64"
        raise StrokesError.at(("picture",), fault, "sketch_unreadable") from error
    try:
        return data, read_picture(data)
    except StrokesError as error:
        raise StrokesError(f"picture: {error}", code=error.code, pointer="/picture") from error


def encode_sketch(sketch: Sketch) -> bytes:
    """Return a sketch of lines as JSON that `parse_sketch` reads back.

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


def _around(strokes: Sequence[Stroke]) -> tuple[int, int]:
    """Return the canvas (width, height), px, that leaves some room around strokes."""
    points = np.concatenate([stroke.points for stroke in strokes])
    low, high = points.min(axis=0), points.max(axis=0)
    far = high + MARGIN * (high - low)
    return _side(float(far[0])), _side(float(far[1]))


def _side(far: float) -> int:
    if far > MAX_CANVAS:
        fault = f"strokes reach to {far:.0f} px, at most {MAX_CANVAS} px are allowed; draw smaller"
        raise StrokesError.at(("branches",), fault, "canvas_invalid")
    return max(MIN_CANVAS, math.ceil(far))
