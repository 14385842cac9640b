"""Project files: NAME.treestroke, a ZIP of photo, strokes.json, settings.json and perhaps leaf.png."""

import io
import json
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any

from treestroke.codec.archive import zipped
from treestroke.codec.image import MAX_LEAF_BYTES, MAX_STORED_BYTES, StoredPhoto
from treestroke.codec.json_text import read_json
from treestroke.core.errors import SettingsError, TreestrokeError

MAX_TEXT_BYTES = 64_000_000
"""More than the longest strokes that are allowed ever need."""


LEAF = "leaf.png"
_ENDINGS = {b"\xff\xd8": "jpg", b"RIFF": "webp"}


@dataclass(frozen=True)
class Project:
    """The photo's bytes, the strokes' JSON text, the settings by name (``seed`` may be among them), a leaf's picture.

    What a service stored may be larger than an upload, so the photo in a project may be, too.
    """

    photo: bytes
    strokes: bytes
    settings: dict[str, Any]
    leaf: bytes | None = None


def read_project(data: bytes, name: str) -> Project:
    """Open a project file; ``name`` appears in messages.

    The photo is the one member called ``photo`` with any ending; settings.json and leaf.png may be absent.

    Raises
    ------
    TreestrokeError
        No ZIP, damaged, or without photo or strokes.
    SettingsError
        settings.json holds no JSON object.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = {info.filename: info for info in archive.infolist()}
            photos = sorted(member for member in members if PurePosixPath(member).stem == "photo")
            if len(photos) != 1 or "strokes.json" not in members:
                what = "the project needs one photo and strokes.json; export it anew"
                raise TreestrokeError(f"{name}: {what}", code="project_unreadable")
            photo = _member(archive, members[photos[0]], MAX_STORED_BYTES, name)
            strokes = _member(archive, members["strokes.json"], MAX_TEXT_BYTES, name)
            has_settings = "settings.json" in members
            settings = _member(archive, members["settings.json"], MAX_TEXT_BYTES, name) if has_settings else b"{}"
            leaf = _member(archive, members[LEAF], MAX_LEAF_BYTES, name) if LEAF in members else None
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        what = f"this is no project file that can be read ({error}); export it anew"
        raise TreestrokeError(f"{name}: {what}", code="project_unreadable") from error
    return Project(StoredPhoto(photo), strokes, _settings(settings, name), leaf)


def write_project(project: Project) -> bytes:
    """Write a project file that `read_project` reads back; equal projects give equal bytes."""
    ending = next((ending for start, ending in _ENDINGS.items() if project.photo.startswith(start)), "png")
    settings = json.dumps(project.settings, indent=2, sort_keys=True).encode()
    leaf = {} if project.leaf is None else {LEAF: project.leaf}
    return zipped(
        {f"photo.{ending}": project.photo, "strokes.json": project.strokes, "settings.json": settings, **leaf}
    )


def _member(archive: zipfile.ZipFile, info: zipfile.ZipInfo, limit: int, name: str) -> bytes:
    if info.file_size > limit:
        what = f"{info.filename} has more than {limit // 10**6} MB; make it smaller"
        raise TreestrokeError(f"{name}: {what}", code="project_too_large")
    return archive.read(info)


def _settings(text: bytes, name: str) -> dict[str, Any]:
    value = read_json(text, SettingsError, f"{name}: settings.json is", "export the project anew")
    if not isinstance(value, dict):
        what = "settings.json must hold an object; export the project anew"
        raise SettingsError(f"{name}: {what}", code="wrong_type")
    return value
