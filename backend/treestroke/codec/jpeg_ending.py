"""JPEGs that end too soon: how much of their picture is missing.

A decoder fills in what is missing and does not report it. What it fills in depends on the bytes that follow the cut,
though. So the file is decoded twice, once completed by an end marker and once by noise and an end marker: the pixels
that differ are those that the file does not hold.
"""

import hashlib
import re
from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from PIL import Image

VISIBLE = 32
"""Least visible difference of pixels, 0 to 255. Lost refinement of a progressive JPEG stays below, lost blocks do not
(5 photos at qualities of 50 to 95)."""
_STRIP_PIXELS = 2_000_000
"""Pixels that are compared at a time."""
_MOST_SEGMENTS = 10_000
"""Greatest number of segments that are read; the rest of a file with more is left to the decoder."""
_MARKER = re.compile(rb"\xff[^\x00\xff\xd0-\xd7]")
"""A marker other than a restart marker; among coded pixels, 0xff is followed by 0."""
_START_OF_SCAN, _END, _RESTART_INTERVAL, _NO_FRAMES = 0xDA, 0xD9, 0xDD, (0xC4, 0xC8, 0xCC)
"""Codes of markers, and those in the range of frame headers that are not frame headers."""
_PROGRESSIVE = (0xC2, 0xC6, 0xCA, 0xCE)
"""Codes of progressive frame headers."""
_NOISE = hashlib.shake_256().digest(100_000).replace(b"\xff", b"")
"""Noise without 0xff, which would start a marker; the same in every process."""
_RESTART_BYTES = 4096
"""Bytes of noise from one restart marker to the next."""


@dataclass(frozen=True)
class Ending:
    """Where the coded pixels of a JPEG end (ITU T.81, annex B).

    Attributes
    ----------
    body
        Everything before the end marker of its first picture.
    marked
        Whether that marker exists.
    is_coarse
        Whether some passes over the picture, which bring its finer detail, are missing entirely.
    restart
        Number, 0 to 7, of the next restart marker; None if there are none.
    """

    body: bytes
    marked: bool
    is_coarse: bool
    restart: int | None

    def completed(self) -> bytes:
        """Return the file with an end marker."""
        return self.body + b"\xff\xd9"

    def filled_with_noise(self) -> bytes:
        """Return the file with noise in place of what is missing."""
        if self.restart is None:
            return self.body + _NOISE + b"\xff\xd9"
        pieces = [_NOISE[start : start + _RESTART_BYTES] for start in range(0, len(_NOISE), _RESTART_BYTES)]
        marked = (piece + bytes((0xFF, 0xD0 + (self.restart + at) % 8)) for at, piece in enumerate(pieces))
        return self.body + b"".join(marked) + b"\xff\xd9"


def ending_of(data: bytes) -> Ending:
    """Find where the coded pixels of a JPEG end."""
    incomplete: set[tuple[int, int]] = set()
    is_progressive, restarts, start, end = False, False, 0, None
    for code, place, content in _segments(data):
        if 0xC0 <= code <= 0xCF and code not in _NO_FRAMES:
            is_progressive = code in _PROGRESSIVE
            incomplete = {(component, at) for component in content[6::3] for at in range(64)}
        elif code == _RESTART_INTERVAL:
            restarts = any(content)
        elif code == _START_OF_SCAN:
            incomplete -= _completed_by(content, is_progressive)
            start = place
        elif code == _END:
            end = place
    body = data[:end].rstrip(b"\xff")
    last = max(body.rfind(bytes((0xFF, 0xD0 + number)), start) for number in range(8)) if restarts else -1
    restart = (body[last + 1] - 0xD0 + 1) % 8 if last >= 0 else 0
    return Ending(body, end is not None, bool(incomplete), restart if restarts else None)


def missing_part(completed: Image.Image, noisy: Image.Image) -> tuple[float, int]:
    """Compare decodings of `Ending.completed` and `Ending.filled_with_noise`.

    Returns the share, 0 to 1, of the pixels that the file does not hold, and the first row with one (the picture's
    height if there is none).
    """
    width, height = completed.size
    rows = max(1, _STRIP_PIXELS // width)
    count, first = 0, height
    for top in range(0, height, rows):
        box = (0, top, width, min(top + rows, height))
        difference = cv2.absdiff(np.asarray(completed.crop(box)), np.asarray(noisy.crop(box)))
        missing = np.atleast_3d(difference).max(axis=2) > VISIBLE
        count += int(missing.sum())
        if first == height and missing.any():
            first = top + int(missing.any(axis=1).argmax())
    return count / (width * height), first


def ends_flat(image: Image.Image) -> bool:
    """Tell whether a picture's last block has one colour, as a missing one has."""
    width, height = image.size
    block = np.asarray(image.crop((max(0, width - 8), height - 1, width, height)))
    return bool((block == block[:, :1]).all())


def _segments(data: bytes) -> Iterator[tuple[int, int, bytes]]:
    """Yield code, position and content of each segment, up to the end marker of the first picture."""
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


def _completed_by(header: bytes, is_progressive: bool) -> set[tuple[int, int]]:
    """Return the coefficients, by component and index, that are complete after a scan with this header."""
    count = int.from_bytes(header[:1], "big")
    components, bounds = header[1 : 1 + 2 * count : 2], header[1 + 2 * count : 4 + 2 * count]
    first, last, bits = bounds if is_progressive and len(bounds) == 3 else (0, 63, 0)
    places = range(first, last + 1) if bits & 15 == 0 else ()
    return {(component, at) for component in components for at in places}
