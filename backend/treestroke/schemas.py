"""What travels over HTTP, for the service's documents and its clients."""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, JsonValue
from pydantic.json_schema import SkipJsonSchema

Point = tuple[float, float]
Species = Literal[
    "auto",
    "ash",
    "beech",
    "birch",
    "cherry",
    "elm",
    "horse_chestnut",
    "larch",
    "linden",
    "locust",
    "maple",
    "oak",
    "pine",
    "plane",
    "poplar",
    "spruce",
    "walnut",
    "willow",
]
FurtherFile = Literal["gltf", "obj", "usdz", "ply", "instanced", "collision", "json", "swc", "csv"]
Status = Literal["queued", "running", "succeeded", "failed", "canceled"]

MAX_LEAF_TEXT = 5_400_000
"""Characters of base64 that the largest picture of a leaf needs."""
NAME_PATTERN = r"^[^\u0000-\u001f\u007f-\u009f\u2028-\u202e\u2066-\u2069]*$"
"""A line of text: no controls, no line ends, nothing that turns the direction of what follows it."""
_CROWN: list[JsonValue] = [[210, 300], [390, 120], [610, 140], [760, 330], [700, 560], [480, 640], [270, 560]]
STROKES_EXAMPLE: dict[str, JsonValue] = {
    "crown": {"points": _CROWN},
    "branches": [{"points": [[490, 900], [488, 760], [484, 600], [480, 420]], "width": 34.0}],
}
MODEL_EXAMPLE: dict[str, JsonValue] = {
    "photo": "pho_5f0c8e1d2b3a49c6d7e8f901",
    "strokes": STROKES_EXAMPLE,
    "settings": {"height": 14},
    "seed": 1,
    "name": "The old oak",
}


def _no_default(schema: dict[str, Any]) -> None:
    """Leave a default of None out of a schema that does not allow null."""
    schema.pop("default")


class _Wire(BaseModel):
    model_config = ConfigDict(extra="forbid")


class CrownStroke(_Wire):
    """A stroke around the foliage; its last point is joined to its first."""

    points: list[Point] = Field(min_length=3, max_length=10_000, description="pixels of the upright photo, x and y")


class BranchStroke(_Wire):
    """A stroke along a branch, from its parent outward; the first runs from the root up the trunk."""

    points: list[Point] = Field(min_length=2, max_length=10_000)
    width: float | SkipJsonSchema[None] = Field(default=None, gt=0, description="pixels", json_schema_extra=_no_default)


class EraseStroke(_Wire):
    """A stroke across traced branches that are to go."""

    points: list[Point] = Field(min_length=2, max_length=10_000)


class KnownLength(_Wire):
    """A straight line over something of known length, as far from the camera as the tree; it sets the tree's height."""

    points: list[Point] = Field(min_length=2, max_length=2)
    metres: float = Field(gt=0, description="the line's length")


class Strokes(_Wire):
    """What was drawn over a photo."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": STROKES_EXAMPLE})

    crown: CrownStroke
    branches: list[BranchStroke] = Field(default_factory=list, max_length=199)
    erase: list[EraseStroke] = Field(default_factory=list, max_length=199)
    scale: KnownLength | SkipJsonSchema[None] = Field(default=None, json_schema_extra=_no_default)


class TraceRequest(Strokes):
    """Strokes to trace."""

    model_config = ConfigDict(json_schema_extra={"example": {**STROKES_EXAMPLE, "rev": 7, "grow": False}})

    rev: int | None = Field(default=None, ge=-(2**53) + 1, le=2**53 - 1, description="comes back with the answer")
    grow: bool = Field(default=False, description="grow the whole skeleton too, without leaves")


class StrokeWarning(_Wire):
    """Something in the strokes that was mended."""

    code: str
    stroke: str
    detail: str


class PhotoFrame(_Wire):
    """Where the photo stands in the tree's world: (X, Y, Z) is pixel (root_x + X / s, root_y - Y / s)."""

    width: int
    height: int
    metres_per_pixel: float
    root: Point


class TracedSkeleton(_Wire):
    """The visible branches, in photo pixels; ``stroke`` is the stroke that a joint lies under, or -1."""

    points: list[Point]
    radii: list[float]
    parents: list[int]
    stroke: list[int]


class GrownSkeleton(_Wire):
    """The whole tree's skeleton, in metres; ``born`` is the iteration in which a joint appeared, 0 for the visible."""

    points: list[tuple[float, float, float]]
    radii: list[float]
    parents: list[int]
    born: list[int]
    photo: PhotoFrame


class TraceAnswer(_Wire):
    """What was found; ``foliage`` is closed rings by the even-odd rule."""

    rev: int | None
    foliage: list[list[Point]]
    skeleton: TracedSkeleton
    warnings: list[StrokeWarning]
    grown: GrownSkeleton | None = Field(default=None, description="with ``grow`` and a trunk stroke")
    photo: PhotoFrame | None = Field(default=None, description="with ``grown``")


