"""Project files: NAME.treestroke, a ZIP of photo, strokes.json or sketches, settings.json and own pictures."""

import io
import json
import zipfile
import zlib
from collections.abc import Container
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any

from treestroke.codec.archive import zipped
from treestroke.codec.image import MAX_LEAF_BYTES, MAX_STORED_BYTES, StoredPhoto
from treestroke.codec.json_text import read_json
from treestroke.codec.photo_kinds import ending_of
from treestroke.core.errors import SettingsError, TreestrokeError
from treestroke.core.stroke_rules import Place

MAX_TEXT_BYTES = 64_000_000
"""More than the longest strokes that are allowed ever need."""

VIEWS = ("front", "side")
_PNG = b"\x89PNG"
_PICTURES = ("leaf", "fruit")
_NAMES = {
    **{f"{part}.json": part for part in ("strokes", "settings", *VIEWS)},
    **{f"{part}.png": part for part in (*VIEWS, *_PICTURES)},
}
"""Which part each member is, but the photo."""


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


def read_project(data: bytes, name: str) -> Project:
    """Open a project file; ``name`` appears in messages.

    The photo is the one member called ``photo`` with any ending; sketches are ``front`` and ``side`` with .json or
    .png; settings.json, leaf.png and fruit.png may be absent.

    Raises
    ------
    TreestrokeError
        No ZIP, damaged, or without what makes a tree.
    SettingsError
        settings.json holds no JSON object.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = _members(archive, name)
            _check_whole(members, name)
            contents = {part: _member(archive, info, _limit(part), name) for part, info in members.items()}
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        what = f"this is no project file that can be read ({error}); export it anew"
        raise TreestrokeError(f"{name}: {what}", code="project_unreadable") from error
    settings = _settings(contents.pop("settings", b"{}"), name)
    photo = StoredPhoto(contents.pop("photo")) if "photo" in contents else None
    return Project(photo, contents.pop("strokes", None), settings, **contents)


def write_project(project: Project) -> bytes:
    """Write a project file that `read_project` reads back; equal projects give equal bytes."""
    photo, front, side = project.photo or b"", project.front or b"", project.side or b""
    members = {
        f"photo.{ending_of(photo)}": project.photo,
        "strokes.json": project.strokes,
        f"front.{sketch_ending(front)}": project.front,
        f"side.{sketch_ending(side)}": project.side,
        "settings.json": json.dumps(project.settings, indent=2, sort_keys=True).encode(),
        "leaf.png": project.leaf,
        "fruit.png": project.fruit,
    }
    return zipped({name: content for name, content in members.items() if content is not None})


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


def _limit(part: str) -> int:
    """Say how many bytes a part may have."""
    if part == "photo":
        return MAX_STORED_BYTES
    return MAX_LEAF_BYTES if part in _PICTURES else MAX_TEXT_BYTES


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
