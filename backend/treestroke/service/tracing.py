"""What runs in a tracing process: photos and strokes from outside, decoded and checked where a crash costs nothing.

Each process remembers the photos that it saw last, with their foliage, so that one more stroke is answered at once.
"""

import base64
import json
import re
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from treestroke.codec.image import MAX_LEAF_BYTES, Picture, decode_leaf, decode_photo, decode_stored, encode_stored
from treestroke.codec.json_text import read_json
from treestroke.codec.strokes import encode_strokes, parse_strokes, strokes_from
from treestroke.core.errors import LeafError, StrokesError, TreestrokeError, shown
from treestroke.core.pipeline.settings import check_seed, plain_settings, settings_from
from treestroke.core.stroke_rules import MAX_POINTS, MAX_STROKES, mend_strokes, require_trunk
from treestroke.schemas import MAX_LEAF_TEXT, NAME_PATTERN
from treestroke.service.files import check_files
from treestroke.service.trace import Trace, trace
from treestroke.store.blobs import Blobs

MAX_REV = 2**53 - 1
MAX_NAME, MAX_ID = 200, 40
_NAME, _HALF_PAIR = re.compile(NAME_PATTERN), re.compile("[\ud800-\udfff]")
_DEFAULTS: Mapping[str, Any] = {}
_KEPT_PIXELS = 60_000_000
"""Of the photos that one process remembers."""


@dataclass
class Known:
    """A photo's pixels and its last trace."""

    picture: Picture
    last: Trace | None = None


@dataclass(frozen=True)
class Wish:
    """A request for a model, checked in all that can be checked without its photo.

    The strokes are JSON text again: that passes between processes at once, however many points there are.
    """

    photo: str
    strokes: bytes
    settings: dict[str, Any]
    seed: int
    name: str
    leaf: bytes | None = None


_MOST_SIGNS = {b"[": 1.1 * MAX_STROKES * MAX_POINTS, b"{": 1000 * MAX_STROKES, b",": 2.2 * MAX_STROKES * MAX_POINTS}
"""What the longest strokes need, and some for names and unknown keys, which are told from them later."""
_known: OrderedDict[Path, Known] = OrderedDict()


def keep_photo(folder: Path, content: bytes) -> tuple[str, int, int]:
    """Decode an uploaded photo and store its upright pixels; give the blob, the width and the height.

    Raises
    ------
    PhotoError
        As `decode_photo`.
    """
    picture = decode_photo(content, "photo")
    return Blobs(folder).put(encode_stored(picture)), picture.shape[1], picture.shape[0]


def trace_answer(photo: Path, body: bytes) -> bytes:
    """Trace a stored photo by a request's body; give the answer as JSON.

    Raises
    ------
    StrokesError
        The body is no such request, or its strokes cannot be used.
    """
    request = _object(body)
    rev, grow = request.pop("rev", None), request.pop("grow", False)
    if rev is not None and not (type(rev) is int and abs(rev) <= MAX_REV):
        raise StrokesError.at(("rev",), f"it must be a whole number, at most {MAX_REV}", "wrong_type")
    if not isinstance(grow, bool):
        raise StrokesError.at(("grow",), "it must be true or false", "wrong_type")
    known = _recall(photo)
    known.last = trace(known.picture, strokes_from(request), known.last, grow)
    return json.dumps({"rev": rev, **known.last.answer()}, separators=(",", ":")).encode()


def read_wish(body: bytes) -> Wish:
    """Read a request for a model from JSON.

    Raises
    ------
    TreestrokeError
        It is no such request, or something in it cannot be used; the pointer leads into the request.
    """
    request = _object(body)
    _check_keys(request, ("photo", "strokes"), ("settings", "seed", "name", "leaf"))
    if not isinstance(request["photo"], str) or len(request["photo"]) > MAX_ID:
        raise TreestrokeError.at(("photo",), "it must be a photo's id; upload the photo first", "wrong_type")
    leaf = _decoded_leaf(request.pop("leaf")) if "leaf" in request else None
    return _wish(**request, leaf=leaf)


