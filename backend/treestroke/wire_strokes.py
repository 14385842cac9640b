"""Strokes and sketches as JSON: the one description that requests, files and the API's document follow."""

from collections.abc import Callable, Mapping
from types import NoneType
from typing import Annotated, Any, get_args

from pydantic import (
    AllowInfNan,
    BaseModel,
    ConfigDict,
    Discriminator,
    FailFast,
    Field,
    JsonValue,
    PlainSerializer,
    RootModel,
    Strict,
    Tag,
    WithJsonSchema,
    WrapValidator,
    model_validator,
)
from pydantic.json_schema import SkipJsonSchema
from pydantic_core import PydanticCustomError

from treestroke.limits import (
    MAX_CANVAS,
    MAX_FRAME,
    MAX_NAME,
    MAX_PHOTOS,
    MAX_POINTS,
    MAX_SKETCH_BYTES,
    MAX_STROKES,
    MIN_CANVAS,
)

_CROWN: list[JsonValue] = [[210, 300], [390, 120], [610, 140], [760, 330], [700, 560], [480, 640], [270, 560]]
STROKES_EXAMPLE: dict[str, JsonValue] = {
    "crown": {"points": _CROWN},
    "branches": [{"points": [[490, 900], [488, 760], [484, 600], [480, 420]], "width": 34.0}],
}


def no_default(schema: dict[str, Any]) -> None:
    """Leave a default of None out of a schema that does not allow null."""
    schema.pop("default")


def text_length(data_bytes: int) -> int:
    """Return how many characters base64 needs for so many bytes."""
    return 4 * -(-data_bytes // 3)


class Wire(BaseModel):
    """Base of everything that travels over HTTP: only the keys that are named."""

    # Validators are built at their first use: reading one stroke file needs few of them.
    model_config = ConfigDict(extra="forbid", defer_build=True)


class RequestPart(Wire):
    """Base of everything that a request holds: the first key that is unknown or null ends the reading."""

    @model_validator(mode="before")
    @classmethod
    def _check_keys(cls, value: object) -> object:
        if isinstance(value, cls):
            return value
        fields = {field.alias or name: field for name, field in cls.model_fields.items()}
        allowed = ", ".join(fields)
        if not isinstance(value, Mapping):
            raise PydanticCustomError("no_object", "an object with {allowed} is needed", {"allowed": allowed})
        for key, item in value.items():
            # The key is wrapped in a list: pydantic writes a bare one into its message, which a lone surrogate breaks.
            if key not in fields:
                raise PydanticCustomError("unknown_key", "unknown key", {"key": [key], "allowed": allowed})
            if item is None and NoneType not in get_args(fields[key].annotation):
                raise PydanticCustomError("null", "null", {"key": [key]})
        return value


def _unchanged(points: Any, check: Callable[[Any], object]) -> Any:
    """Check points and return them as they came: a copy of two million would take 130 MB."""
    check(points)
    return points


def _as_is(points: Any) -> Any:
    return points


Number = Annotated[float, Strict(), AllowInfNan(False)]
Positive = Annotated[Number, Field(gt=0)]
_PAIR = {"type": "array", "prefixItems": [{"type": "number"}, {"type": "number"}], "minItems": 2, "maxItems": 2}
Point = Annotated[list[Number], Field(min_length=2, max_length=2), FailFast(), WithJsonSchema(_PAIR)]
_CHECKED_ONLY = (FailFast(), WrapValidator(_unchanged), PlainSerializer(_as_is))
CrownPoints = Annotated[list[Point], Field(min_length=3, max_length=MAX_POINTS), *_CHECKED_ONLY]
LinePoints = Annotated[list[Point], Field(min_length=2, max_length=MAX_POINTS), *_CHECKED_ONLY]


class CrownStroke(RequestPart):
    """A stroke around the foliage; its last point is joined to its first."""

    points: CrownPoints = Field(description="pixels of the upright photo, x and y")


class BranchStroke(RequestPart):
    """A stroke along a branch, from its parent outward; the first runs from the root up the trunk."""

    points: LinePoints
    width: Positive | SkipJsonSchema[None] = Field(default=None, description="pixels", json_schema_extra=no_default)


class EraseStroke(RequestPart):
    """A stroke across traced branches that are to go."""

    points: LinePoints


class KnownLength(RequestPart):
    """A straight line over something of known length, as far from the camera as the tree; it sets the tree's height."""

    points: Annotated[list[Point], Field(min_length=2, max_length=2), FailFast()]
    metres: Positive = Field(description="the line's length")


Branches = Annotated[list[BranchStroke], Field(max_length=MAX_STROKES - 1), FailFast()]


class Strokes(RequestPart):
    """What was drawn over a photo."""

    model_config = ConfigDict(json_schema_extra={"example": STROKES_EXAMPLE})

    crown: CrownStroke
    branches: Branches = Field(default_factory=list)
    erase: Annotated[list[EraseStroke], Field(max_length=MAX_STROKES - 1), FailFast()] = Field(default_factory=list)
    scale: KnownLength | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)


