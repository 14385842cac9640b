"""What a command's arguments name: the parts of a tree, and settings."""

import argparse
import os
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from treestroke.codec.inputs import BESIDE, PARTS, Inputs
from treestroke.codec.photo_kinds import ACCEPTED_FORMATS, PHOTO_ENDINGS
from treestroke.core.errors import TreestrokeError
from treestroke.core.pipeline.settings import ModelSettings, Several, Span

if TYPE_CHECKING:
    from treestroke.service.loading import PartLike


class UsageError(TreestrokeError):
    """The command itself is wrong."""


def inputs_of(options: argparse.Namespace) -> tuple["Inputs[PartLike]", dict[str, Any]]:
    """Return what the tree is made of, and a project's settings, the seed among them."""
    parts, project_path = _parts(options), _project_path(options)
    if project_path is None:
        if options.first in ("photo", "photos", "clip") and not {"strokes", "views", "frame_strokes"} & parts.keys():
            raise UsageError("--strokes is missing; name the strokes' JSON file")
        return Inputs.of(parts), {}
    from treestroke.service.loading import load_project

    for name in parts:
        if name not in BESIDE:
            flag = "strokes" if PARTS[name].kind in ("views", "frame_strokes") else name
            raise UsageError(f"--{flag}: a project has its own {flag}; leave the flag out")
    project = load_project(project_path)
    return Inputs.of({**project.inputs.parts, **parts}), project.settings


def _project_path(options: argparse.Namespace) -> str | None:
    """Return the project that the command reads, where it reads one."""
    first = getattr(options, options.first)
    named = first if isinstance(first, list) else [first]
    return named[0] if len(named) == 1 and named[0].endswith(".treestroke") else None


def _parts(options: argparse.Namespace) -> dict[str, str]:
    """Return the paths of the files that the tree is made of, a project apart, by part."""
    paths = {name: getattr(options, name, None) for name in PARTS}
    if _project_path(options) is not None:
        paths[options.first] = None
    photos = paths.pop("photos")
    several = {} if photos is None else {f"photos/{path.name}": str(path) for path in _photos(photos)}
    return {name: path for name, path in paths.items() if path is not None} | several


def _photos(named: Sequence[str]) -> list[Path]:
    """Return the photos that paths name, those of folders in the order of their names.

    Raises
    ------
    UsageError
        A folder has no photo, or two photos have one name.
    """
    found: list[Path] = []
    for path in map(Path, named):
        inside = (
            sorted(file for file in path.iterdir() if file.suffix.lower() in PHOTO_ENDINGS) if path.is_dir() else [path]
        )
        if not inside:
            raise UsageError(f"{path}: there is no photo in this folder; name one that has {ACCEPTED_FORMATS}")
        found += inside
    names = [path.name for path in found]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise UsageError(f"{twice}: two photos have this name; rename one, for strokes name photos by it")
    return found


def read_by(options: argparse.Namespace) -> set[str]:
    """Return the resolved paths of all files that the command reads."""
    project = _project_path(options)
    return {os.path.realpath(path) for path in (*_parts(options).values(), *([project] if project else []))}


def chosen_settings(options: argparse.Namespace) -> dict[str, Any]:
    """Return the settings that flags name, and the seed."""
    flags = {entry.name: getattr(options, entry.name, None) for entry in fields(ModelSettings)}
    settings: dict[str, Any] = {name: _value(name, text) for name, text in flags.items() if text is not None}
    return settings if options.seed is None else {**settings, "seed": whole(options.seed)}


def _value(name: str, text: str | bool) -> object:
    """Read a flag's value as the setting's kind; what does not fit stays text, which the settings refuse by name."""
    allowed = {entry.name: entry.metadata["allowed"] for entry in fields(ModelSettings)}[name]
    if isinstance(text, bool):
        return text
    if isinstance(allowed, Several):
        return [name.strip() for name in text.split(",") if name.strip()]
    if not isinstance(allowed, Span):
        return text
    try:
        return int(text) if allowed.whole else float(text)
    except ValueError:
        return text


def project_stem(path: str) -> str:
    """Return what the names of the files begin with that are made of a project.

    Raises
    ------
    UsageError
        It is no project: a GLB holds neither branches nor photo.
    """
    if not path.endswith(".treestroke"):
        fault = "siblings are made of a project, which holds what the tree was made of"
        raise UsageError(f"{path}: {fault}; name the tree's NAME.treestroke")
    return Path(path).stem


def whole(text: str) -> Any:
    """Return a flag's value as an int; what is no whole number stays text, which is refused by name."""
    try:
        return int(text)
    except ValueError:
        return text
