"""Sketches as pictures: a PNG in, the mask of its strokes and the outline of its crown out."""

import io
import struct
import warnings
import zlib
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from treestroke.codec.image import MAX_PIXELS, MAX_SIDE
from treestroke.core.errors import StrokesError
from treestroke.core.strokes import Sketch, Stroke
from treestroke.core.types import Floats, Mask, Picture
from treestroke.limits import MAX_SKETCH_BYTES

Binary = NDArray[np.uint8]
"""(h, w) of zeros and ones, as OpenCV takes masks."""

PNG = b"\x89PNG\r\n\x1a\n"
MIN_SIDE = 16
"""Least side of a sketch's picture, px."""
OPAQUE_ALPHA = 128
"""Alpha, 0 to 255, from which a pixel of a picture on transparent ground belongs to a stroke."""
LEAST_CONTRAST = 48
"""Least difference from the ground, of a channel's 255, of a stroke."""
RED, NOT_RED = 200, 80
"""A pixel belongs to the crown's line if red is above the first, and green and blue are below the second."""
REDDISH = 30
"""Excess of red, of a channel's 255, above which a pixel beside the crown's line is its smoothed edge."""
WORKED_SIDE = 1000
"""Long side, px, at which the crown's line is closed and filled."""
WIDEST_GAP = 0.04
"""Greatest gap in the crown's line that is closed, as a share of the long side."""
LEAST_RED = 0.05
"""Number of red pixels below which there is no crown, as a share of the long side."""
LEAST_HOLE = 0.003
"""Least area that a crown encloses, as a share of the picture's; also that of transparent ground."""
DIRECTIONS = 8
"""Directions in which strokes are continued below the crown's line."""
_DAMAGED = (OSError, SyntaxError, ValueError, EOFError, IndexError, KeyError, TypeError, struct.error, zlib.error)
"""Exceptions that Pillow's decoder raises for files that break the format."""


def read_picture(data: bytes) -> Sketch:
    """Read a PNG of strokes: opaque on transparent ground, or in any colour that contrasts with the ground.

    A closed line of pure red is the crown. The size is judged from the header, before any pixel is decoded.

    Raises
    ------
    StrokesError
        Not a PNG, damaged, too large or too small, nothing is drawn, or the red line is not closed.
    """
    pixels = _decoded(data)
    red = _red(pixels)
    ink = _ink(pixels, red)
    if not ink.any():
        fault = "the picture shows no strokes; draw dark or opaque strokes on light or transparent ground"
        raise StrokesError(fault, code="sketch_empty")
    crown = _crown(red)
    if crown is not None:
        ink = _with_gaps_bridged(ink, red)
    height, width = ink.shape
    return Sketch((width, height), crown, (), ink)


def without_metadata(data: bytes) -> bytes:
    """Re-encode a PNG of strokes with nothing but its pixels: `read_picture` returns the same for both.

    Raises
    ------
    StrokesError
        Not a PNG, damaged, too large or too small.
    """
    _, encoded = cv2.imencode(".png", cv2.cvtColor(_decoded(data), cv2.COLOR_RGBA2BGRA))
    if len(encoded) > MAX_SKETCH_BYTES:
        fault = f"the picture's pixels take more than {MAX_SKETCH_BYTES // 10**6} MB; save it smaller"
        raise StrokesError(fault, code="sketch_too_large_file")
    return encoded.tobytes()


def _decoded(data: bytes) -> Picture:
    """Decode a PNG to (h, w, 4) uint8 RGBA."""
    if len(data) > MAX_SKETCH_BYTES:
        fault = f"the picture has more than {MAX_SKETCH_BYTES // 10**6} MB; save it smaller"
        raise StrokesError(fault, code="sketch_too_large_file")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            image = Image.open(io.BytesIO(data), formats=("PNG",))
            _check_size(*image.size)
            return np.asarray(_eight_bits(image).convert("RGBA"))
    except Image.DecompressionBombError as error:
        fault = f"the picture has more than {MAX_PIXELS / 1e6:.0f} megapixels; save it smaller"
        raise StrokesError(fault, code="sketch_size") from error
    except _DAMAGED as error:
        brief = " ".join(str(error).split())[:80]
        fault = f"this is not a readable PNG ({brief}); save it again"
        raise StrokesError(fault, code="sketch_unreadable") from error


def _check_size(width: int, height: int) -> None:
    """Reject a picture of a width and height, px, that are out of bounds."""
    if not MIN_SIDE <= min(width, height) <= max(width, height) <= MAX_SIDE:
        fault = f"the picture is {width} x {height} px, each side must be {MIN_SIDE} to {MAX_SIDE} px; resize it"
        raise StrokesError(fault, code="sketch_size")
    if width * height > MAX_PIXELS:
        fault = f"the picture has {width * height / 1e6:.1f} megapixels, at most {MAX_PIXELS / 1e6:.0f} are allowed"
        raise StrokesError(f"{fault}; resize it", code="sketch_size")


def _eight_bits(image: Image.Image) -> Image.Image:
    """Reduce a picture of 16 bits a channel to 8."""
    if not image.mode.startswith("I"):
        return image
    deep = np.asarray(image)
    return Image.fromarray((np.clip(deep, 0, 65535) >> 8).astype(np.uint8))


def _red(pixels: Picture) -> Mask:
    """Mark the crown's line (h, w), without its smoothed edges."""
    r, g, b, a = (pixels[..., channel] for channel in range(4))
    return np.asarray((r > RED) & (g < NOT_RED) & (b < NOT_RED) & (a >= OPAQUE_ALPHA))


