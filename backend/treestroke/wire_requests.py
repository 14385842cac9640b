"""Requests as JSON and as forms: the one description that checks them and that the API's document follows."""

from dataclasses import Field as Entry
from dataclasses import fields
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import ConfigDict, Field, JsonValue, Strict, WithJsonSchema, create_model
from pydantic.json_schema import SkipJsonSchema

from treestroke.core.pipeline import settings as table
from treestroke.core.pipeline.settings import MAX_SEED, Choice, Several, Span, Toggle
from treestroke.core.siblings.outlines import SHAPES
from treestroke.limits import (
    MAX_ID,
    MAX_LEAF_BYTES,
    MAX_NAME,
    MAX_REV,
    MAX_SHARE_DAYS,
    MAX_TAG,
    MAX_TAGS,
    SHARE_DAYS,
)
from treestroke.wire_edits import EDITS_EXAMPLE, EditList
from treestroke.wire_strokes import (
    STROKES_EXAMPLE,
    CaptureStrokes,
    CrownStroke,
    FrameStrokes,
    RequestPart,
    Sketch,
    Sketches,
    Strokes,
    no_default,
    text_length,
)

NAME_PATTERN = r"^[^\u0000-\u001f\u007f-\u009f\u2028-\u202e\u2066-\u2069]*$"
"""A line of text: no controls, no line ends, nothing that turns the direction of what follows it."""
SKETCHES_EXAMPLE: dict[str, JsonValue] = {
    "front": {"branches": [{"points": [[200, 390], [198, 250], [203, 60]]}, {"points": [[199, 260], [290, 140]]}]},
    "side": {"branches": [{"points": [[200, 390], [202, 240], [200, 60]]}, {"points": [[201, 270], [120, 150]]}]},
}
MODEL_EXAMPLE: dict[str, JsonValue] = {
    "photo": "pho_5f0c8e1d2b3a49c6d7e8f901",
    "strokes": STROKES_EXAMPLE,
    "settings": {"height": 14},
    "seed": 1,
    "name": "The old oak",
}
VIEWS_EXAMPLE: dict[str, JsonValue] = {"views": [{"photo": "IMG_03.jpg", **STROKES_EXAMPLE}]}
_HOW_TO_TRACE: dict[str, JsonValue] = {"rev": 7, "grow": False}


def _photo_id(schema: dict[str, Any]) -> None:
    """Document a photo's id where it may be absent."""
    no_default(schema)
    schema["pattern"] = "^pho_[0-9a-f]{24}$"


def _capture_id(schema: dict[str, Any]) -> None:
    """Document a capture's id where it may be absent."""
    no_default(schema)
    schema["pattern"] = "^cap_[0-9a-f]{24}$"


def _clip_id(schema: dict[str, Any]) -> None:
    """Document a clip's id where it may be absent."""
    no_default(schema)
    schema["pattern"] = "^clp_[0-9a-f]{24}$"


def _setting_type(allowed: table.Allowed) -> Any:
    """Return the type of what a setting may be."""
    match allowed:
        case Span(whole=whole):
            number = int if whole else float
            return Annotated[number, Strict(), Field(ge=allowed.low, le=allowed.high, allow_inf_nan=False)]
        case Choice():
            return Literal[allowed.names]
        case Toggle():
            return Annotated[bool, Strict()]
        case Several():
            return list[Literal[allowed.names]]  # type: ignore[name-defined]


def _setting_field(entry: "Entry[Any]") -> tuple[Any, Any]:
    """Return the type of one setting, and its default and meaning."""
    default = list(entry.default) if isinstance(entry.default, tuple) else entry.default
    return _setting_type(entry.metadata["allowed"]), Field(default=default, description=entry.metadata["meaning"])


if TYPE_CHECKING:
    ModelSettings = RequestPart
else:
    ModelSettings = create_model(
        "ModelSettings",
        __base__=RequestPart,
        __doc__="Settings of a model; what is absent takes its default.",
        **{entry.name: _setting_field(entry) for entry in fields(table.ModelSettings)},
    )

Rev = Annotated[int, Strict(), Field(ge=-MAX_REV, le=MAX_REV)]
Seed = Annotated[int, Strict(), Field(ge=0, le=MAX_SEED)]
Name = Annotated[str, Strict(), Field(max_length=MAX_NAME, pattern=NAME_PATTERN)]
Png = Annotated[bytes, Strict()]
EncodedPng = Annotated[
    str,
    Strict(),
    Field(
        max_length=text_length(MAX_LEAF_BYTES),
        json_schema_extra={"contentEncoding": "base64", "contentMediaType": "image/png"},
    ),
]


