"""What is drawn, as it travels over HTTP: strokes over a photo, and sketches."""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, JsonValue, RootModel
from pydantic.json_schema import SkipJsonSchema

Point = tuple[float, float]

MAX_SKETCH_TEXT = 33_333_336
"""Characters of base64 that the largest picture of a sketch needs."""
_CROWN: list[JsonValue] = [[210, 300], [390, 120], [610, 140], [760, 330], [700, 560], [480, 640], [270, 560]]
STROKES_EXAMPLE: dict[str, JsonValue] = {
    "crown": {"points": _CROWN},
    "branches": [{"points": [[490, 900], [488, 760], [484, 600], [480, 420]], "width": 34.0}],
}


def no_default(schema: dict[str, Any]) -> None:
    """Leave a default of None out of a schema that does not allow null."""
    schema.pop("default")


class Wire(BaseModel):
    """What all that travels shares: nothing but the keys that are named."""

    model_config = ConfigDict(extra="forbid")


class CrownStroke(Wire):
    """A stroke around the foliage; its last point is joined to its first."""

    points: list[Point] = Field(min_length=3, max_length=10_000, description="pixels of the upright photo, x and y")


class BranchStroke(Wire):
    """A stroke along a branch, from its parent outward; the first runs from the root up the trunk."""

    points: list[Point] = Field(min_length=2, max_length=10_000)
    width: float | SkipJsonSchema[None] = Field(default=None, gt=0, description="pixels", json_schema_extra=no_default)


class EraseStroke(Wire):
    """A stroke across traced branches that are to go."""

    points: list[Point] = Field(min_length=2, max_length=10_000)


class KnownLength(Wire):
    """A straight line over something of known length, as far from the camera as the tree; it sets the tree's height."""

    points: list[Point] = Field(min_length=2, max_length=2)
    metres: float = Field(gt=0, description="the line's length")


class Strokes(Wire):
    """What was drawn over a photo."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": STROKES_EXAMPLE})

    crown: CrownStroke
    branches: list[BranchStroke] = Field(default_factory=list, max_length=199)
    erase: list[EraseStroke] = Field(default_factory=list, max_length=199)
    scale: KnownLength | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)


class StrokeWarning(Wire):
    """Something in the strokes, or in the photo, that was mended."""

    code: str
    stroke: str = Field(description="pointer to the stroke, such as branches/1; photo where it is the photo itself")
    detail: str


class PhotoFrame(Wire):
    """Where the photo stands in the tree's world: (X, Y, Z) is pixel (root_x + X / s, root_y - Y / s)."""

    width: int
    height: int
    metres_per_pixel: float
    root: Point


_Side = Annotated[int, Field(ge=16, le=16_384)]


class StrokeSketch(Wire):
    """One side of a tree as strokes, over a photo or on white; without a canvas it is as large as what was drawn."""

    canvas: tuple[_Side, _Side] | SkipJsonSchema[None] = Field(
        default=None, description="width and height, pixels", json_schema_extra=no_default
    )
    crown: CrownStroke | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
    branches: list[BranchStroke] = Field(min_length=1, max_length=199, description="the trunk first")


class PictureSketch(Wire):
    """One side of a tree as a picture: dark or opaque strokes, the crown as a closed line of pure red."""

    picture: str = Field(
        max_length=MAX_SKETCH_TEXT,
        description="PNG, base64",
        json_schema_extra={"contentEncoding": "base64", "contentMediaType": "image/png"},
    )


class Sketch(RootModel[StrokeSketch | PictureSketch]):
    """One side of a tree, drawn."""


class Sketches(Wire):
    """A tree drawn from the front and from its left; the side alone goes with a photo and strokes."""

    front: Sketch | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
    side: Sketch | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
