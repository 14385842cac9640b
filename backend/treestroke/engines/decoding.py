"""A clip's frames, read into memory; in a process of its own where a crash would cost something."""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from treestroke.core.errors import ClipError
from treestroke.core.film.judged import require_frame
from treestroke.core.progress import Report, silent
from treestroke.core.strokes import StrokeWarning
from treestroke.core.types import Picture
from treestroke.engines.child import Bounds, ChildEnded, call_in_child
from treestroke.engines.reel import Reel, grey, size_of, upright
from treestroke.limits import MAX_CLIP_RATE, MAX_CLIP_SECONDS, MAX_CLIP_SIDE, MIN_CLIP_FRAMES, MIN_CLIP_SECONDS

DECODE_BOUNDS = Bounds(seconds=300.0, memory=3 * 2**30)
"""What decoding a minute of 4K takes at most."""
_ENDED = {
    "slow": "it takes too long to decode; make it shorter or smaller, such as 1280 px wide",
    "memory": "it needs too much memory to decode; make it smaller, such as 1280 px wide",
    "crash": "it cannot be decoded; save or copy it again, or convert it to MP4 (H.264)",
}


@dataclass(frozen=True, eq=False)
class Footage:
    """All frames of a clip.

    Attributes
    ----------
    frames
        (f, h, w) uint8 grey.
    frames_per_second
        Their even rate.
    size_px
        Width and height at which a frame is drawn on.
    notes
        What was left out or changed.
    """

    frames: NDArray[np.uint8]
    frames_per_second: float
    size_px: tuple[int, int]
    notes: tuple[StrokeWarning, ...]


class _Written(NamedTuple):
    """What `write_frames` found: the shape of the frames, and what else `Footage` tells."""

    shape: tuple[int, ...]
    frames_per_second: float
    size_px: tuple[int, int]
    notes: tuple[StrokeWarning, ...]
    picture: Picture | None


def read_footage(path: Path, name: str = "clip") -> Footage:
    """Read all frames of a clip in this process; ``name`` appears in messages.

    Raises
    ------
    ClipError
        It is damaged, has no picture, or is too short.
    """
    with _frames_file() as out:
        return _footage(write_frames(path, name, None, out.name, silent), out.name)


def read_picture(reel: Reel, frame: int) -> Picture:
    """Return one frame (h, w, 3), sRGB; soon if it is not far behind the one that was read last.

    Raises
    ------
    ClipError
        There is no such frame.
    """
    if frame < reel.at:
        reel.rewind()
    reel.skip(frame - reel.at)
    picture = next(reel.frames(), None)
    if picture is None:
        require_frame(frame, reel.at)
    assert picture is not None
    return upright(picture)


def decode(path: Path, chosen: int, name: str, report: Report = silent) -> tuple[Footage, Picture]:
    """Read all frames of a clip, and the chosen one (h, w, 3) in sRGB, in a process of its own.

    Raises
    ------
    ClipError
        As `read_footage`; there is no such frame; or decoding takes too long or too much memory.
    """
    with _frames_file() as out:
        try:
            work = "treestroke.engines.decoding:write_frames"
            written: _Written = call_in_child(work, (path, name, chosen, out.name), DECODE_BOUNDS, report)
        except ChildEnded as ended:
            raise ClipError(f"{name}: {_ENDED[ended.why]}") from ended
        assert written.picture is not None
        return _footage(written, out.name), written.picture


def write_frames(path: Path, name: str, chosen: int | None, out: str, report: Report) -> _Written:
    """Write a clip's grey frames to a file, one after another; return what they are, and the chosen one in colour."""
    reel, picture, size, shape, count, large = Reel(path, name), None, (0, 0), (0, 0), 0, False
    with open(out, "wb") as file:
        for frame in reel.frames():
            small = grey(frame)
            size, shape = size_of(frame), small.shape
            large = max(frame.shape[:2]) > MAX_CLIP_SIDE
            if count == chosen:
                picture = upright(frame)
            file.write(small.tobytes())
            count += 1
            report("decode", min(count / (MAX_CLIP_SECONDS * MAX_CLIP_RATE), 1.0))
    _check_length(count, reel, name)
    if chosen is not None:
        require_frame(chosen, count)
    notes = (*reel.notes, *((_scaled(size),) if large else ()))
    return _Written((count, *shape), reel.frames_per_second, size, notes, picture)


def _check_length(count: int, reel: Reel, name: str) -> None:
    seconds = count / reel.frames_per_second
    if count >= MIN_CLIP_FRAMES and seconds >= MIN_CLIP_SECONDS:
        return
    if count <= 1:
        fault = "this is a still picture; film the tree for some seconds, or, for a photo, use `treestroke model`"
        raise ClipError(f"{name}: {fault}", code="clip_picture")
    fault = f"it has {count} frames in {seconds:.1f} s"
    need = f"at least {MIN_CLIP_FRAMES} frames and {MIN_CLIP_SECONDS:g} s are needed; film the tree for some seconds"
    raise ClipError(f"{name}: {fault}, {need}", code="clip_short")


def _scaled(size: tuple[int, int]) -> StrokeWarning:
    detail = f"it is larger than {MAX_CLIP_SIDE} px; it was scaled to {size[0]} x {size[1]}, in which strokes count"
    return StrokeWarning("clip_large", "clip", detail)


def _footage(written: _Written, path: str) -> Footage:
    """Return what was written; the frames stay in their file, which may be removed, until they are needed."""
    frames = np.memmap(path, dtype=np.uint8, mode="r", shape=written.shape)
    return Footage(np.asarray(frames), written.frames_per_second, written.size_px, written.notes)


def _frames_file() -> "tempfile._TemporaryFileWrapper[bytes]":
    """Return a file for frames, which all other processes may be kept from, and which is removed in the end."""
    return tempfile.NamedTemporaryFile(prefix="treestroke-", suffix=".grey")
