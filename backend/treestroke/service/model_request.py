"""Requests for a model, read and checked in all that can be checked without their photo."""

import base64
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from treestroke.codec.image import MAX_LEAF_BYTES, decode_fruit, decode_leaf
from treestroke.codec.inputs import VIEWS, check_parts
from treestroke.codec.sketch import encode_sketch, parse_sketch, sketch_from
from treestroke.codec.sketch_picture import PNG, without_metadata
from treestroke.codec.strokes import encode_strokes, strokes_from
from treestroke.core.errors import FruitError, LeafError, StrokesError, TreestrokeError
from treestroke.core.pipeline.settings import check_seed, plain_settings, settings_from
from treestroke.core.stroke_rules import Place, require_trunk
from treestroke.core.types import Picture
from treestroke.schemas import MAX_LEAF_TEXT, NAME_PATTERN
from treestroke.service.bodies import check_keys, inside, read_object, read_value
from treestroke.service.files import check_files

MAX_NAME, MAX_ID = 200, 40
SKETCHES = "sketches"
_PICTURES: Mapping[str, tuple[type[LeafError | FruitError], Callable[[bytes, str], Picture]]] = {
    "leaf": (LeafError, decode_leaf),
    "fruit": (FruitError, decode_fruit),
}
_TEXTS = ("strokes", "settings", "seed")
_COMMON = ("settings", "seed", "name", *_PICTURES)
_NAME, _HALF_PAIR = re.compile(NAME_PATTERN), re.compile("[\ud800-\udfff]")


@dataclass(frozen=True)
class Wish:
    """A request for a model.

    What is drawn is text or a picture again: that passes between processes at once, however many points there are.

    Attributes
    ----------
    photo
        A stored photo's id; None where the request names none.
    parts
        What else the tree is made of, by name: strokes, front, side, leaf, fruit.
    within
        Keys to what holds front and side in the request.
    """

    photo: str | None
    parts: dict[str, bytes]
    settings: dict[str, Any]
    seed: int
    name: str
    within: Place


def read_wish(body: bytes) -> Wish:
    """Read a request for a model from JSON.

    Raises
    ------
    TreestrokeError
        It is no such request, or something in it cannot be used; the pointer leads into the request.
    """
    request = read_object(body)
    check_keys(request, (), ("photo", "strokes", SKETCHES, *_COMMON))
    sketches = _views(request.get(SKETCHES, {}))
    check_parts({*request, *sketches}, (SKETCHES,))
    photo = request.get("photo")
    if "photo" in request and (not isinstance(photo, str) or len(photo) > MAX_ID):
        raise TreestrokeError.at(("photo",), "it must be a photo's id; upload the photo first", "wrong_type")
    parts = {view: _sketch(sketches[view], (SKETCHES, view)) for view in sketches}
    parts |= {name: _decoded(request[name], name) for name in _PICTURES if name in request}
    return _wish(photo, parts, request, (SKETCHES,))


def read_fields(fields: dict[str, bytes], brings_photo: bool = True) -> Wish:
    """Read a request for a model from a form's fields but the photo; those that are empty are absent.

    Strokes, settings and seed are JSON text, sketches JSON text or PNGs, leaf and fruit PNGs; the name is plain.

    Raises
    ------
    TreestrokeError
        As `read_wish`.
    """
    check_keys(fields, (), ("strokes", *VIEWS, *_COMMON))
    given = {key: content for key, content in fields.items() if content.strip()}
    check_parts({*given, "photo"} if brings_photo else given, ())
    parts = {view: _sketch_file(given[view], view) for view in VIEWS if view in given}
    parts |= {name: given[name] for name in _PICTURES if name in given}
    request: dict[str, Any] = {name: read_value(given[name], name) for name in _TEXTS if name in given}
    request["name"] = fields.get("name", b"").decode("utf-8", "surrogateescape")
    return _wish(None, parts, request, ())


def read_name(body: bytes) -> str:
    """Read a request for another name.

    Raises
    ------
    TreestrokeError
        It is no such request, or the name cannot be used.
    """
    request = read_object(body)
    check_keys(request, ("name",), ())
    return check_name(request["name"])


def check_name(name: object) -> str:
    """Give a model's name back.

    Raises
    ------
    TreestrokeError
        It is no text of at most `MAX_NAME` characters, or has some that are none of a line of text.
    """
    if not isinstance(name, str) or len(name) > MAX_NAME or not _NAME.fullmatch(name) or _HALF_PAIR.search(name):
        what = f"it must be one line of at most {MAX_NAME} characters; leave out line ends and other controls"
        raise TreestrokeError.at(("name",), what, "name_invalid")
    return name


def _wish(photo: str | None, parts: dict[str, bytes], request: Mapping[str, Any], within: Place) -> Wish:
    """Check what all requests may hold."""
    if "strokes" in request:
        parts = {"strokes": _strokes(request["strokes"]), **parts}
    for name in parts.keys() & _PICTURES.keys():
        _check_picture(parts[name], name)
    seed, name = check_seed(request.get("seed", 0)), check_name(request.get("name", ""))
    return Wish(photo, parts, _settings(request.get("settings", {})), seed, name, within)


def _views(sketches: object) -> Mapping[str, Any]:
    if not isinstance(sketches, dict):
        raise TreestrokeError.at((SKETCHES,), "it must be an object with front and side", "wrong_type")
    check_keys(sketches, (), VIEWS, (SKETCHES,))
    return sketches


def _sketch(value: Any, place: Place) -> bytes:
    """Read a sketch from plain values; give it as a file holds it, without metadata."""
    try:
        sketch = sketch_from(value)
        return encode_sketch(sketch) if sketch.ink is None else without_metadata(base64.b64decode(value["picture"]))
    except StrokesError as error:
        raise inside(place, error) from error


def _sketch_file(content: bytes, view: str) -> bytes:
    """Read a sketch from a form's file."""
    if not content.startswith(PNG):
        return _sketch(read_value(content, view), (view,))
    try:
        parse_sketch(content, view)
        return without_metadata(content)
    except StrokesError as error:
        raise inside((view,), error) from error


def _strokes(value: object) -> bytes:
    try:
        given = strokes_from(value)
        require_trunk(given)
    except StrokesError as error:
        raise inside(("strokes",), error) from error
    return encode_strokes(given).encode()


def _decoded(text: object, name: str) -> bytes:
    """Read the picture of a leaf or fruit from base64."""
    refusal, _ = _PICTURES[name]
    if not isinstance(text, str) or len(text) > MAX_LEAF_TEXT:
        what = f"it must be base64 of a PNG of at most {MAX_LEAF_BYTES // 10**6} MB"
        raise refusal.at((name,), what, "wrong_type")
    try:
        return base64.b64decode(text, validate=True)
    except ValueError as error:
        raise refusal.at((name,), "this is no base64; encode the PNG anew", f"{name}_unreadable") from error


def _check_picture(content: bytes, name: str) -> None:
    refusal, decode = _PICTURES[name]
    try:
        decode(content, name)
    except refusal as error:
        raise inside((name,), error) from error


def _settings(given: object) -> dict[str, Any]:
    if not isinstance(given, dict):
        raise TreestrokeError.at(("settings",), "it must be an object; leave it out for defaults", "wrong_type")
    try:
        chosen = settings_from(given)
        check_files(chosen)
        return plain_settings(chosen)
    except TreestrokeError as error:
        raise inside(("settings",), error) from error