class TraceRequest(Strokes):
    """Strokes to trace."""

    model_config = ConfigDict(json_schema_extra={"example": {**STROKES_EXAMPLE, **_HOW_TO_TRACE}})

    rev: Rev | None = Field(default=None, description="comes back with the answer")
    grow: Annotated[bool, Strict()] = Field(default=False, description="grow the whole skeleton too, without leaves")
    side: Sketch | SkipJsonSchema[None] = Field(
        default=None, description="the tree's left side, for the grown skeleton's depth", json_schema_extra=no_default
    )
    settings: ModelSettings = Field(default_factory=ModelSettings, description="what the grown skeleton grows by")


class SketchTraceRequest(RequestPart):
    """Sketches to trace."""

    model_config = ConfigDict(json_schema_extra={"example": {**SKETCHES_EXAMPLE, **_HOW_TO_TRACE}})

    front: Sketch
    side: Sketch | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
    rev: Rev | None = Field(default=None, description="comes back with the answer")
    grow: Annotated[bool, Strict()] = Field(default=False, description="grow the whole skeleton too, without leaves")


class ClipTraceRequest(FrameStrokes):
    """Strokes over one frame of a clip to trace."""

    model_config = ConfigDict(json_schema_extra={"example": {"frame": 0, **STROKES_EXAMPLE, **_HOW_TO_TRACE}})

    rev: Rev | None = Field(default=None, description="comes back with the answer")
    grow: Annotated[bool, Strict()] = Field(default=False, description="grow the whole skeleton too, without leaves")
    settings: ModelSettings = Field(default_factory=ModelSettings, description="what the grown skeleton grows by")


class CaptureTraceRequest(CaptureStrokes):
    """Strokes over some of a solved capture's photos to trace, and edits of the branches that are found."""

    model_config = ConfigDict(json_schema_extra={"example": {**VIEWS_EXAMPLE, "edits": EDITS_EXAMPLE, **_HOW_TO_TRACE}})

    edits: EditList = Field(default_factory=list, description="applied in this order to the visible branches")
    rev: Rev | None = Field(default=None, description="comes back with the answer")
    grow: Annotated[bool, Strict()] = Field(default=False, description="grow the whole skeleton too, without leaves")
    settings: ModelSettings = Field(default_factory=ModelSettings, description="what the grown skeleton grows by")


class TreeRequest(RequestPart):
    """What a request for a model holds both as JSON and as a form."""

    strokes: Strokes | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
    settings: ModelSettings = Field(default_factory=ModelSettings)
    seed: Seed = 0
    name: Name = ""


class ModelRequest(TreeRequest):
    """A tree to be made.

    It is made of photo and strokes, perhaps with the sketch of its left side; or of sketches of its front and perhaps
    of its left side, perhaps with the photo that they were drawn over; or of a solved capture and strokes over some of
    its photos; or of a clip and strokes over one of its frames.
    """

    model_config = ConfigDict(json_schema_extra={"example": MODEL_EXAMPLE})

    photo: Annotated[str, Strict()] | SkipJsonSchema[None] = Field(
        default=None, max_length=MAX_ID, json_schema_extra=_photo_id
    )
    strokes: FrameStrokes | SkipJsonSchema[None] = Field(
        default=None, description="over the photo, or over a frame of the clip", json_schema_extra=no_default
    )
    sketches: Sketches | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
    clip: Annotated[str, Strict()] | SkipJsonSchema[None] = Field(
        default=None, max_length=MAX_ID, json_schema_extra=_clip_id
    )
    capture: Annotated[str, Strict()] | SkipJsonSchema[None] = Field(
        default=None, max_length=MAX_ID, json_schema_extra=_capture_id
    )
    views: CaptureStrokes | SkipJsonSchema[None] = Field(
        default=None, description="with a capture", json_schema_extra=no_default
    )
    edits: EditList = Field(default_factory=list, description="of the branches that a capture shows; with views")
    leaf: EncodedPng | SkipJsonSchema[None] = Field(
        default=None, description="PNG of a leaf cut out, base64", json_schema_extra=no_default
    )
    fruit: EncodedPng | SkipJsonSchema[None] = Field(
        default=None, description="PNG of a fruit cut out, base64", json_schema_extra=no_default
    )