def _ink(pixels: Picture, red: Mask) -> Mask:
    """Mark the strokes (h, w), not the crown's line: opaque on transparent ground, else in contrast with the ground."""
    clear = pixels[..., 3] < OPAQUE_ALPHA
    ink = ~clear if np.count_nonzero(clear) > LEAST_HOLE * clear.size else _unlike_ground(pixels)
    if not red.any():
        return ink
    fringe = np.nonzero(cv2.dilate(red.astype(np.uint8), np.ones((5, 5), np.uint8)))
    r, g, b = pixels[fringe][:, :3].astype(np.int16).T
    ink = ink & ~red
    ink[fringe] &= r - np.maximum(g, b) <= REDDISH
    return ink


def _unlike_ground(pixels: Picture) -> Mask:
    """Mark the pixels (h, w) nearer to the strokes' median contrast than to the ground, the colour of most pixels."""
    height, width = pixels.shape[:2]
    sample = pixels[:: max(1, height // 512), :: max(1, width // 512), :3].reshape(-1, 3)
    ground = np.median(sample, axis=0).astype(np.uint8)
    channels = [np.maximum(pixels[..., c], ground[c]) - np.minimum(pixels[..., c], ground[c]) for c in range(3)]
    contrast = np.maximum(np.maximum(channels[0], channels[1]), channels[2])
    found = contrast[contrast >= LEAST_CONTRAST]
    least = max(LEAST_CONTRAST, float(np.median(found)) / 2) if len(found) else 256
    return np.asarray(contrast >= least)


def _crown(red: Mask) -> Stroke | None:
    """Return the crown's outline along the middle of the red line (h, w), or None without one."""
    height, width = red.shape
    if np.count_nonzero(red) < LEAST_RED * max(height, width):
        return None
    scale = min(1.0, WORKED_SIDE / max(height, width))
    size = max(1, round(width * scale)), max(1, round(height * scale))
    line = (cv2.resize(red.astype(np.uint8) * 255, size, interpolation=cv2.INTER_AREA) > 0).astype(np.uint8)
    half = float(np.percentile(cv2.distanceTransform(line, cv2.DIST_L2, 5)[line > 0], 90))
    widest = round(WIDEST_GAP * WORKED_SIDE / 2)
    line = np.pad(line, 2 * widest)
    for reach in (0, 1, 2, 4, 8, 14, widest):
        filled = _filled(line, reach)
        if np.count_nonzero(filled) - np.count_nonzero(_grown(line, reach)) > LEAST_HOLE * size[0] * size[1]:
            mended = cv2.morphologyEx(filled, cv2.MORPH_CLOSE, _disc(2 * reach)) if reach else filled
            return Stroke((_outline(np.asarray(mended, dtype=np.uint8), reach + half - 0.5) - 2 * widest) / scale)
    fault = "the red line is not closed; draw it once around the foliage, back to where it began"
    raise StrokesError.at(("crown",), fault, "crown_open")


def _disc(radius: float) -> Binary:
    """Return a disc of this radius, px."""
    size = 2 * round(radius) + 1
    return np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size)), dtype=np.uint8)


def _grown(line: Binary, reach: int) -> Binary:
    """Widen a line (h, w) by ``reach`` px."""
    return np.asarray(cv2.dilate(line, _disc(reach)) if reach else line, dtype=np.uint8)


def _filled(line: Binary, reach: int) -> Binary:
    """Fill the largest region that a line (h, w), widened by ``reach`` px, encloses."""
    contours, _ = cv2.findContours(_grown(line, reach), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    largest = max(contours, key=cv2.contourArea)
    return np.asarray(cv2.drawContours(np.zeros_like(line), [largest], -1, 1, thickness=cv2.FILLED), dtype=np.uint8)


def _outline(filled: Binary, less: float) -> Floats:
    """Outline (k, 2), px, of the largest filled region (h, w), after removing ``less`` px along its border."""
    inner = (cv2.distanceTransform(filled, cv2.DIST_L2, 5) > less).astype(np.uint8)
    contours, _ = cv2.findContours(inner, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    largest: Any = max(contours, key=cv2.contourArea)
    return np.asarray(cv2.approxPolyDP(largest, 0.7, closed=True)[:, 0], dtype=np.float64) + 0.5


def _with_gaps_bridged(ink: Mask, red: Mask) -> Mask:
    """Continue strokes (h, w) below the crown's line where they end on both sides of it."""
    zone = cv2.dilate(red.astype(np.uint8), np.ones((5, 5), np.uint8))
    wide = 2 * float(np.percentile(cv2.distanceTransform(zone, cv2.DIST_L2, 5)[zone > 0], 90))
    marks = ink.astype(np.uint8)
    closed = marks.copy()
    for angle in np.arange(DIRECTIONS) * np.pi / DIRECTIONS:
        bridge = cv2.morphologyEx(marks, cv2.MORPH_CLOSE, _needle(angle, 0.75 * wide + 2))
        closed = np.maximum(closed, np.asarray(bridge, dtype=np.uint8))
    return np.asarray((marks > 0) | ((closed > 0) & (zone > 0)))


def _needle(angle: float, half: float) -> Binary:
    """Draw a straight line at an angle, rad, through the middle of a square of about twice ``half`` px."""
    size = 2 * int(np.ceil(half)) + 1
    middle, offset = size // 2, half * np.array([np.cos(angle), np.sin(angle)])
    start, end = (tuple(int(v) for v in np.round(middle + sign * offset)) for sign in (-1, 1))
    return np.asarray(cv2.line(np.zeros((size, size), np.uint8), start, end, 1), dtype=np.uint8)
