"""Requests for a model, read and checked in everything that can be checked without their photo."""

import base64
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from treestroke.codec.branch_edits import edits_of, encode_edits
from treestroke.codec.capture_strokes import capture_strokes_of, encode_capture_strokes
from treestroke.codec.image import decode_cutout
from treestroke.codec.inputs import SIDES, check_parts, part_of
from treestroke.codec.json_text import read_json
from treestroke.codec.refusals import checked, inside
from treestroke.codec.sketch import encode_sketch, picture_of, sketch_of
from treestroke.codec.sketch_picture import PNG, read_picture, without_metadata
from treestroke.codec.strokes import encode_frame_strokes, encode_strokes, frame_strokes_of, strokes_of
from treestroke.core.errors import StrokesError, TreestrokeError
from treestroke.core.pipeline.settings import plain_settings, settings_from
from treestroke.core.stroke_rules import Place, require_trunk
from treestroke.core.strokes import CaptureStrokes, FrameStrokes, Sketch, Strokes
from treestroke.service.files import check_files
from treestroke.wire_requests import FormRequest, ModelChange, ModelRequest, Rename, TreeRequest
from treestroke.wire_strokes import PictureSketch, Sketches
from treestroke.wire_strokes import Sketch as SketchRequest

_JSON_FIELDS = ("strokes", "settings", "seed")


@dataclass(frozen=True, eq=False)
class Drawing:
    """The drawn parts of a request as values: strokes over a photo, a capture or a clip, and sketches by view."""

    strokes: Strokes | None
    sketches: Mapping[str, Sketch]
    views: CaptureStrokes | None = None
    frame: FrameStrokes | None = None


@dataclass(frozen=True, eq=False)
class ModelOrder:
    """A request for a model that was read and checked.

    Attributes
    ----------
    photo, capture, clip
        The id of a stored photo, of a capture, or of a clip; None where the request names none.
    parts
        What else the tree is made of, as files: strokes, views, frame_strokes, edits, front, side, leaf, fruit.
    drawing
        The strokes and sketches among them as values, to be checked against the photo, the capture or the clip.
    settings
        All settings by name, plain values.
    within
        The keys that lead to front and side in the request.
    """

    photo: str | None
    capture: str | None
    clip: str | None
    parts: dict[str, bytes]
    drawing: Drawing
    settings: dict[str, Any]
    seed: int
    name: str
    within: Place


def read_order(body: bytes) -> ModelOrder:
    """Return the request for a model that JSON holds.

    Raises
    ------
    TreestrokeError
        It is not such a request, or something in it cannot be used; the pointer leads into the request.
    """
    request = checked(ModelRequest, read_body(body), TreestrokeError)
    sketches = request.sketches or Sketches()
    within: Place = ("sketches",)
    _check_source(request, {*request.model_fields_set, *sketches.model_fields_set}, within)
    return _order(request, sketches, within)


def read_form(fields: Mapping[str, bytes], brings_photo: bool = True) -> ModelOrder:
    """Return the request for a model that a form's fields hold, its photo apart; empty fields count as absent.

    Strokes, settings and seed are JSON text, sketches JSON text or PNGs, leaf and fruit PNGs; the name is plain.

    Raises
    ------
    TreestrokeError
        As `read_order`.
    """
    values: dict[str, Any] = {key: _field(key, content) for key, content in fields.items() if content.strip()}
    name = fields.get("name", b"").decode("utf-8", "surrogateescape")
    request = checked(FormRequest, {**values, "name": name}, TreestrokeError)
    check_parts({*values, "photo"} if brings_photo else values, ())
    return _order(request, request, ())


def read_name(body: bytes) -> str:
    """Return the new name that a request holds.

    Raises
    ------
    TreestrokeError
        It is not such a request, or the name cannot be used.
    """
    return checked(Rename, read_body(body), TreestrokeError).name


def read_change(body: bytes) -> dict[str, object]:
    """Return a model's new name, its new tags or both, by the columns of its row; each tag once, without spaces around.

    Raises
    ------
    TreestrokeError
        It is not such a request, it holds neither, or something in it cannot be used.
    """
    change = checked(ModelChange, read_body(body), TreestrokeError).model_dump(exclude_unset=True)
    if not change:
        raise TreestrokeError("body: there is neither a name nor are there tags; send one of them")
    if (tags := change.get("tags")) is not None:
        change["tags"] = list(dict.fromkeys(tag for one in tags if (tag := one.strip())))
    return change


def read_body(body: bytes) -> Any:
    """Return the value of a request's JSON.

    Raises
    ------
    StrokesError
        It is not JSON, or longer than the longest strokes need.
    """
    return read_json(body, StrokesError, "body: it is", "send valid JSON")


