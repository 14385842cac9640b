"""JPEGs that end too soon: how much of their picture is missing.

A decoder makes up what is not there and says nothing. What it makes up depends on what follows the cut, though: of two
decodings, of the file with an end marker and of the file with noise and an end marker, the pixels that differ are those
that the file does not tell.
"""

import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from PIL import Image

VISIBLE = 32
"""Of 255: pixels that differ by less look alike. Lost refinement of a progressive JPEG stays below, lost blocks do not
(5 photos at qualities of 50 to 95)."""
_STRIP = 2_000_000
"""Pixels that are compared at a time."""
_MOST_SEGMENTS = 10_000
"""Of a file; the rest of one with more is left to the decoder."""
_MARKER = re.compile(rb"\xff[^\x00\xff\xd0-\xd7]")
"""A marker that is none of a restart; among coded pixels 0xff is followed by 0."""
_START_OF_SCAN, _END, _RESTART_INTERVAL, _NO_FRAMES = 0xDA, 0xD9, 0xDD, (0xC4, 0xC8, 0xCC)
_PROGRESSIVE = (0xC2, 0xC6, 0xCA, 0xCE)
_NOISE = hashlib.shake_256().digest(100_000).replace(b"\xff", b"")
_RESTARTED = 4096
"""Bytes of noise from one restart to the next."""


@dataclass(frozen=True)
class Ending:
    """Where the coded pixels of a JPEG end (ITU T.81, B).

    Attributes
    ----------
    body
        All that comes before the end marker of its first picture.
    marked
        Whether that marker is there.
    is_coarse
        Whether some passes over the picture, which bring its finer detail, are not there at all.
    restart
        Number of the next restart marker; None where there are none.
    """

    body: bytes
    marked: bool
    is_coarse: bool
    restart: int | None

    def completed(self) -> bytes:
        """Give the file with an end marker."""
        return self.body + b"\xff\xd9"

    def made_up(self) -> bytes:
        """Give the file with noise in the place of what is missing."""
        if self.restart is None:
            return self.body + _NOISE + b"\xff\xd9"
        pieces = [_NOISE[start : start + _RESTARTED] for start in range(0, len(_NOISE), _RESTARTED)]
        marked = (piece + bytes((0xFF, 0xD0 + (self.restart + at) % 8)) for at, piece in enumerate(pieces))
        return self.body + b"".join(marked) + b"\xff\xd9"


def ending_of(data: bytes) -> Ending:
    """Find where the coded pixels of a JPEG end."""
    awaited: set[tuple[int, int]] = set()
    is_progressive, restarts, start, end = False, False, 0, None
    for code, place, content in _segments(data):
        if 0xC0 <= code <= 0xCF and code not in _NO_FRAMES:
            is_progressive = code in _PROGRESSIVE
            awaited = {(component, at) for component in content[6::3] for at in range(64)}
        elif code == _RESTART_INTERVAL:
            restarts = any(content)
        elif code == _START_OF_SCAN:
            awaited -= _sent(content, is_progressive)
            start = place
        elif code == _END:
            end = place
    body = data[:end].rstrip(b"\xff")
    last = max(body.rfind(bytes((0xFF, 0xD0 + number)), start) for number in range(8)) if restarts else -1
    restart = (body[last + 1] - 0xD0 + 1) % 8 if last >= 0 else 0
    return Ending(body, end is not None, bool(awaited), restart if restarts else None)


def lost(told: Image.Image, made_up: Image.Image) -> tuple[float, int]:
    """Compare what a decoder makes of `Ending.completed` and of `Ending.made_up`.

    Gives the share of the pixels that the file does not tell, and the first row that has one (the height if none has).
    """
    width, height = told.size
    rows = max(1, _STRIP // width)
    count, first = 0, height
    for top in range(0, height, rows):
        box = (0, top, width, min(top + rows, height))
        apart = cv2.absdiff(np.asarray(told.crop(box)), np.asarray(made_up.crop(box)))
        missing = np.atleast_3d(apart).max(axis=2) > VISIBLE
        count += int(missing.sum())
        if first == height and missing.any():
            first = top + int(missing.any(axis=1).argmax())
    return count / (width * height), first


def ends_flat(image: Image.Image) -> bool:
    """Tell whether a picture's last block is of one colour, as one that is missing is."""
    width, height = image.size
    block = np.asarray(image.crop((max(0, width - 8), height - 1, width, height)))
    return bool((block == block[:, :1]).all())


def _segments(data: bytes) -> Iterator[tuple[int, int, bytes]]:
    """Give code, place and content of each segment, to the end marker of the first picture."""
    at, code = 2, 0
    for _ in range(_MOST_SEGMENTS):
        marker = _MARKER.search(data, at)
        if marker is None or code == _END:
            return
        code, place, at = data[marker.start() + 1], marker.start(), marker.end()
        content = b"" if code == _END else data[at + 2 : at + int.from_bytes(data[at : at + 2], "big")]
        at += 0 if code == _END else max(2, len(content) + 2)
        yield code, place, content
    yield _END, len(data), b""


def _sent(scan: bytes, is_progressive: bool) -> set[tuple[int, int]]:
    """Give the coefficients, by component and place, that are complete after a scan, whose header is given."""
    count = int.from_bytes(scan[:1], "big")
    components, bounds = scan[1 : 1 + 2 * count : 2], scan[1 + 2 * count : 4 + 2 * count]
    first, last, bits = bounds if is_progressive and len(bounds) == 3 else (0, 63, 0)
    places = range(first, last + 1) if bits & 15 == 0 else ()
    return {(component, at) for component in components for at in places}