class FrameStrokes(Strokes):
    """What was drawn over one frame of a clip; of its branches, even the trunk may be absent."""

    frame: Annotated[int, Strict(), Field(ge=0, le=MAX_FRAME)] = Field(
        default=0, description="the frame's index, among the frames at the clip's even rate"
    )


PhotoName = Annotated[str, Strict(), Field(min_length=1, max_length=MAX_NAME)]


class ViewStrokes(RequestPart):
    """What was drawn over one of several photos."""

    photo: PhotoName = Field(description="the photo's file name")
    crown: CrownStroke
    branches: Branches = Field(default_factory=list)
    erase: Annotated[list[EraseStroke], Field(max_length=MAX_STROKES - 1), FailFast()] = Field(default_factory=list)


class LengthInPhoto(KnownLength):
    """A straight line over something of known length that stands beside the tree, in one of the photos."""

    photo: PhotoName = Field(description="the photo's file name")


class CameraDistance(RequestPart):
    """How far apart two photos were taken."""

    photos: Annotated[list[PhotoName], Field(min_length=2, max_length=2), FailFast()] = Field(
        description="the photos' file names"
    )
    metres: Positive


def _kind_of_scale(value: object) -> str:
    """Tell the distance between two cameras, which has a key ``photos``, from a drawn length."""
    cameras = isinstance(value, CameraDistance) or (isinstance(value, Mapping) and "photos" in value)
    return "cameras" if cameras else "length"


Scale = Annotated[
    Annotated[LengthInPhoto, Tag("length")] | Annotated[CameraDistance, Tag("cameras")],
    Discriminator(_kind_of_scale),
]


class CaptureStrokes(RequestPart):
    """What was drawn over the photos of a tree."""

    views: Annotated[list[ViewStrokes], Field(min_length=1, max_length=MAX_PHOTOS), FailFast()]
    scale: Scale | SkipJsonSchema[None] = Field(
        default=None, description="sets the tree's scale in place of its height", json_schema_extra=no_default
    )


_Side = Annotated[int, Strict(), Field(ge=MIN_CANVAS, le=MAX_CANVAS)]


class StrokeSketch(RequestPart):
    """One side of a tree as strokes, over a photo or on white; without a canvas it is as large as what was drawn."""

    canvas: tuple[_Side, _Side] | SkipJsonSchema[None] = Field(
        default=None, description="width and height, pixels", json_schema_extra=no_default
    )
    crown: CrownStroke | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
    branches: Annotated[Branches, Field(min_length=1)] = Field(description="the trunk first")


class PictureSketch(RequestPart):
    """One side of a tree as a picture: dark or opaque strokes, the crown as a closed line of pure red."""

    picture: Annotated[str, Strict()] = Field(
        max_length=text_length(MAX_SKETCH_BYTES),
        description="PNG, base64",
        json_schema_extra={"contentEncoding": "base64", "contentMediaType": "image/png"},
    )


def _kind_of_sketch(value: object) -> str:
    """Tell a picture, which has a key of that name, from lines."""
    pictured = isinstance(value, PictureSketch) or (isinstance(value, Mapping) and "picture" in value)
    return "pixels" if pictured else "lines"


class Sketch(RootModel[Any]):
    """One side of a tree, drawn."""

    model_config = ConfigDict(defer_build=True)

    root: Annotated[
        Annotated[StrokeSketch, Tag("lines")] | Annotated[PictureSketch, Tag("pixels")],
        Discriminator(_kind_of_sketch),
    ]


class Sketches(RequestPart):
    """A tree drawn from the front and from its left; the side alone goes with a photo and strokes."""

    front: Sketch | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
    side: Sketch | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
