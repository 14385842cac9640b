"""Outlines that a sibling is to fill: a name, JSON, or a picture of a shape, to a value."""

import io
import json
import warnings
from collections.abc import Mapping
from typing import Any

import cv2
import numpy as np
from PIL import Image

from treestroke.codec.image import MAX_LEAF_SIDE, UNREADABLE
from treestroke.codec.inputs import PNG_BEGINNING
from treestroke.codec.json_text import read_json
from treestroke.core.errors import EnvelopeError, StrokesError
from treestroke.core.imaging.outline import fill_outline
from treestroke.core.siblings.outlines import SHAPES, Envelope
from treestroke.core.types import Floats, Mask

LEAST_SIDE = 16
"""Least side of a shape's picture, px."""
LEAST_SHARE, MOST_SHARE = 0.005, 0.98
"""Share of a picture that a shape may fill, and of the box around it that a drawn outline must enclose."""
_SIMPLER = 0.002
"""Distance, as a share of a shape's size, within which its outline is kept."""
_DARK = 128
"""Grey below which a pixel of an opaque picture is dark."""
_SIDE = 256
"""Px of the picture in which it is measured what an outline encloses."""


def parse_envelope(data: bytes, name: str) -> Envelope:
    """Return the outline in a file: JSON with ``points`` or strokes with a ``crown``, or a PNG of a shape.

    The largest dark, or opaque, shape of a picture counts; one that reaches its lower edge stands on the ground.
    ``name`` appears in messages.

    Raises
    ------
    EnvelopeError
        It is neither, or shows no shape.
    """
    if data.startswith(PNG_BEGINNING):
        return _from_picture(data, name)
    value = read_json(data, EnvelopeError, f"{name}: the outline is", "save it again as JSON or PNG")
    try:
        return envelope_from(value)
    except EnvelopeError as error:
        raise error.within(name) from error


def envelope_from(value: object) -> Envelope:
    """Return the outline that a name, or plain mappings, lists and numbers, describe.

    Raises
    ------
    EnvelopeError
        There is no such name, or the points enclose nothing.
    """
    if isinstance(value, str):
        if value not in SHAPES:
            raise EnvelopeError(f"there is no outline {value[:60]!r}; the outlines are {', '.join(SHAPES)}")
        return Envelope(SHAPES[value])
    crown = value.get("crown", value) if isinstance(value, Mapping) else value
    on_ground = isinstance(value, Mapping) and value.get("on_ground") is True
    points = _points(crown)
    box = points - points.min(axis=0)
    inside = fill_outline(box * (_SIDE / max(float(box.max()), 1e-9)), _SIDE, _SIDE)
    if not inside.mean() > LEAST_SHARE:
        raise EnvelopeError("the outline encloses next to nothing; draw it around a shape")
    return Envelope(points, on_ground)


def encode_envelope(envelope: Envelope) -> bytes:
    """Return an outline as JSON that `parse_envelope` reads back."""
    return json.dumps({"points": envelope.points.tolist(), "on_ground": envelope.on_ground}).encode()


def _points(crown: object) -> Floats:
    """Return the points (n, 2) of a line, checked as a crown's are."""
    from treestroke.codec.refusals import checked
    from treestroke.wire_strokes import CrownStroke

    wanted: Any = {"points": crown["points"]} if isinstance(crown, Mapping) and "points" in crown else crown
    try:
        return np.array(checked(CrownStroke, wanted, StrokesError).points, dtype=np.float64)
    except StrokesError as error:
        raise EnvelopeError(str(error), pointer=error.pointer) from error


def _from_picture(data: bytes, name: str) -> Envelope:
    """Return the outline of a picture's largest shape, px."""
    shape = _shape(_pixels(data, name))
    if not LEAST_SHARE <= shape.mean() <= MOST_SHARE:
        fault = "it shows no shape: one that is dark on a light ground, or opaque on a transparent one, is needed"
        raise EnvelopeError(f"{name}: {fault}")
    found, _ = cv2.findContours(np.pad(shape, 1).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    line = max(found, key=cv2.contourArea)
    points = cv2.approxPolyDP(line, _SIMPLER * max(shape.shape), True)[:, 0].astype(np.float64) - 0.5
    return Envelope(points, bool(shape[-1].any()))


def _pixels(data: bytes, name: str) -> np.ndarray[Any, np.dtype[np.uint8]]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            image = Image.open(io.BytesIO(data), formats=("PNG",))
            if not LEAST_SIDE <= min(image.size) <= max(image.size) <= MAX_LEAF_SIDE:
                size = f"it is {image.width} x {image.height} px, each side must be {LEAST_SIDE} to {MAX_LEAF_SIDE} px"
                raise EnvelopeError(f"{name}: {size}; resize it")
            return np.asarray(image.convert("RGBA"))
    except UNREADABLE as error:
        raise EnvelopeError(f"{name}: this is not a readable PNG; save the shape as PNG") from error


def _shape(picture: np.ndarray[Any, np.dtype[np.uint8]]) -> Mask:
    """Return the largest shape (h, w) of a picture: what is opaque, or else dark."""
    alpha = picture[..., 3]
    transparent = bool((alpha < _DARK).any())
    grey = cv2.cvtColor(picture[..., :3], cv2.COLOR_RGB2GRAY)
    marked = (alpha >= _DARK) if transparent else (grey < _DARK)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(marked.astype(np.uint8))
    if count < 2:
        return np.zeros(marked.shape, dtype=np.bool_)
    return np.asarray(labels == 1 + int(stats[1:, cv2.CC_STAT_AREA].argmax()))