def _text(description: str, **more: JsonValue) -> WithJsonSchema:
    """Document a form's field that is text."""
    return WithJsonSchema({"type": "string", "description": description, **more})


_SKETCH_KINDS = "application/json, image/png"
_StrokesText = Annotated[Strokes | SkipJsonSchema[None], _text("Strokes, as JSON; with a photo")]
_SettingsText = Annotated[ModelSettings, _text("ModelSettings, as JSON")]
_SeedText = Annotated[Seed, _text("a whole number from 0", pattern="^[0-9]{1,18}$")]
_FrontFile = Annotated[
    Sketch | Png | SkipJsonSchema[None],
    _text("Sketch of the front, in place of strokes: JSON or PNG", contentMediaType=_SKETCH_KINDS),
]
_SideFile = Annotated[
    Sketch | Png | SkipJsonSchema[None],
    _text("Sketch of the left side: JSON or PNG", contentMediaType=_SKETCH_KINDS),
]
_LeafFile = Annotated[Png | SkipJsonSchema[None], _text("PNG of a leaf cut out", format="binary")]
_FruitFile = Annotated[Png | SkipJsonSchema[None], _text("PNG of a fruit cut out", format="binary")]


def _without_defaults(schema: dict[str, Any]) -> None:
    """Leave defaults out of a form's schema: an absent field has no text."""
    for field in schema["properties"].values():
        field.pop("default", None)


class FormRequest(TreeRequest):
    """A tree to be made, from a form's fields; the photo, which is read apart, is not among them."""

    model_config = ConfigDict(json_schema_extra=_without_defaults)

    strokes: _StrokesText = None
    settings: _SettingsText = Field(default_factory=ModelSettings)
    seed: _SeedText = 0
    front: _FrontFile = None
    side: _SideFile = None
    leaf: _LeafFile = None
    fruit: _FruitFile = None


_OUTLINE: dict[str, JsonValue] = {
    "anyOf": [{"type": "string", "enum": list(SHAPES)}, {"$ref": "#/components/schemas/CrownStroke"}]
}


class SiblingsRequest(RequestPart):
    """Siblings of a model's tree to be made."""

    model_config = ConfigDict(json_schema_extra={"example": {"count": 3, "envelope": "heart", "scene": True}})

    count: Annotated[int, Strict(), Field(ge=1, le=16)] = 1
    envelope: Annotated[str | CrownStroke | SkipJsonSchema[None], WithJsonSchema(_OUTLINE)] = Field(
        default=None, description="what they fill: a name, or a line, y down, in any unit", json_schema_extra=no_default
    )
    scene: Annotated[bool, Strict()] = Field(default=False, description="one more file with all beside each other")
    seed: Seed | SkipJsonSchema[None] = Field(
        default=None, description="the model's own where absent", json_schema_extra=no_default
    )
    name: Name = ""


class Rename(RequestPart):
    """The new name of a capture."""

    name: Name = Field(json_schema_extra={"example": "The old oak"})


Tag = Annotated[str, Strict(), Field(min_length=1, max_length=MAX_TAG, pattern=NAME_PATTERN)]


class ModelChange(RequestPart):
    """A model's new name, its new tags, or both."""

    model_config = ConfigDict(
        json_schema_extra={"example": {"name": "The old oak", "tags": ["park", "oak"]}, "minProperties": 1}
    )

    name: Name | SkipJsonSchema[None] = Field(
        default=None, description="in place of the one that it has", json_schema_extra=no_default
    )
    tags: Annotated[list[Tag], Field(max_length=MAX_TAGS)] | SkipJsonSchema[None] = Field(
        default=None, description="in place of those that it has", json_schema_extra=no_default
    )


class ShareRequest(RequestPart):
    """A link to be made by which anybody sees a model."""

    model_config = ConfigDict(json_schema_extra={"example": {"days": 30, "photo": False, "download": True}})

    days: Annotated[int, Strict(), Field(ge=1, le=MAX_SHARE_DAYS)] = Field(
        default=SHARE_DAYS, description="how long it leads somewhere"
    )
    photo: Annotated[bool, Strict()] = Field(default=False, description="whether the photo is shown, too")
    download: Annotated[bool, Strict()] = Field(default=True, description="whether the tree is offered for download")


class CaptureRequest(RequestPart):
    """A capture to be made: photos of one tree from several places, which are added one by one."""

    model_config = ConfigDict(json_schema_extra={"example": {"name": "The old oak, all around"}})

    name: Name = ""
