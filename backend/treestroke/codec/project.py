"""Project files: NAME.treestroke, a ZIP of photo, strokes.json or sketches, settings.json and own pictures."""

import io
import json
import shutil
import zipfile
import zlib
from collections.abc import Container, Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any, BinaryIO, cast

from treestroke.codec.archive import zip_into
from treestroke.codec.image import MAX_STORED_BYTES, PHOTO_HEAD, StoredPhoto, most_stored_bytes
from treestroke.codec.json_text import read_json
from treestroke.codec.photo_kinds import ending_of
from treestroke.core.errors import SettingsError, TreestrokeError
from treestroke.core.stroke_rules import Place
from treestroke.limits import MAX_LEAF_BYTES, MAX_SKETCH_BYTES

MAX_TEXT_BYTES = 64_000_000
"""More than the longest strokes that are allowed ever need; of all texts of a project together."""
MAX_SETTINGS_BYTES = 100_000

VIEWS = ("front", "side")
_PNG = b"\x89PNG"
_BEGINNING = 128
"""Bytes by which the kind of a photo or a sketch is told."""
_PICTURES = ("leaf", "fruit")
_NAMES = {
    **{f"{part}.json": part for part in ("strokes", "settings", *VIEWS)},
    **{f"{part}.png": part for part in (*VIEWS, *_PICTURES)},
}
"""Which part each member is, but the photo."""
_ORDER = ("photo", "strokes", *VIEWS, "settings", *_PICTURES)
_PIECE = 1_000_000
"""Bytes that are read at once; also of the table of members."""


@dataclass(frozen=True)
class Project:
    """What a tree is made of: photo and strokes, sketches, or both.

    What a service stored may be larger than an upload, so the photo in a project may be, too.

    Attributes
    ----------
    photo
        The photo's bytes.
    strokes
        The strokes' JSON text.
    settings
        By name; ``seed`` may be among them.
    leaf, fruit
        PNGs of what the tree is to bear.
    front, side
        Sketches, each JSON text or a PNG.
    """

    photo: bytes | None
    strokes: bytes | None
    settings: dict[str, Any]
    leaf: bytes | None = None
    fruit: bytes | None = None
    front: bytes | None = None
    side: bytes | None = None


def check_parts(given: Container[str], within: Place = ()) -> None:
    """Refuse photo, strokes, front and side that make no tree together; ``within`` leads to front and side.

    Together they are photo and strokes, perhaps with a side; or a front, perhaps with a side and with a photo.

    Raises
    ------
    TreestrokeError
        One is missing, or one too many.
    """
    needs = "a tree is made of photo and strokes, or of a front sketch"
    if "front" in given:
        if "strokes" in given:
            what = f"there is a front sketch too, and {needs}; leave one of them out"
            raise TreestrokeError.at(("strokes",), what, "strokes_and_sketch")
        return
    if "strokes" in given:
        if "photo" not in given:
            raise TreestrokeError.at(("photo",), "it is missing; strokes need the photo under them", "missing_key")
        return
    if "photo" in given:
        raise TreestrokeError.at(("strokes",), f"they are missing: {needs}; send one of these", "missing_key")
    place: Place = (*within, "front") if "side" in given else ("photo",)
    raise TreestrokeError.at(place, f"it is missing: {needs}; send one of these", "missing_key")


def sketch_ending(sketch: bytes) -> str:
    """Name what the file of a sketch ends in: json or png."""
    return "png" if sketch.startswith(_PNG) else "json"


def read_project(file: BinaryIO, name: str) -> Project:
    """Open a project file; ``name`` appears in messages.

    The photo is the one member called ``photo`` with any ending; sketches are ``front`` and ``side`` with .json or
    .png; settings.json, leaf.png and fruit.png may be absent. How large each part is, is judged before it is unpacked.

    Raises
    ------
    TreestrokeError
        No ZIP, damaged, without what makes a tree, or with a part that is too large.
    SettingsError
        settings.json holds no JSON object.
    """
    try:
        with zipfile.ZipFile(cast("BinaryIO", _Pieces(file))) as archive:
            members = _members(archive, name)
            _check_whole(members, name)
            _check_sizes(archive, members, name)
            contents = {part: _content(archive, info) for part, info in members.items()}
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        what = f"this is no project file that can be read ({error}); export it anew"
        raise TreestrokeError(f"{name}: {what}", code="project_unreadable") from error
    settings = _settings(contents.pop("settings", b"{}"), name)
    photo = StoredPhoto(contents.pop("photo")) if "photo" in contents else None
    return Project(photo, contents.pop("strokes", None), settings, **contents)


