"""Project files: NAME.treestroke, a ZIP of photo, strokes.json and settings.json."""

import io
import json
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any

from treestroke.codec.image import MAX_BYTES
from treestroke.core.errors import SettingsError, TreestrokeError

MAX_TEXT_BYTES = 64_000_000
"""More than the longest strokes that are allowed ever need."""


@dataclass(frozen=True)
class Project:
    """The photo's bytes, the strokes' JSON text, and the settings by name (``seed`` may be among them)."""

    photo: bytes
    strokes: bytes
    settings: dict[str, Any]


def read_project(data: bytes, name: str) -> Project:
    """Open a project file; ``name`` appears in messages.

    The photo is the one member called ``photo`` with any ending; settings.json may be absent.

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
                raise TreestrokeError(f"{name}: the project needs one photo and strokes.json; export it anew")
            photo = _member(archive, members[photos[0]], MAX_BYTES, name)
            strokes = _member(archive, members["strokes.json"], MAX_TEXT_BYTES, name)
            has_settings = "settings.json" in members
            settings = _member(archive, members["settings.json"], MAX_TEXT_BYTES, name) if has_settings else b"{}"
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise TreestrokeError(f"{name}: this is no project file that can be read ({error}); export it anew") from error
    return Project(photo, strokes, _settings(settings, name))


def _member(archive: zipfile.ZipFile, info: zipfile.ZipInfo, limit: int, name: str) -> bytes:
    if info.file_size > limit:
        raise TreestrokeError(f"{name}: {info.filename} has more than {limit // 10**6} MB; make it smaller")
    return archive.read(info)


def _settings(text: bytes, name: str) -> dict[str, Any]:
    try:
        value = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise SettingsError(f"{name}: settings.json is no valid JSON ({error}); export the project anew") from error
    if not isinstance(value, dict):
        raise SettingsError(f"{name}: settings.json must hold an object; export the project anew")
    return value
