"""Project files: NAME.treestroke, a ZIP of a tree's inputs and settings.json."""

import io
import json
import shutil
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, BinaryIO, cast

from treestroke.codec.archive import zip_into
from treestroke.codec.image import PHOTO_HEAD, StoredPhoto, most_stored_bytes
from treestroke.codec.inputs import BEGINNING, PARTS, TEXT, Format, Inputs, Part, check_parts, part_of
from treestroke.codec.json_text import read_json
from treestroke.core.errors import SettingsError, TreestrokeError
from treestroke.limits import MAX_TEXT_BYTES

MAX_SETTINGS_BYTES = 100_000
_SETTINGS = "settings"
_ORDER = ("photo", "strokes", "clip", "frame_strokes", "front", "side", _SETTINGS)
"""Members that come first, in this order; all other parts follow in theirs."""
_PIECE = 1_000_000
"""Bytes that are read at once, and the longest table of members that is read."""


@dataclass(frozen=True)
class Project:
    """What a project file holds: a tree's inputs, and its settings by name, ``seed`` perhaps among them."""

    inputs: Inputs[bytes]
    settings: dict[str, Any]


def stored_inputs(parts: Mapping[str, bytes]) -> Inputs[bytes]:
    """Return the inputs that a service or a project file keeps.

    Their photo may be larger than an upload: it is stored without loss.

    Raises
    ------
    TreestrokeError
        As `check_parts`.
    """
    return Inputs.of({name: stored_part(name, part) for name, part in parts.items()})


def stored_part(name: str, content: bytes) -> bytes:
    """Return the bytes of a part that a service or a project file keeps, as `stored_inputs` does."""
    return StoredPhoto(content) if part_of(name).kind == "photo" else content


def read_project(file: BinaryIO, name: str) -> Project:
    """Open a project file; ``name`` appears in messages.

    Each part is a member ``name.ending`` with one of the endings of its formats (a photo: with any); other members are
    ignored. The size of every part is checked before it is unpacked.

    Raises
    ------
    TreestrokeError
        Not a ZIP file, damaged, without the parts of a tree, or with a part that is too large.
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
        fault = f"this is not a readable project file ({error}); export it again"
        raise TreestrokeError(f"{name}: {fault}", code="project_unreadable") from error
    settings = _settings(contents.pop(_SETTINGS, b"{}"), name)
    return Project(stored_inputs(contents), settings)


def write_project(out: BinaryIO, parts: Mapping[str, BinaryIO], settings: Mapping[str, Any]) -> None:
    """Write parts and settings as a project file that `read_project` reads back.

    The file's bytes depend on nothing else.
    """
    members = {**parts, _SETTINGS: io.BytesIO(json.dumps(settings, indent=2, sort_keys=True).encode())}
    order = [*_ORDER, *(name for name in PARTS if name not in _ORDER)]
    names = sorted(members, key=lambda name: order.index(name.partition("/")[0]))
    zip_into(out, {f"{name}.{_format(name, members[name]).ending}": members[name] for name in names})


def _format(name: str, content: BinaryIO) -> Format:
    return TEXT if name == _SETTINGS else part_of(name).format_of(content.read(BEGINNING))


class _Pieces:
    """A file that is read in pieces; a table of members that is longer than one piece is refused."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self.seek, self.tell, self.seekable, self.close = file.seek, file.tell, file.seekable, file.close

    def read(self, size: int = -1) -> bytes:
        """Read at most one piece.

        Raises
        ------
        zipfile.BadZipFile
            All that is left is asked for, and it is longer than one piece.
        """
        if size < 0 or size > _PIECE:
            found = self._file.read(_PIECE + 1)
            if len(found) > _PIECE:
                raise zipfile.BadZipFile("its table of members is too long")
            return found
        return self._file.read(size)


def _members(archive: zipfile.ZipFile, name: str) -> dict[str, zipfile.ZipInfo]:
    """Find a project's members by the names of their parts; no part may be there twice."""
    found: dict[str, zipfile.ZipInfo] = {}
    for info in archive.infolist():
        part = _part_name(info.filename)
        if part in found:
            fault = f"{info.filename} is not its only {part}; export it again"
            raise TreestrokeError(f"{name}: {fault}", code="project_unreadable")
        if part is not None:
            found[part] = info
    return found


def _part_name(member: str) -> str | None:
    """Return the part (or ``settings``) that a member holds; None where it holds neither."""
    name, dot, ending = member.rpartition(".")
    name = name if dot else member
    if member == f"{_SETTINGS}.{TEXT.ending}":
        return _SETTINGS
    try:
        part = part_of(name)
    except ValueError:
        return None
    return name if part.kind == "photo" or ending in _endings(part) else None


def _endings(part: Part) -> set[str]:
    return {file_format.ending for file_format in part.formats}


def _check_whole(names: Iterable[str], name: str) -> None:
    try:
        check_parts(names)
    except TreestrokeError as error:
        raise TreestrokeError(f"{name}: in the project, {error}", code="project_unreadable") from error


def _check_sizes(archive: zipfile.ZipFile, members: Mapping[str, zipfile.ZipInfo], name: str) -> None:
    """Check the sizes that the table of members tells; all texts together may have `MAX_TEXT_BYTES`."""
    text_bytes_left = MAX_TEXT_BYTES
    for part, info in members.items():
        if info.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise NotImplementedError(f"{info.filename} is neither stored nor deflated")
        text = info.filename.endswith(TEXT.ending)
        limit = _limit(archive, part, info)
        limit = min(limit, text_bytes_left) if text else limit
        if info.file_size > limit:
            fault = f"{info.filename} has {info.file_size / 1e6:.1f} MB, more than the {limit / 1e6:.1f} MB"
            raise TreestrokeError(f"{name}: {fault} that it may have; make it smaller", code="project_too_large")
        text_bytes_left -= info.file_size if text else 0


def _limit(archive: zipfile.ZipFile, name: str, info: zipfile.ZipInfo) -> int:
    """Return the most bytes that a member may have; for a photo, as many as its pixels need to be stored."""
    if name == _SETTINGS:
        return MAX_SETTINGS_BYTES
    part = part_of(name)
    if part.kind == "photo":
        with archive.open(info) as member:
            return most_stored_bytes(member.read(PHOTO_HEAD))
    return next(file_format.max_bytes for file_format in part.formats if info.filename.endswith(file_format.ending))


def _content(archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> bytes:
    out = io.BytesIO()
    with archive.open(info) as member:
        shutil.copyfileobj(member, out, _PIECE)
    return out.getvalue()


def _settings(text: bytes, name: str) -> dict[str, Any]:
    value = read_json(text, SettingsError, f"{name}: settings.json is", "export the project again")
    if not isinstance(value, dict):
        fault = "settings.json must hold an object; export the project again"
        raise SettingsError(f"{name}: {fault}", code="wrong_type")
    return value