def _check_source(request: ModelRequest, sent: set[str], within: Place) -> None:
    """Check that what was sent makes a tree: a capture's photos come by its id, a clip's strokes are called strokes."""
    if request.capture is not None:
        _refuse_others(request, "capture", ("photo", "strokes", "sketches", "clip"))
        check_parts({*sent, "photos"})
        return
    for key in ("views", "edits"):
        if key in request.model_fields_set:
            fault = f"missing: {key} need a capture; send its id too"
            raise TreestrokeError.at(("capture",), fault, "missing_key")
    if request.clip is not None:
        _refuse_others(request, "clip", ("photo", "sketches"))
        if request.strokes is None:
            fault = "missing: a clip needs strokes over one of its frames; send them too"
            raise TreestrokeError.at(("strokes",), fault, "missing_key")
        return
    if request.strokes is not None and "frame" in request.strokes.model_fields_set:
        fault = "there is a frame, but no clip; send the clip's id too, or leave the frame out"
        raise TreestrokeError.at(("clip",), fault, "missing_key")
    check_parts(sent, within)


def _refuse_others(request: ModelRequest, decided: str, keys: tuple[str, ...]) -> None:
    """Refuse what belongs to another source than the one that is ``decided``."""
    other = next((key for key in keys if key in request.model_fields_set), None)
    if other is not None:
        fault = f"there is a {decided} too, and a tree is made of one of them; leave the other out"
        raise TreestrokeError.at((other,), fault, "strokes_and_sketch")


def _field(key: str, content: bytes) -> Any:
    """Return a form's field as the value that its description checks."""
    if key in _JSON_FIELDS or (key in SIDES and not content.startswith(PNG)):
        return read_json(content, StrokesError, f"{key}: it is", "send valid JSON")
    return content


def _order(request: ModelRequest | FormRequest, sketches: Sketches | FormRequest, within: Place) -> ModelOrder:
    """Return what a checked request asks for, its parts as files and as values."""
    parts, views, frame = _named_parts(request) if isinstance(request, ModelRequest) else ({}, None, None)
    drawn: dict[str, Sketch] = {}
    strokes = None
    if request.strokes is not None and frame is None:
        strokes = _strokes(request)
        parts["strokes"] = encode_strokes(strokes).encode()
    for view, sketch in (("front", sketches.front), ("side", sketches.side)):
        if sketch is not None:
            parts[view], drawn[view] = _sketch(sketch, (*within, view))
    for name, picture in (("leaf", request.leaf), ("fruit", request.fruit)):
        if picture is not None:
            parts[name] = _cutout(picture, name)
    drawing, settings = Drawing(strokes, drawn, views, frame), _settings(request)
    ids = (request.photo, request.capture, request.clip) if isinstance(request, ModelRequest) else (None, None, None)
    return ModelOrder(*ids, parts, drawing, settings, request.seed, request.name, within)


def _named_parts(request: ModelRequest) -> tuple[dict[str, bytes], CaptureStrokes | None, FrameStrokes | None]:
    """Return what was drawn over a capture or a clip that a request names, as files and as values."""
    parts, views, frame = {}, _views(request), _frame(request)
    if views is not None:
        parts["views"] = encode_capture_strokes(views).encode()
    if request.edits:
        parts["edits"] = encode_edits(edits_of(request.edits)).encode()
    if frame is not None:
        parts["frame_strokes"] = encode_frame_strokes(frame).encode()
    return parts, views, frame


def _views(request: ModelRequest) -> CaptureStrokes | None:
    """Return a request's strokes over the photos of a capture, where it has some."""
    try:
        return None if request.views is None else capture_strokes_of(request.views)
    except StrokesError as error:
        raise inside(("views",), error) from error


def _frame(request: ModelRequest) -> FrameStrokes | None:
    """Return a request's strokes over a frame of a clip, where it names one."""
    if request.clip is None or request.strokes is None:
        return None
    try:
        return frame_strokes_of(request.strokes)
    except StrokesError as error:
        raise inside(("strokes",), error) from error


def _strokes(request: TreeRequest) -> Strokes:
    """Return a request's strokes, which must have a trunk."""
    assert request.strokes is not None
    try:
        strokes = strokes_of(request.strokes)
        require_trunk(strokes)
    except StrokesError as error:
        raise inside(("strokes",), error) from error
    return strokes


def _sketch(sketch: SketchRequest | bytes, place: Place) -> tuple[bytes, Sketch]:
    """Return a sketch as its file, without metadata, and as a value."""
    try:
        if isinstance(sketch, bytes):
            return without_metadata(sketch), read_picture(sketch)
        if isinstance(sketch.root, PictureSketch):
            data, pictured = picture_of(sketch.root)
            return without_metadata(data), pictured
        lines = sketch_of(sketch)
        return encode_sketch(lines), lines
    except StrokesError as error:
        raise inside(place, error) from error


def _cutout(picture: str | bytes, name: str) -> bytes:
    """Return the PNG of a leaf or fruit, decoded from base64 where it came in JSON."""
    refusal = part_of(name).refusal
    try:
        content = picture if isinstance(picture, bytes) else base64.b64decode(picture, validate=True)
    except ValueError as error:
        raise refusal.at((name,), "this is not base64; encode the PNG again", f"{name}_unreadable") from error
    try:
        decode_cutout(content, name, refusal)
    except refusal as error:
        raise inside((name,), error) from error
    return content


def _settings(request: TreeRequest) -> dict[str, Any]:
    try:
        chosen = settings_from(request.settings.model_dump())
        check_files(chosen)
    except TreestrokeError as error:
        raise inside(("settings",), error) from error
    return plain_settings(chosen)
