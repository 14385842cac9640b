"""Edits of visible branches as JSON: the one description that requests, files and the API's document follow."""

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, FailFast, Field, JsonValue, WithJsonSchema
from pydantic.json_schema import SkipJsonSchema

from treestroke.limits import MAX_COORDINATE, MAX_EDIT_POINTS, MAX_EDITS
from treestroke.wire_strokes import Number, RequestPart, no_default

EDITS_EXAMPLE: list[JsonValue] = [
    {"do": "remove", "at": [0.12, 1.4, -0.3]},
    {"do": "add", "from": [0.02, 1.1, 0.01], "points": [[0.2, 1.3, 0.1], [0.4, 1.6, 0.15]], "radius": 0.02},
]

_Coordinate = Annotated[Number, Field(ge=-MAX_COORDINATE, le=MAX_COORDINATE)]
_TRIPLE: dict[str, Any] = {"type": "array", "prefixItems": [{"type": "number"}] * 3, "minItems": 3, "maxItems": 3}
Place = Annotated[list[_Coordinate], Field(min_length=3, max_length=3), FailFast(), WithJsonSchema(_TRIPLE)]
"""X, Y and Z in the capture's frame, that of `GET /v1/captures/{id}`."""
Radius = Annotated[Number, Field(gt=0, le=MAX_COORDINATE)]


class RemoveEdit(RequestPart):
    """Removes the branch from the joint nearest ``at`` on, with all that leaves it."""

    do: Literal["remove"]
    at: Place


class AddEdit(RequestPart):
    """Adds a branch from the joint nearest ``from`` through points; without a radius it is thinner than its parent."""

    do: Literal["add"]
    start: Place = Field(alias="from")
    points: Annotated[list[Place], Field(min_length=1, max_length=MAX_EDIT_POINTS), FailFast()]
    radius: Radius | SkipJsonSchema[None] = Field(
        default=None, description="where it starts", json_schema_extra=no_default
    )


class MoveEdit(RequestPart):
    """Moves the joint nearest ``at``; what is beyond it goes with it, the stretch back to the last fork bends along."""

    do: Literal["move"]
    at: Place
    to: Place


class RadiusEdit(RequestPart):
    """Gives the joint nearest ``at`` a radius; beyond it all radii are scaled alike, back to the last fork less."""

    do: Literal["radius"]
    at: Place
    radius: Radius


class JoinEdit(RequestPart):
    """Hangs the piece that the joint nearest ``at`` belongs to onto the joint nearest ``to``."""

    do: Literal["join"]
    at: Place
    to: Place


Edit = Annotated[RemoveEdit | AddEdit | MoveEdit | RadiusEdit | JoinEdit, Discriminator("do")]
EditList = Annotated[list[Edit], Field(max_length=MAX_EDITS), FailFast()]


class Edits(RequestPart):
    """Edits of the visible branches of a capture's tree, in the order in which they are applied."""

    model_config = ConfigDict(json_schema_extra={"example": {"edits": EDITS_EXAMPLE}})

    edits: EditList
