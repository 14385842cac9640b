"""Decoding of what a caller hands in: the parts of `Inputs`, and settings."""

import os
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np

from treestroke.codec.branch_edits import edits_from, parse_edits
from treestroke.codec.capture_strokes import capture_strokes_from, parse_capture_strokes
from treestroke.codec.envelope import envelope_from, parse_envelope
from treestroke.codec.exif import exif_focal_px
from treestroke.codec.image import Warn, check_size, decode_cutout, decode_photo, decode_stored, ignore_warning
from treestroke.codec.inputs import Inputs, PartKind, part_of
from treestroke.codec.project import Project, read_project
from treestroke.codec.sketch import parse_sketch, sketch_from
from treestroke.codec.strokes import frame_strokes_from, parse_frame_strokes, parse_strokes, strokes_from
from treestroke.core.capture import CapturedPhoto, Structure
from treestroke.core.errors import PhotoError, StrokesError, TreestrokeError
from treestroke.core.imaging.opacity import over_white
from treestroke.core.pipeline.captured_photos import captured_photo
from treestroke.core.pipeline.settings import ModelSettings, settings_from
from treestroke.core.progress import Report, silent
from treestroke.core.siblings.outlines import SHAPES, Envelope
from treestroke.core.skeleton.branch_edits import BranchEdit
from treestroke.core.strokes import CaptureStrokes, FrameStrokes, Sketch, Strokes
from treestroke.core.types import Picture
from treestroke.service.clip_loading import ClipLike, load_clip
from treestroke.service.opened import open_input

T = TypeVar("T")
FileLike = str | os.PathLike[str] | bytes
"""A path, or the bytes of a file."""
PhotoLike = FileLike | Picture
StrokesLike = FileLike | Mapping[str, Any] | Strokes
SketchLike = FileLike | Mapping[str, Any] | Sketch
EnvelopeLike = FileLike | Mapping[str, Any] | Envelope
"""An outline's name, or what it is read from."""
ViewsLike = FileLike | Mapping[str, Any] | CaptureStrokes
EditsLike = FileLike | Mapping[str, Any] | tuple[BranchEdit, ...]
FrameStrokesLike = FileLike | Mapping[str, Any] | FrameStrokes
PartLike = (
    PhotoLike
    | CapturedPhoto
    | StrokesLike
    | ViewsLike
    | EditsLike
    | SketchLike
    | ClipLike
    | FrameStrokesLike
    | EnvelopeLike
)
"""Whatever the library takes as a part of a tree's inputs."""
SettingsLike = Mapping[str, Any] | ModelSettings | None


def read_part(name: str, file: FileLike) -> tuple[bytes, str]:
    """Return a part's bytes (at most one more than its limit), and what messages call it: its path or its name.

    Raises
    ------
    TreestrokeError
        As `open_input`.
    """
    if isinstance(file, bytes):
        return file, name
    part = part_of(name)
    with open_input(file, part.refusal) as opened:
        return opened.read(part.max_bytes + 1), os.fspath(file)


def load_photo(photo: PhotoLike, report: Report = silent, warn: Warn = ignore_warning) -> Picture:
    """Decode a photo (path, encoded bytes, or upright sRGB pixels) to upright sRGB pixels, uint8.

    They are (h, w, 3), or (h, w, 4) with straight alpha where some of it is transparent.

    ``report("decode", fraction)`` is called while encoded photos are read, ``warn`` with each thing that was mended.

    Raises
    ------
    PhotoError
        As `decode_photo`; or the file cannot be read; or the array has another shape or type.
    """
    if isinstance(photo, np.ndarray):
        if photo.ndim != 3 or photo.shape[2] not in (3, 4) or photo.dtype != np.uint8:
            problem = f"an array must be (h, w, 3) or (h, w, 4) uint8, not {photo.shape} {photo.dtype}; convert it"
            raise PhotoError.at((), problem, "wrong_type")
        check_size(photo.shape[1], photo.shape[0], "photo")
        return np.ascontiguousarray(photo)
    return decode_photo(*read_part("photo", photo), report, warn)


def load_strokes(strokes: StrokesLike) -> Strokes:
    """Read strokes (path, JSON bytes, plain mapping or values).

    Raises
    ------
    StrokesError
        As `parse_strokes`; or the file cannot be read.
    """
    return strokes if isinstance(strokes, Strokes) else _read("strokes", strokes, strokes_from, parse_strokes)


def load_frame_strokes(strokes: FrameStrokesLike) -> FrameStrokes:
    """Read strokes over a frame of a clip (path, JSON bytes, plain mapping or values).

    Raises
    ------
    StrokesError
        As `parse_frame_strokes`; or the file cannot be read.
    """
    if isinstance(strokes, FrameStrokes):
        return strokes
    return _read("frame_strokes", strokes, frame_strokes_from, parse_frame_strokes)


def load_views(views: ViewsLike) -> CaptureStrokes:
    """Read strokes over several photos (path, JSON bytes, plain mapping or values).

    Raises
    ------
    StrokesError
        As `parse_capture_strokes`; or the file cannot be read.
    """
    return (
        views
        if isinstance(views, CaptureStrokes)
        else _read("views", views, capture_strokes_from, parse_capture_strokes)
    )


def load_edits(edits: EditsLike) -> tuple[BranchEdit, ...]:
    """Read edits of visible branches (path, JSON bytes, plain mapping or values).

    Raises
    ------
    StrokesError
        As `parse_edits`; or the file cannot be read.
    """
    return edits if isinstance(edits, tuple) else _read("edits", edits, edits_from, parse_edits)


