"""Decoding of clips: a video's file in, the frames of one tree that moves out."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from treestroke.codec.inputs import BEGINNING
from treestroke.codec.video_kinds import refusal_of, video_kind
from treestroke.core.errors import ClipError
from treestroke.core.film.judged import judged
from treestroke.core.progress import Report, silent
from treestroke.core.types import Picture
from treestroke.core.video import Video
from treestroke.engines.decoding import Footage, decode
from treestroke.limits import MAX_CLIP_BYTES
from treestroke.service.opened import open_input


@dataclass(frozen=True)
class StoredClip:
    """A clip's file that the service keeps: messages do not name its path."""

    path: Path


ClipLike = str | os.PathLike[str] | bytes | StoredClip | Video
"""A clip's path, the bytes of its file, or its frames."""


def load_clip(clip: ClipLike, chosen: int, report: Report = silent) -> Video:
    """Decode a clip (path or bytes of its file), and judge whether it shows a tree that moves.

    ``chosen`` is the frame that was drawn on.

    Raises
    ------
    ClipError
        As `decode` and `judged`; or the file is no video that can be read, is too large, or cannot be read.
    """
    if isinstance(clip, Video):
        return clip
    with _clip_file(clip) as (path, name):
        footage, picture = decode(path, chosen, name, report)
        return video_of(footage, chosen, picture)


def video_of(footage: Footage, chosen: int, picture: Picture) -> Video:
    """Return the part of all frames of a clip that holds the chosen one; ``picture`` is that frame.

    Raises
    ------
    ClipError
        As `judged`.
    """
    rate = footage.frames_per_second
    part = judged(footage.frames, rate, chosen)
    frames = footage.frames[part.start : part.stop]
    return Video(frames, rate, chosen - part.start, picture, (*footage.notes, *part.notes))


def check_clip(path: Path, name: str = "clip") -> None:
    """Check that a file is a video of a kind and a size that is accepted.

    Raises
    ------
    ClipError
        It is not.
    """
    with open_input(path, ClipError) as file:
        beginning = file.read(BEGINNING)
    if video_kind(beginning) is None:
        raise ClipError(f"{name}: {refusal_of(beginning)}", code="clip_format")
    if path.stat().st_size > MAX_CLIP_BYTES:
        raise too_large(name)


def too_large(name: str = "clip") -> ClipError:
    """Return the error that says a clip has too many bytes."""
    fault = f"the clip has more than {MAX_CLIP_BYTES // 10**6} MB; make it shorter or smaller"
    return ClipError(f"{name}: {fault}", code="clip_too_large")


@contextmanager
def _clip_file(clip: str | os.PathLike[str] | bytes | StoredClip) -> Iterator[tuple[Path, str]]:
    """Return a clip's file, checked, and what messages call it; bytes are written to a file for as long."""
    if isinstance(clip, StoredClip):
        yield clip.path, "clip"
    elif not isinstance(clip, bytes):
        path, name = Path(clip), os.fspath(clip)
        check_clip(path, name)
        yield path, name
    else:
        with tempfile.NamedTemporaryFile(prefix="treestroke-", suffix=".clip") as file:
            file.write(clip)
            file.flush()
            check_clip(Path(file.name))
            yield Path(file.name), "clip"