class Photo(_Wire):
    """A stored photo."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "id": "pho_5f0c8e1d2b3a49c6d7e8f901",
                "width": 1200,
                "height": 1541,
                "sha256": "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
                "created": "2026-05-04T09:30:00.000Z",
                "image": "/v1/photos/pho_5f0c8e1d2b3a49c6d7e8f901/image",
            }
        }
    )

    id: str
    width: int
    height: int
    sha256: str = Field(description="of the uploaded bytes")
    created: str
    image: str = Field(description="the stored picture: PNG, upright, sRGB, without metadata")


class ModelSettings(_Wire):
    """Settings of a model; what is absent takes its default."""

    height: float = Field(default=10, ge=0.1, le=150, description="metres, from the root to the foliage's top")
    library: Literal["auto", "visible", "type1", "type2", "both"] = "auto"
    iterations: int = Field(default=300, ge=0, le=2000)
    variants: int = Field(default=1, ge=1, le=16, description="trees grown of the photo, each by the next seed")
    species: Species = "auto"
    season: Literal["photo", "spring", "summer", "autumn", "bare"] = "photo"
    foliage: Literal["auto", "leaves", "needles", "bare"] = "auto"
    leaf_size: float = Field(default=1, ge=0.3, le=3)
    leaf_density: float = Field(default=1, ge=0, le=3)
    wind: Literal["none", "breeze", "all"] = "none"
    lod: Literal["none", "files", "one"] = "none"
    compress: bool = False
    files: list[FurtherFile] = Field(default_factory=list, description="further files")


class ModelRequest(_Wire):
    """A tree that is wished for."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"example": MODEL_EXAMPLE},
    )

    photo: str = Field(max_length=40, json_schema_extra={"pattern": "^pho_[0-9a-f]{24}$"})
    strokes: Strokes
    settings: ModelSettings = ModelSettings()
    seed: int = Field(default=0, ge=0, le=2**63 - 1)
    name: str = Field(default="", max_length=200, json_schema_extra={"pattern": NAME_PATTERN})
    leaf: str | SkipJsonSchema[None] = Field(
        default=None,
        max_length=MAX_LEAF_TEXT,
        description="PNG of a leaf cut out, base64",
        json_schema_extra={"contentEncoding": "base64", "contentMediaType": "image/png", "default": None},
    )


class Rename(_Wire):
    """A model's new name."""

    name: str = Field(max_length=200, json_schema_extra={"example": "The old oak", "pattern": NAME_PATTERN})


class Failure(_Wire):
    """Why a model failed."""

    code: str
    detail: str
    retryable: bool


class Model(_Wire):
    """A tree that is made, or waits to be."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "id": "mdl_0a1b2c3d4e5f60718293a4b5",
                "name": "The old oak",
                "photo": "pho_5f0c8e1d2b3a49c6d7e8f901",
                "status": "running",
                "phase": "grow",
                "phase_fraction": 0.4,
                "progress": 0.36,
                "queue_position": None,
                "eta_s": 2.1,
                "attempt": 1,
                "error": None,
                "score": None,
                "report": None,
                "files": {"strokes.json": "/v1/models/mdl_0a1b2c3d4e5f60718293a4b5/strokes.json"},
                "settings": {"height": 14.0},
                "seed": 1,
                "engine": "treestroke 0.1.0",
                "created": "2026-05-04T09:31:00.000Z",
                "started": "2026-05-04T09:31:01.000Z",
                "finished": None,
            }
        }
    )

    id: str
    name: str
    photo: str
    status: Status
    phase: str | None = Field(description="the step under way")
    phase_fraction: float = Field(ge=0, le=1)
    progress: float = Field(ge=0, le=1)
    queue_position: int | None = Field(description="1 for the next one")
    eta_s: float | None = Field(description="seconds until it is finished, as others took")
    attempt: int
    error: Failure | None
    score: dict[str, float] | None
    report: dict[str, Any] | None = Field(description="as the command line's --report")
    files: dict[str, str]
    settings: dict[str, Any]
    seed: int
    engine: str
    created: str
    started: str | None
    finished: str | None


class ModelPage(_Wire):
    """Models, newest first; ``next`` is the cursor of the next page."""

    models: list[Model]
    next: str | None


class Fault(_Wire):
    """One field that is at fault: a JSON pointer into the request, a code, and what is wrong."""

    pointer: str
    code: str
    detail: str


class Problem(BaseModel):
    """An error (RFC 9457)."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "type": "about:blank",
                "title": "Unprocessable Content",
                "status": 422,
                "detail": "branches/0: the trunk neither touches nor points into the crown; draw it from the root up",
                "code": "trunk_outside_crown",
                "errors": [
                    {"pointer": "/branches/0", "code": "trunk_outside_crown", "detail": "the trunk neither touches .."}
                ],
            }
        }
    )

    type: str
    title: str
    status: int
    detail: str
    code: str
    errors: list[Fault] = Field(default_factory=list)


class Health(_Wire):
    """Whether the service works, part by part."""

    status: Literal["ok", "degraded", "down"]
    checks: dict[str, str] = Field(default_factory=dict)


class Limits(_Wire):
    """What the service takes."""

    photo_bytes: int
    photo_pixels: int
    photo_side_min: int
    photo_side_max: int
    photo_formats: list[str]
    strokes: int
    points: int
    json_bytes: int
    name_length: int
    leaf_bytes: int = Field(description="of the picture of a leaf")
    trace_seconds: float
    model_seconds: float
    wait_seconds: float
    settings: dict[str, dict[str, Any]] = Field(description="each setting's default and what is allowed")
    keep_days: float


class Version(_Wire):
    """Which treestroke this is."""

    version: str
    engine: str
    api: str
