"""What a client sends: strokes, sketches and pictures as plain values for JSON."""

import base64
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypedDict

from treestroke.schemas import PhotoInfo
from treestroke.wire_strokes import CaptureStrokes, FrameStrokes, Sketch, Strokes

StrokesLike = Strokes | Mapping[str, Any] | str | os.PathLike[str]
"""Strokes, the same as a plain mapping, or the path of their JSON file."""
FrameStrokesLike = FrameStrokes | Mapping[str, Any] | str | os.PathLike[str]
"""Strokes over a frame of a clip, the same as a plain mapping, or the path of their JSON file."""
ViewsLike = CaptureStrokes | Mapping[str, Any] | str | os.PathLike[str]
"""Strokes over photos of a capture, the same as a plain mapping, or the path of their JSON file."""
PictureLike = str | os.PathLike[str] | bytes
"""The path of a picture, or its bytes."""
SketchLike = Sketch | Mapping[str, Any] | str | os.PathLike[str]
"""A sketch, the same as a plain mapping, or the path of its JSON file or of a PNG."""
_PNG = b"\x89PNG"


class Cutouts(TypedDict, total=False):
    """Pictures of what the tree is to bear: a path or the bytes of a PNG of a leaf, or of a fruit, cut out."""

    leaf: PictureLike | None
    fruit: PictureLike | None


class TreeOptions(Cutouts, total=False):
    """Options of a request for a tree, all of which may be left out; `Cutouts` among them.

    Attributes
    ----------
    name
        The tree's name.
    idempotency_key
        The same key with the same request returns the same model, for a day, from another process too; a new key by
        default.
    """

    name: str
    idempotency_key: str | None


class SiblingOptions(TypedDict, total=False):
    """Options of `Client.siblings`, all of which may be left out.

    Attributes
    ----------
    envelope
        What their crowns fill, seen from the front: heart, triangle, circle or pentagon, or an outline as
        ``{"points": [[x, y], ...]}``.
    scene
        Whether ``tree.grove.glb`` is among the files: all of them beside each other.
    seed
        A seed other than the model's.
    name
        The new model's name.
    """

    envelope: str | Mapping[str, Any]
    scene: bool
    seed: int
    name: str


class TraceOptions(TypedDict, total=False):
    """Options of `Client.trace_capture` and `Client.trace_clip`, all of which may be left out.

    Attributes
    ----------
    rev
        The answer repeats it.
    grow
        Also grow the whole tree's skeleton, by ``settings``.
    """

    rev: int
    grow: bool
    settings: Mapping[str, Any]


class PhotoOptions(TreeOptions, total=False):
    """Options of `Client.grow`: also a sketch of the tree's left ``side``, from which its branches have their depth."""

    side: SketchLike | None


class SketchOptions(TreeOptions, total=False):
    """Options of `Client.grow_sketches`: also the ``photo`` that the front was drawn over, which gives the colours."""

    photo: PhotoInfo | str | None


def plain_strokes(strokes: StrokesLike | ViewsLike | FrameStrokesLike) -> dict[str, Any]:
    """Return strokes over a photo, over those of a capture, or over a frame of a clip, as plain values."""
    if isinstance(strokes, Strokes | CaptureStrokes):
        return strokes.model_dump(mode="json", exclude_none=True)
    if isinstance(strokes, Mapping):
        return dict(strokes)
    plain: dict[str, Any] = json.loads(Path(strokes).read_bytes())
    return plain


def plain_sketches(front: SketchLike, side: SketchLike | None) -> dict[str, Any]:
    """Return sketches as plain values, by view."""
    return {"front": plain_sketch(front)} | ({} if side is None else {"side": plain_sketch(side)})


def plain_sketch(sketch: SketchLike) -> dict[str, Any]:
    """Return a sketch as plain values; a picture as base64."""
    if isinstance(sketch, Sketch):
        return dict(sketch.model_dump(mode="json", exclude_none=True))
    if isinstance(sketch, Mapping):
        return dict(sketch)
    content = Path(sketch).read_bytes()
    if content.startswith(_PNG):
        return {"picture": base64.b64encode(content).decode()}
    return dict(json.loads(content))


def plain_options(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return `TreeOptions` but the key as a request's JSON has them.

    Raises
    ------
    TypeError
        There is no such option.
    """
    if unknown := options.keys() - TreeOptions.__annotations__.keys():
        raise TypeError(f"there are no options {', '.join(sorted(unknown))}")
    pictures = {name: options[name] for name in Cutouts.__annotations__ if options.get(name) is not None}
    encoded = {name: base64.b64encode(file_bytes(picture)).decode() for name, picture in pictures.items()}
    return {"name": options.get("name", ""), **encoded}


def file_bytes(file: PictureLike) -> bytes:
    """Return the bytes of a file that is given by its path or its bytes."""
    return file if isinstance(file, bytes) else Path(file).read_bytes()
