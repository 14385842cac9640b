"""Whether the frames of a clip show one tree that moves: cuts, darkness, stillness."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.errors import ClipError
from treestroke.core.strokes import StrokeWarning
from treestroke.core.types import Floats

LEAST_PART_S = 1.5
"""Shortest part between two cuts that is used, seconds."""
_THUMBNAIL = (32, 18)
_CUT = 14.0
"""Least mean difference, grey levels, between thumbnails before and after a cut."""
_CUT_ABOVE_USUAL = 5.0
"""How many times larger than what is usual around it the difference at a cut must be."""
_AROUND = 8
"""Frames on each side that tell what is usual."""
_NIGHT = 40.0
"""Grey level: in a picture taken by day, a tenth of the pixels is lighter. (A clip at dusk had 95, at night 21.)"""
_SAMPLED = 48
"""Frames that stillness is judged on."""
_STILL_WIDTH = 160
_STILL = 2.0
"""Least standard deviation over time, grey levels at `_STILL_WIDTH` px, of the pixels that change most (two trees in a
wind: 27 and 50)."""
_CHANGING = 99.5
"""Percentile of the pixels that change most."""
_NOISE, _ALIKE = 8.0, 1.5
"""Where the pixels that change most stay below `_NOISE` and below `_ALIKE` times the median of all, it is the noise of
a small picture: it is everywhere alike."""


@dataclass(frozen=True)
class Part:
    """The frames of a clip that are used: from ``start`` up to, not including, ``stop``; and what is to be noted."""

    start: int
    stop: int
    notes: tuple[StrokeWarning, ...] = ()


def require_frame(frame: int, frames: int) -> None:
    """Check that a clip of so many frames has one of this index.

    Raises
    ------
    ClipError
        It has not.
    """
    if not 0 <= frame < frames:
        fault = f"there is no frame {frame}, the clip has {frames}; choose one from 0 to {frames - 1}"
        raise ClipError.at(("frame",), fault, "frame_missing")


def judged(frames: NDArray[np.uint8], frames_per_second: float, chosen: int) -> Part:
    """Return the part of a clip (f, h, w), grey, that holds the chosen frame and has no cut.

    Raises
    ------
    ClipError
        The part is too short, too dark to see, or nothing moves in it.
    """
    cuts = cuts_of(frames)
    start = max((cut for cut in cuts if cut <= chosen), default=0)
    stop = min((cut for cut in cuts if cut > chosen), default=len(frames))
    seconds = (stop - start) / frames_per_second
    if cuts and seconds < LEAST_PART_S:
        where = _seconds_of(cuts, frames_per_second)
        fault = f"it is cut at {where}, and the part with frame {chosen} lasts {seconds:.1f} s"
        need = f"at least {LEAST_PART_S:g} s are needed; choose a frame of a longer part, or a clip without cuts"
        raise ClipError(f"clip: {fault}; {need}", code="clip_cut")
    check_light(frames[start:stop])
    check_motion(frames[start:stop])
    return Part(start, stop, _used_notes(cuts, start, stop, frames_per_second))


def cuts_of(frames: NDArray[np.uint8]) -> list[int]:
    """Return the indices of the frames (f, h, w), grey, before which a clip is cut.

    A cut changes the picture much more than its neighbours change it, and for good: a flash is none.
    """
    small = np.array([cv2.resize(frame, _THUMBNAIL, interpolation=cv2.INTER_AREA) for frame in frames], np.float64)
    steps = np.abs(np.diff(small, axis=0)).mean(axis=(1, 2))
    return [int(at) + 1 for at in np.flatnonzero(steps > _CUT) if _is_cut(small, steps, int(at))]


def cut_notes(cuts: list[int], frames_per_second: float) -> tuple[StrokeWarning, ...]:
    """Return what is to be noted of a clip's cuts before it is known which frame is drawn on."""
    if not cuts:
        return ()
    detail = (
        f"it is cut at {_seconds_of(cuts, frames_per_second)}; only the part with the frame that is drawn on counts"
    )
    return (StrokeWarning("clip_cut", "clip", detail),)


def check_light(frames: NDArray[np.uint8]) -> None:
    """Check that frames (f, h, w), grey, are light enough to see a tree.

    Raises
    ------
    ClipError
        They are not.
    """
    light = np.median([np.percentile(frame, 90) for frame in _sampled(frames)])
    if light < _NIGHT:
        raise ClipError("clip: it is too dark to see the tree; film it by day", code="clip_dark")


def check_motion(frames: NDArray[np.uint8]) -> None:
    """Check that something moves in frames (f, h, w), grey.

    Raises
    ------
    ClipError
        Nothing does.
    """
    height, width = frames.shape[1:]
    size = _STILL_WIDTH, max(1, round(_STILL_WIDTH * height / width))
    small = [cv2.resize(frame, size, interpolation=cv2.INTER_AREA) for frame in _sampled(frames)]
    usual, most = np.percentile(np.array(small, dtype=np.float64).std(axis=0), (50, _CHANGING))
    if most < _STILL or (most < _NOISE and most < _ALIKE * usual):
        fault = "nothing moves in it; film the tree in a wind, from one place"
        raise ClipError(f"clip: {fault}, or, for a still photo, use `treestroke model`", code="clip_still")


def _is_cut(small: Floats, steps: Floats, at: int) -> bool:
    """Tell whether the large step after frame ``at`` is a cut: unusual there, and the picture does not come back."""
    around = np.delete(steps[max(at - _AROUND, 0) : at + _AROUND + 1], min(at, _AROUND))
    if steps[at] < _CUT_ABOVE_USUAL * max(float(np.median(around)) if around.size else 0.0, 1.0):
        return False
    return _differ(small, at - 1, at + 2) and _differ(small, at - 1, at + 1) and _differ(small, at, at + 2)


def _differ(small: Floats, one: int, other: int) -> bool:
    """Tell whether two frames differ as the sides of a cut do; those beyond the clip's ends do."""
    if one < 0 or other >= len(small):
        return True
    return bool(np.abs(small[one] - small[other]).mean() > _CUT)


def _sampled(frames: NDArray[np.uint8]) -> NDArray[np.uint8]:
    at = np.unique(np.linspace(0, len(frames) - 1, _SAMPLED).round().astype(int))
    return np.asarray(frames[at], dtype=np.uint8)


def _used_notes(cuts: list[int], start: int, stop: int, frames_per_second: float) -> tuple[StrokeWarning, ...]:
    if not cuts:
        return ()
    used = f"only the part from {start / frames_per_second:.1f} to {stop / frames_per_second:.1f} s is used"
    detail = f"it is cut at {_seconds_of(cuts, frames_per_second)}; {used}, which holds the frame that was drawn on"
    return (StrokeWarning("clip_cut", "clip", detail),)


def _seconds_of(cuts: list[int], frames_per_second: float) -> str:
    """Return the seconds of the first cuts as text."""
    shown = [f"{cut / frames_per_second:.1f}" for cut in cuts[:3]]
    return f"{', '.join(shown)} s" + (f" and {len(cuts) - 3} more times" if len(cuts) > 3 else "")