def read_fields(fields: dict[str, bytes]) -> Wish:
    """Read a request for a model from a form's fields but the photo, each JSON text (the name plain, the leaf a PNG).

    Raises
    ------
    TreestrokeError
        As `read_wish`.
    """
    _check_keys(fields, ("strokes",), ("settings", "seed", "name", "leaf"))
    texts = {key: text for key, text in fields.items() if key not in ("name", "leaf") and text.strip()}
    given: dict[str, Any] = {"strokes": None} | {key: _json(text, key) for key, text in texts.items()}
    name = fields.get("name", b"").decode("utf-8", "surrogateescape")
    return _wish("", **given, name=name, leaf=fields.get("leaf") or None)


def check_wish(photo: Path, strokes: bytes) -> None:
    """Check a request's strokes against its photo, so that what is accepted can be made.

    Raises
    ------
    StrokesError
        They cannot be used; the pointer leads into the request.
    """
    height, width = _recall(photo).picture.shape[:2]
    try:
        mend_strokes(parse_strokes(strokes, "strokes"), width, height)
    except StrokesError as error:
        raise _inside("strokes", error) from error


def read_name(body: bytes) -> str:
    """Read a request for another name.

    Raises
    ------
    TreestrokeError
        It is no such request, or the name cannot be used.
    """
    request = _object(body)
    _check_keys(request, ("name",), ())
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


def _wish(
    photo: str,
    strokes: object,
    settings: object = _DEFAULTS,
    seed: object = 0,
    name: object = "",
    leaf: bytes | None = None,
) -> Wish:
    try:
        given = strokes_from(strokes)
        require_trunk(given)
    except StrokesError as error:
        raise _inside("strokes", error) from error
    if leaf is not None:
        _check_leaf(leaf)
    return Wish(photo, encode_strokes(given).encode(), _settings(settings), check_seed(seed), check_name(name), leaf)


def _decoded_leaf(text: object) -> bytes:
    if not isinstance(text, str) or len(text) > MAX_LEAF_TEXT:
        what = f"it must be base64 of a PNG of at most {MAX_LEAF_BYTES // 10**6} MB"
        raise LeafError.at(("leaf",), what, "wrong_type")
    try:
        return base64.b64decode(text, validate=True)
    except ValueError as error:
        raise LeafError.at(("leaf",), "this is no base64; encode the PNG anew", "leaf_unreadable") from error


def _check_leaf(leaf: bytes) -> None:
    try:
        decode_leaf(leaf, "leaf")
    except LeafError as error:
        raise LeafError(str(error), code=error.code, pointer="/leaf") from error


def _settings(given: object) -> dict[str, Any]:
    if not isinstance(given, dict):
        raise TreestrokeError.at(("settings",), "it must be an object; leave it out for defaults", "wrong_type")
    try:
        chosen = settings_from(given)
        check_files(chosen)
        return plain_settings(chosen)
    except TreestrokeError as error:
        raise _inside("settings", error) from error


def _check_keys(request: Mapping[str, object], needed: Sequence[str], others: Sequence[str]) -> None:
    known = (*needed, *others)
    for key in request:
        if key not in known:
            what = f"the key {shown(key)} is unknown; allowed are {', '.join(known)}"
            raise TreestrokeError.at((), what, "unknown_key", key=key)
    for key in needed:
        if key not in request:
            raise TreestrokeError.at((key,), "it is missing; send it", "missing_key")


def _recall(photo: Path) -> Known:
    """Remember a photo, or read it, and forget those that were used longest ago."""
    known = _known.pop(photo, None) or Known(decode_stored(photo.read_bytes()))
    _known[photo] = known
    while len(_known) > 1 and sum(one.picture.size // 3 for one in _known.values()) > _KEPT_PIXELS:
        _known.popitem(last=False)
    return known


def _object(body: bytes) -> dict[str, Any]:
    value = _json(body, "body")
    if not isinstance(value, dict):
        raise StrokesError.at((), "the body must be a JSON object; send one", "wrong_type")
    return value


def _json(text: bytes, what: str) -> Any:
    """Read JSON that holds no more than the longest strokes need: anything else would take minutes and gigabytes."""
    if any(text.count(sign) > most for sign, most in _MOST_SIGNS.items()):
        most = f"more than {MAX_STROKES} strokes of {MAX_POINTS} points need"
        raise StrokesError(f"{what}: it holds {most}; thin them out", code="too_many_points")
    return read_json(text, StrokesError, f"{what}: it is", "send valid JSON")


def _inside(member: str, error: TreestrokeError) -> TreestrokeError:
    """Lead an error's pointer from the whole request."""
    return type(error)(str(error), code=error.code, pointer=f"/{member}{error.pointer}")
