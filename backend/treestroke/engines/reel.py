"""A clip's file, opened by OpenCV's FFmpeg: its frames at an even rate, one after another.

Timestamps decide which frame stands for a moment, so that a variable frame rate becomes an even one. The same file
gives the same pixels. Only files of known kinds are to be opened (`codec.video_kinds`): FFmpeg also reads lists of
other files.
"""

import math
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.errors import ClipError
from treestroke.core.strokes import StrokeWarning
from treestroke.core.types import Picture
from treestroke.limits import FRAME_SIDE, MAX_CLIP_RATE, MAX_CLIP_SECONDS, MAX_CLIP_SIDE

_THREADS = 2
_TIMED = 60
"""First frames by whose timestamps the rate is judged."""
_FASTER = 0.1
"""Share above `MAX_CLIP_RATE` that is still taken frame by frame: cameras keep their rate only roughly."""
_RATE_UNKNOWN = 25.0
"""Frames a second of a file that tells neither a rate nor timestamps."""
_TOLERANCE = 0.05
_UNEVEN = 0.02
"""Share of frames that stand for more or fewer moments than they should, above which a rate is called variable."""
_LOST = 0.05
"""Share of the frames that a file promises, above which those that are missing are noted: some files only guess."""
_DAMAGED = "it is damaged or has no picture; save or copy it again, or convert it to MP4 (H.264)"


class Reel:
    """The frames of one clip; `frames` goes on where it is, and `rewind` begins again.

    Attributes
    ----------
    frames_per_second
        The even rate of the frames.
    step
        How many frames of the file make one of these.
    notes
        What is known to be left out or changed; complete once all frames have been seen.

    Raises
    ------
    ClipError
        There is no picture in the file, or it is damaged.
    """

    def __init__(self, path: Path, name: str = "clip") -> None:
        self._path, self._name = path, name
        rate = _rate(self._open())
        self.step = max(1, math.ceil(rate / MAX_CLIP_RATE - _FASTER))
        self.frames_per_second = rate / self.step
        self._gap_s = 1.0 / rate
        self._opened = self._open()
        self._promised = int(self._opened.get(cv2.CAP_PROP_FRAME_COUNT))
        self._at = 0
        self._seen = self._odd = 0
        self._long = self._size_changed = False

    @property
    def at(self) -> int:
        """Index of the frame that comes next."""
        return self._at

    def rewind(self) -> None:
        """Begin again at the first frame."""
        self._opened = self._open()
        self._at = self._seen = self._odd = 0
        self._long = self._size_changed = False

    def frames(self) -> Iterator[Picture]:
        """Yield the pictures (h, w, 3), BGR, upright and at their own size, from the next one on."""
        size: tuple[int, ...] | None = None
        for times in self._grabbed():
            if times == 0:
                continue
            ok, picture = self._opened.retrieve()
            if not ok or (size is not None and picture.shape != size):
                self._size_changed = ok
                return
            size = picture.shape
            for _ in range(times):
                self._at += 1
                yield np.asarray(picture, dtype=np.uint8)

    def skip(self, count: int) -> None:
        """Leave out the next frames."""
        until = self._at + count
        if count > 0:
            for times in self._grabbed():
                self._at += times
                if self._at >= until:
                    return

    @property
    def notes(self) -> tuple[StrokeWarning, ...]:
        """What was left out or changed, as far as it is known by now."""
        found = []
        rate = f"{self.frames_per_second:.4g} frames a second"
        if self.step > 1:
            detail = f"it has {self.frames_per_second * self.step:.4g} frames a second; one of {self.step} is taken"
            found.append(StrokeWarning("clip_fast", "clip", detail))
        if self._odd > _UNEVEN * self._seen:
            detail = f"its frames do not follow each other evenly; they were brought to {rate}"
            found.append(StrokeWarning("clip_uneven", "clip", detail))
        if self._long:
            detail = f"it is longer than {MAX_CLIP_SECONDS:g} s; what follows is left out"
            found.append(StrokeWarning("clip_long", "clip", detail))
        elif self._size_changed or self._seen < (1.0 - _LOST) * self._promised - 1:
            detail = "it cannot be read to its end; what comes before the damage is used"
            found.append(StrokeWarning("clip_cut_short", "clip", detail))
        return tuple(found)

    def _grabbed(self) -> Iterator[int]:
        """Yield, for each frame of the file from here on, how many moments it stands for."""
        while not self._long and self._opened.grab():
            seconds = _timestamp_s(self._opened, self._seen, self._gap_s)
            self._seen += 1
            due = math.floor((seconds + self._gap_s / 2) * self.frames_per_second) + 1
            self._long = due > MAX_CLIP_SECONDS * self.frames_per_second
            last = round(MAX_CLIP_SECONDS * self.frames_per_second)
            times = max(min(due, last) - self._at, 0)
            self._odd += times > 1 or (times == 0 and self.step == 1)
            yield times

    def _open(self) -> cv2.VideoCapture:
        opened = cv2.VideoCapture(str(self._path), cv2.CAP_FFMPEG, [cv2.CAP_PROP_N_THREADS, _THREADS])
        if not opened.isOpened():
            raise ClipError(f"{self._name}: {_DAMAGED}")
        return opened


def upright(picture: Picture) -> Picture:
    """Return a frame (h, w, 3), BGR, as sRGB, at most `MAX_CLIP_SIDE` px a side."""
    return np.asarray(cv2.cvtColor(_reduced(picture, MAX_CLIP_SIDE), cv2.COLOR_BGR2RGB), dtype=np.uint8)


def grey(picture: Picture) -> NDArray[np.uint8]:
    """Return a frame (h, w, 3), BGR, as (h', w') grey, at most `FRAME_SIDE` px a side."""
    whole = np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), dtype=np.uint8)
    return _reduced(whole, FRAME_SIDE)


def size_of(picture: Picture) -> tuple[int, int]:
    """Return the (width, height) at which a frame is drawn on, px."""
    height, width = picture.shape[:2]
    scale = min(1.0, MAX_CLIP_SIDE / max(width, height))
    return max(1, round(width * scale)), max(1, round(height * scale))


def _reduced(picture: NDArray[np.uint8], side: int) -> NDArray[np.uint8]:
    height, width = picture.shape[:2]
    scale = min(1.0, side / max(width, height))
    if scale == 1.0:
        return picture
    size = max(1, round(width * scale)), max(1, round(height * scale))
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _rate(opened: cv2.VideoCapture) -> float:
    """Return a file's frames a second: as it tells, unless the timestamps of its first frames say otherwise."""
    said = opened.get(cv2.CAP_PROP_FPS)
    times: list[float] = []
    while len(times) < _TIMED and opened.grab():
        times.append(opened.get(cv2.CAP_PROP_POS_MSEC) / 1000)
    gaps = np.diff(times)
    usual = float(np.median(gaps)) if gaps.size else 0.0
    if usual <= 0.0:
        return said if 0.0 < said <= 1000.0 else _RATE_UNKNOWN
    return said if abs(said * usual - 1.0) < _TOLERANCE else 1.0 / usual


def _timestamp_s(opened: cv2.VideoCapture, index: int, gap_s: float) -> float:
    """Return when the frame that was grabbed is shown, seconds; by its index where the file does not tell."""
    seconds = opened.get(cv2.CAP_PROP_POS_MSEC) / 1000
    return seconds if seconds > 0.0 else index * gap_s
