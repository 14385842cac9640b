"""Refusals of requests and files: what pydantic found, as code, JSON pointer, what is wrong and how to mend it."""

import json
from collections.abc import Mapping
from numbers import Real
from typing import Any, NamedTuple, TypeVar

from pydantic import BaseModel, ValidationError

from treestroke.core.errors import SettingsError, TreestrokeError, shown
from treestroke.core.pipeline.settings import MAX_SEED, settings_from
from treestroke.core.stroke_rules import NO_TRUNK, Place
from treestroke.limits import MAX_CANVAS, MAX_FRAME, MAX_LEAF_BYTES, MAX_NAME, MAX_REV, MAX_SKETCH_BYTES, MIN_CANVAS

M = TypeVar("M", bound=BaseModel)


class Rule(NamedTuple):
    """How one kind of fault is told; ``up`` says how many keys of its place the pointer leaves out."""

    code: str
    text: str
    up: int = 0


_PAIR = Rule("wrong_type", "a point is a pair [x, y], not {count} values; give two numbers")
_LENGTH = Rule("scale_invalid", "it has {count} points, it needs 2; draw a straight line")
_MANY = Rule("too_many_strokes", "there are {count} {key}, at most {max_length} are allowed; leave some out", 1)
_TRUNK = Rule("trunk_missing", NO_TRUNK)
_CANVAS = Rule(
    "canvas_invalid",
    f"it must be [width, height], whole numbers from {MIN_CANVAS} to {MAX_CANVAS}; give the drawing's size, px",
)
_PLACE = Rule("wrong_type", "it must be a place [X, Y, Z] in the capture's frame; give three numbers")
_NO_EDIT = Rule("edit_unknown", 'it must be an edit with "do" one of {expected_tags}; give one')
_NOT_PNG = Rule("wrong_type", f"it must be base64 of a PNG of at most {MAX_LEAF_BYTES // 10**6} MB; encode it again")

_PLACES = ("at", "from", "to")
"""Keys of an edit that hold a place."""
_BY_KEY_AND_TYPE = {
    ("name", "string_too_short"): Rule("name_invalid", "it is empty; write one"),
    ("crown", "missing"): Rule("crown_missing", "it is missing; draw one stroke around the foliage"),
    ("points", "missing"): Rule("missing_key", "it has no points; give [[x, y], ...]", 1),
    ("points", "too_long"): Rule(
        "too_many_points", "it has {count} points, at most {max_length} are allowed; thin them out", 1
    ),
    ("points", "too_short"): Rule(
        "stroke_too_short", "it has {count} points, at least {min_length} are needed; draw it longer", 1
    ),
    ("point", "too_short"): _PAIR,
    ("point", "too_long"): _PAIR,
    ("width", "greater_than"): Rule("width_invalid", "{value} is not a width; give pixels above 0 or leave it out"),
    ("branches", "missing"): _TRUNK,
    ("branches", "too_short"): _TRUNK,
    ("branches", "too_long"): _MANY,
    ("erase", "too_long"): _MANY,
    ("scale/points", "too_short"): _LENGTH,
    ("scale/points", "too_long"): _LENGTH,
    ("metres", "missing"): Rule("missing_key", "it has no metres; give the line's length", 1),
    ("metres", "greater_than"): Rule("scale_invalid", "{value} metres is not a length; give metres above 0"),
    ("canvas", "tuple_type"): Rule("wrong_type", "it must be a list [width, height], not {kind}; give one"),
    ("picture", "string_too_long"): Rule(
        "sketch_too_large_file", f"the picture has more than {MAX_SKETCH_BYTES // 10**6} MB; save it smaller"
    ),
    ("picture", "string_type"): Rule("wrong_type", "it must be a PNG in base64, not {kind}; encode it again"),
    ("name", "missing"): Rule("missing_key", "it is missing; send it"),
    **{(key, "missing"): Rule("missing_key", "it is missing; give a place [X, Y, Z]") for key in _PLACES},
    ("edits", "too_long"): Rule("too_many_edits", "there are {count}, at most {max_length} are allowed; drop some"),
    ("added points", "missing"): Rule("missing_key", "it has no points; give [[X, Y, Z], ...]", 1),
    ("added points", "too_long"): Rule(
        "too_many_points", "it has {count} points, at most {max_length} are allowed; thin them out", 1
    ),
    ("added points", "too_short"): Rule("stroke_too_short", "it has no points; draw it longer", 1),
}
"""By the key at fault (`point`: one of ``points``) and pydantic's type of error."""

_BY_KEY = {
    "canvas": _CANVAS,
    "name": Rule(
        "name_invalid", f"it must be one line of at most {MAX_NAME} characters; leave out line ends and other controls"
    ),
    "seed": Rule("seed_invalid", f"{{value}} is not allowed; give a whole number from 0 to {MAX_SEED}"),
    "photo": Rule("wrong_type", "it must be a photo's id; upload the photo first"),
    "clip": Rule("wrong_type", "it must be a clip's id; upload the clip first"),
    "frame": Rule("frame_missing", f"{{value}} is not a frame; give a whole number from 0 to {MAX_FRAME}"),
    "capture": Rule("wrong_type", "it must be a capture's id; make a capture first"),
    **dict.fromkeys(_PLACES, _PLACE),
    "added point": _PLACE,
    "radius": Rule("radius_invalid", "{value} is not a radius; give a length above 0 in the capture's frame"),
    "leaf": _NOT_PNG,
    "fruit": _NOT_PNG,
    "rev": Rule("wrong_type", f"it must be a whole number, at most {MAX_REV}; send one or leave it out"),
    "grow": Rule("wrong_type", "it must be true or false; send one of these"),
}

