"""What a caller may hand in as photo, strokes, sketches and settings, brought to values."""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from treestroke.codec.image import (
    MAX_BYTES,
    Warn,
    check_size,
    decode_fruit,
    decode_leaf,
    decode_photo,
    unheard,
)
from treestroke.codec.project import MAX_TEXT_BYTES, Project, read_project
from treestroke.codec.sketch import parse_sketch, sketch_from
from treestroke.codec.strokes import parse_strokes, strokes_from
from treestroke.core.errors import FruitError, LeafError, PhotoError, StrokesError, TreestrokeError
from treestroke.core.pipeline.settings import ModelSettings, settings_from
from treestroke.core.progress import Report, silent
from treestroke.core.strokes import Sketch, Strokes
from treestroke.core.types import Picture
from treestroke.limits import MAX_LEAF_BYTES

PhotoLike = str | os.PathLike[str] | bytes | Picture
StrokesLike = str | os.PathLike[str] | bytes | Mapping[str, Any] | Strokes
SketchLike = str | os.PathLike[str] | bytes | Mapping[str, Any] | Sketch
LeafLike = str | os.PathLike[str] | bytes | None
FruitLike = LeafLike
SettingsLike = Mapping[str, Any] | ModelSettings | None


@contextmanager
def open_input(path: str | os.PathLike[str], kind: type[TreestrokeError]) -> Iterator[BinaryIO]:
    """Open a file that the person named.

    Raises
    ------
    TreestrokeError
        Of the given kind, where the file does not exist or may not be read.
    """
    try:
        with Path(path).open("rb") as file:
            yield file
    except FileNotFoundError as error:
        raise kind(f"{os.fspath(path)}: there is no such file; check the path") from error
    except (IsADirectoryError, NotADirectoryError, PermissionError) as error:
        raise kind(f"{os.fspath(path)}: it cannot be read ({error.strerror}); name a file that can") from error
    except ValueError as error:
        raise kind(f"{os.fspath(path)!r}: this is no path ({error}); check it") from error


def read_input(path: str | os.PathLike[str], limit: int, kind: type[TreestrokeError]) -> bytes:
    """Read a file that the person named, at most one byte more than ``limit``.

    Raises
    ------
    TreestrokeError
        As `open_input`.
    """
    with open_input(path, kind) as file:
        return file.read(limit + 1)


def load_photo(photo: PhotoLike, report: Report = silent, warn: Warn = unheard) -> Picture:
    """Bring a photo (path, encoded bytes, or upright sRGB pixels (h, w, 3) uint8) to pixels.

    ``report("decode", fraction)`` is called as encoded ones are read, ``warn`` with what was mended in them.

    Raises
    ------
    PhotoError
        As `decode_photo`; or the file cannot be read; or the array is no such picture.
    """
    if isinstance(photo, np.ndarray):
        if photo.ndim != 3 or photo.shape[2] != 3 or photo.dtype != np.uint8:
            what = f"an array must be (h, w, 3) uint8, not {photo.shape} {photo.dtype}; convert it"
            raise PhotoError.at((), what, "wrong_type")
        check_size(photo.shape[1], photo.shape[0], "photo")
        return np.ascontiguousarray(photo)
    if isinstance(photo, bytes):
        return decode_photo(photo, "photo", report, warn)
    return decode_photo(read_input(photo, MAX_BYTES, PhotoError), os.fspath(photo), report, warn)


def load_strokes(strokes: StrokesLike) -> Strokes:
    """Bring strokes (path, JSON bytes, plain mapping or values) to values.

    Raises
    ------
    StrokesError
        As `parse_strokes`; or the file cannot be read.
    """
    if isinstance(strokes, Strokes):
        return strokes
    if isinstance(strokes, Mapping):
        return strokes_from(strokes)
    if isinstance(strokes, bytes):
        return parse_strokes(strokes, "strokes")
    return parse_strokes(read_input(strokes, MAX_TEXT_BYTES, StrokesError), os.fspath(strokes))


def load_sketch(sketch: SketchLike, name: str) -> Sketch:
    """Bring a sketch (path, JSON or PNG bytes, plain mapping or values) to values; ``name`` says which it is.

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
    if isinstance(sketch, bytes):
        return parse_sketch(sketch, name)
    return parse_sketch(read_input(sketch, MAX_TEXT_BYTES, StrokesError), os.fspath(sketch))


def load_leaf(leaf: LeafLike) -> Picture | None:
    """Bring the picture of a leaf (path or PNG bytes, or absent) to pixels (h, w, 4).

    Raises
    ------
    LeafError
        As `decode_leaf`; or the file cannot be read.
    """
    return _cut_out(leaf, "leaf", LeafError, decode_leaf)


def load_fruit(fruit: FruitLike) -> Picture | None:
    """Bring the picture of a fruit (path or PNG bytes, or absent) to pixels (h, w, 4).

    Raises
    ------
    FruitError
        As `decode_fruit`; or the file cannot be read.
    """
    return _cut_out(fruit, "fruit", FruitError, decode_fruit)


def load_settings(settings: SettingsLike) -> ModelSettings:
    """Bring settings (names and values, or absent) to values.

    Raises
    ------
    SettingsError
        As `settings_from`.
    """
    return settings if isinstance(settings, ModelSettings) else settings_from(settings or {})


def load_project(path: str | os.PathLike[str]) -> Project:
    """Open a project file.

    Raises
    ------
    TreestrokeError
        As `read_project`; or the file cannot be read.
    """
    with open_input(path, TreestrokeError) as file:
        return read_project(file, os.fspath(path))


def _cut_out(
    picture: LeafLike, name: str, refusal: type[TreestrokeError], decode: Callable[[bytes, str], Picture]
) -> Picture | None:
    if picture is None or isinstance(picture, bytes):
        return None if picture is None else decode(picture, name)
    return decode(read_input(picture, MAX_LEAF_BYTES, refusal), os.fspath(picture))