def _read(
    part: str,
    given: FileLike | Mapping[str, Any],
    from_plain: Callable[[Mapping[str, Any]], T],
    parse: Callable[[bytes, str], T],
) -> T:
    """Read a part of the inputs that is given as a plain mapping, JSON bytes or a path."""
    return from_plain(given) if isinstance(given, Mapping) else parse(*read_part(part, given))


def load_stored_capture(name: str, stored: bytes, focal_px: float | None = None) -> CapturedPhoto:
    """Decode one photo of a capture that the service keeps, at no more than `CAPTURED_SIDE` px.

    ``focal_px`` is its focal length, px of the photo, where that is known.
    """
    return captured_photo(name, over_white(decode_stored(stored)), focal_px)


def load_captured(
    name: str, photo: PhotoLike | CapturedPhoto, report: Report = silent, warn: Warn = ignore_warning
) -> CapturedPhoto:
    """Decode one photo of a capture, named by its file, at no more than `CAPTURED_SIDE` px, unless it is decoded.

    Raises
    ------
    PhotoError
        As `load_photo`; the message names the file.
    """
    if isinstance(photo, CapturedPhoto):
        return photo
    try:
        if isinstance(photo, np.ndarray):
            return captured_photo(name, over_white(load_photo(photo, report, warn)), None)
        content, _ = read_part("photo", photo)
        return captured_photo(name, over_white(decode_photo(content, name, report, warn)), exif_focal_px(content))
    except PhotoError as error:
        raise error if str(error).startswith(name) else error.within(name) from error


def load_sketch(sketch: SketchLike, name: str) -> Sketch:
    """Read a sketch (path, JSON or PNG bytes, plain mapping or values); ``name`` is its part: front or side.

    Raises
    ------
    StrokesError
        As `parse_sketch`; or the file cannot be read.
    """
    if isinstance(sketch, Sketch):
        return sketch
    if isinstance(sketch, Mapping):
        try:
            return sketch_from(sketch)
        except StrokesError as error:
            raise error.within(name) from error
    return parse_sketch(*read_part(name, sketch))


def load_cutout(picture: FileLike, name: str) -> Picture:
    """Decode the picture of something cut out (path or PNG bytes) to (h, w, 4) uint8, sRGB with straight alpha.

    ``name`` is its part.

    Raises
    ------
    TreestrokeError
        As `decode_cutout`; or the file cannot be read.
    """
    return decode_cutout(*read_part(name, picture), part_of(name).refusal)


def load_envelope(envelope: EnvelopeLike) -> Envelope:
    """Read the outline that siblings are to fill: its name, a path, JSON or PNG bytes, plain mapping or value.

    Raises
    ------
    EnvelopeError
        As `parse_envelope`; or the file cannot be read.
    """
    if isinstance(envelope, Envelope):
        return envelope
    if isinstance(envelope, Mapping) or envelope in SHAPES:
        return envelope_from(envelope)
    return parse_envelope(*read_part("envelope", envelope))


def load_parts(inputs: Inputs[Any], report: Report = silent, warn: Warn = ignore_warning) -> dict[str, Any]:
    """Decode all parts of a tree's inputs, by name: photos to pixels, drawings to strokes and sketches.

    Photos and clips, which take longest, come last; a clip is read at the frame that was drawn on.

    Raises
    ------
    TreestrokeError
        As the function that decodes each part.
    """
    loaded: dict[str, Any] = {}
    for name in sorted(inputs.parts, key=lambda name: part_of(name).kind in ("photo", "clip")):
        content = inputs.parts[name]
        match part_of(name).kind:
            case "photo" if part_of(name).many:
                loaded[name] = load_captured(name.partition("/")[2], content, report, warn)
            case "photo":
                loaded[name] = load_photo(content, report, warn)
            case "clip":
                loaded[name] = load_clip(content, loaded["frame_strokes"].frame, report)
                for note in loaded[name].notes:
                    warn(note)
            case kind:
                loaded[name] = _LOADERS[kind](content, name)
    return loaded


def _load_structure(structure: FileLike, name: str) -> Structure:
    from treestroke.codec.structure import decode_structure  # with pydantic, and few trees have one

    return decode_structure(read_part(name, structure)[0])


_LOADERS: Mapping[PartKind, Callable[[Any, str], Any]] = {
    "strokes": lambda strokes, _: load_strokes(strokes),
    "frame_strokes": lambda strokes, _: load_frame_strokes(strokes),
    "views": lambda views, _: load_views(views),
    "edits": lambda edits, _: load_edits(edits),
    "structure": _load_structure,
    "sketch": load_sketch,
    "cutout": load_cutout,
    "envelope": lambda envelope, _: load_envelope(envelope),
}
"""Loaders of all parts but pictures, by kind: they take a part and its name."""


def load_settings(settings: SettingsLike) -> ModelSettings:
    """Check settings (names and values); those that are absent have their defaults.

    Raises
    ------
    SettingsError
        As `settings_from`.
    """
    return settings if isinstance(settings, ModelSettings) else settings_from(settings or {})


def load_project(path: str | os.PathLike[str]) -> Project:
    """Read a project file.

    Raises
    ------
    TreestrokeError
        As `read_project`; or the file cannot be read.
    """
    with open_input(path, TreestrokeError) as file:
        return read_project(file, os.fspath(path))