_BY_TYPE = {
    "missing": Rule("missing_key", "it is missing; send it"),
    "no_object": Rule("wrong_type", "it must be an object with {allowed}, not {kind}; send one"),
    "null": Rule("wrong_type", "it must not be null; leave it out or give a value"),
    "list_type": Rule("wrong_type", "it must be a list, not {kind}; give one"),
    "float_type": Rule("wrong_type", "a number is needed, not {kind}; give one"),
    "union_tag_invalid": _NO_EDIT,
    "union_tag_not_found": Rule("edit_unknown", 'it says nothing to "do"; give remove, add, move, radius or join'),
    "finite_number": Rule("non_finite_number", "{value} is not finite; give a number that is"),
}
_OTHER = Rule("wrong_type", "{problem}; correct it")


def checked(model: type[M], value: object, kind: type[TreestrokeError]) -> M:
    """Return a value that was read from JSON as the model that describes it.

    Raises
    ------
    TreestrokeError
        Of the given kind: the value is not what the model describes; the pointer leads from the value as a whole.
    """
    try:
        return model.model_validate(value)
    except ValidationError as error:
        raise _refusal(error, value, kind) from None


def inside(place: Place, error: TreestrokeError) -> TreestrokeError:
    """Return an error with its pointer led from the whole request, of which ``place`` was read alone."""
    return type(error)(str(error), code=error.code, pointer="".join(f"/{key}" for key in place) + error.pointer)


def _refusal(error: ValidationError, value: object, kind: type[TreestrokeError]) -> TreestrokeError:
    """Return the first fault that pydantic found as an error of ours."""
    fault = error.errors(include_url=False)[0]
    place, found, facts = _place(fault["loc"], value, fault["type"] == "missing"), fault["input"], fault.get("ctx", {})
    key = facts["key"][0] if "key" in facts else ""
    if fault["type"] == "unknown_key" and place != ("settings",):
        message = f"the key {shown(key)} is unknown; allowed are {facts['allowed']}"
        return kind.at(place, message, "unknown_key", key=str(key))
    if "key" in facts:
        place = (*place, key)
    if place[:1] == ("settings",) and len(place) > 1:
        return _setting_refusal(str(place[1]), value)
    key, place = _key_at(place)
    rule = _BY_KEY_AND_TYPE.get((key, fault["type"])) or _BY_KEY.get(key) or _BY_TYPE.get(fault["type"], _OTHER)
    place = place[: len(place) - rule.up]
    told = {
        "count": facts.get("actual_length"),
        "value": json.dumps(found) if isinstance(found, float) else shown(found),  # NaN, not nan
        "kind": _kind_of(found),
        "problem": fault["msg"],
    }
    return kind.at(place, rule.text.format_map({**facts, **told, "key": key}), rule.code)


def _setting_refusal(name: str, request: Any) -> TreestrokeError:
    """Return what the settings' own table says of one setting of a request.

    Raises
    ------
    ValueError
        The table allows it: then the model that was made of the table differs from it.
    """
    try:
        settings_from({name: request["settings"][name]})
    except SettingsError as error:
        return inside(("settings",), error)
    raise ValueError(f"the description of the setting {name} is not its table's")


def _place(location: tuple[int | str, ...], value: Any, missing: bool) -> Place:
    """Return the keys that lead through the value to a fault; pydantic's names of union members are left out."""
    place: list[str | int] = []
    for key in location:
        index = isinstance(value, list | tuple) and isinstance(key, int) and key < len(value)
        if index or (isinstance(value, Mapping) and key in value):
            place.append(key)
            value = value[key]
    return (*place, location[-1]) if missing else tuple(place)


def _key_at(place: Place) -> tuple[str, Place]:
    """Return the key by which a fault's rule is found, and the place that its pointer leads to."""
    if "canvas" in place:
        return "canvas", place[: place.index("canvas") + 1]
    if "points" in place:
        at = place.index("points")
        added = "added " if "edits" in place else ""
        if len(place) > at + 1:
            return f"{added}point", place[: at + 2]
        if added:
            return "added points", place
        return ("scale/points" if place[:at] == ("scale",) else "points"), place
    if len(place) > 1 and place[-2] in _PLACES:
        return str(place[-2]), place[:-1]
    return (place[-1] if place and isinstance(place[-1], str) else ""), place


def _kind_of(value: object) -> str:
    """Name a value's type as JSON's readers know it."""
    names = {dict: "an object", list: "a list", str: "text", bool: "true or false", type(None): "null"}
    return names.get(type(value), "a number" if isinstance(value, Real) else type(value).__name__)