def write_project(out: BinaryIO, parts: Mapping[str, BinaryIO], settings: Mapping[str, Any]) -> None:
    """Write parts, by name, as a project file that `read_project` reads back; equal ones give equal bytes."""
    given = {**parts, "settings": io.BytesIO(json.dumps(settings, indent=2, sort_keys=True).encode())}
    zip_into(out, {f"{part}.{_ending(part, given[part])}": given[part] for part in _ORDER if part in given})


def _ending(part: str, content: BinaryIO) -> str:
    """Say what the file of a part ends in, by its first bytes."""
    beginning = content.read(_BEGINNING)
    if part in ("photo", *_PICTURES):
        return ending_of(beginning)
    return sketch_ending(beginning)


class _Pieces:
    """A file that is read in pieces: a table of members that is longer than one is no project's."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self.seek, self.tell, self.seekable, self.close = file.seek, file.tell, file.seekable, file.close

    def read(self, size: int = -1) -> bytes:
        """Read at most one piece.

        Raises
        ------
        zipfile.BadZipFile
            There is more, and all of it is asked for.
        """
        if size < 0 or size > _PIECE:
            found = self._file.read(_PIECE + 1)
            if len(found) > _PIECE:
                raise zipfile.BadZipFile("its table of members is too long")
            return found
        return self._file.read(size)


def _members(archive: zipfile.ZipFile, name: str) -> dict[str, zipfile.ZipInfo]:
    """Find a project's parts; no part may be there twice."""
    found: dict[str, zipfile.ZipInfo] = {}
    for info in archive.infolist():
        part = "photo" if PurePosixPath(info.filename).stem == "photo" else _NAMES.get(info.filename)
        if part in found:
            what = f"{info.filename} is not its only {part}; export it anew"
            raise TreestrokeError(f"{name}: {what}", code="project_unreadable")
        if part is not None:
            found[part] = info
    return found


def _check_whole(parts: Container[str], name: str) -> None:
    try:
        check_parts(parts)
    except TreestrokeError as error:
        raise TreestrokeError(f"{name}: in the project, {error}", code="project_unreadable") from error


def _check_sizes(archive: zipfile.ZipFile, members: Mapping[str, zipfile.ZipInfo], name: str) -> None:
    """Judge from the table of members, and from a photo's first bytes, what unpacking would take."""
    room = MAX_TEXT_BYTES
    for part, info in members.items():
        if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise NotImplementedError(f"{info.filename} is neither stored nor deflated")
        text = info.filename.endswith(".json")
        limit = min(_limit(archive, part, info), room if text else MAX_STORED_BYTES)
        if info.file_size > limit:
            what = f"{info.filename} has {info.file_size / 1e6:.1f} MB, more than the {limit / 1e6:.1f} MB"
            raise TreestrokeError(f"{name}: {what} that it may have; make it smaller", code="project_too_large")
        room -= info.file_size if text else 0


def _limit(archive: zipfile.ZipFile, part: str, info: zipfile.ZipInfo) -> int:
    """Say how many bytes a part may have: a photo as many as its pixels need, where it was stored by a service."""
    if part == "photo":
        with archive.open(info) as member:
            return most_stored_bytes(member.read(PHOTO_HEAD))
    if part == "settings":
        return MAX_SETTINGS_BYTES
    if part in _PICTURES:
        return MAX_LEAF_BYTES
    return MAX_SKETCH_BYTES if info.filename.endswith(".png") else MAX_TEXT_BYTES


def _content(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> bytes:
    out = io.BytesIO()
    with archive.open(info) as member:
        shutil.copyfileobj(member, out, _PIECE)
    return out.getvalue()


def _settings(text: bytes, name: str) -> dict[str, Any]:
    value = read_json(text, SettingsError, f"{name}: settings.json is", "export the project anew")
    if not isinstance(value, dict):
        what = "settings.json must hold an object; export the project anew"
        raise SettingsError(f"{name}: {what}", code="wrong_type")
    return value
