"""What the service sends in its responses, for its documents and its clients."""

from http import HTTPStatus
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from treestroke.wire_strokes import Wire

Point = tuple[float, float]
Place = tuple[float, float, float]
Status = Literal["queued", "running", "succeeded", "failed", "canceled"]


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


class TracedSkeleton(Wire):
    """The visible branches, in photo pixels; ``stroke`` is the stroke that a joint lies under, or -1."""

    points: list[Point]
    radii: list[float]
    parents: list[int]
    stroke: list[int]


class GrownSkeleton(Wire):
    """The whole tree's skeleton, in metres; ``born`` is the iteration in which a joint appeared, 0 for the visible."""

    points: list[Place]
    radii: list[float]
    parents: list[int]
    born: list[int]
    photo: PhotoFrame


class Taken(Wire):
    """What a photo's tree was taken for; the settings of the same names may say otherwise."""

    foliage: str = Field(description="what the twigs bear")
    sureness: float = Field(ge=0, le=1, description="probability that ``foliage`` is right")
    form: str = Field(description="how the limbs grow")
    ask: bool = Field(description="whether ``foliage`` is so unsure that a person should be asked")


class TraceAnswer(Wire):
    """What was found; ``foliage`` is closed rings by the even-odd rule."""

    rev: int | None
    foliage: list[list[Point]]
    skeleton: TracedSkeleton
    taken: Taken | None = Field(description="null without a trunk stroke")
    warnings: list[StrokeWarning]
    grown: GrownSkeleton | None = Field(default=None, description="with ``grow`` and a trunk stroke")
    photo: PhotoFrame | None = Field(default=None, description="with ``grown``")


class TracedSketch(Wire):
    """What a sketch shows, in pixels of its canvas; a skeleton's ``stroke`` is the index of a joint's branch."""

    skeleton: TracedSkeleton
    crown: list[Point] = Field(description="closed outline: as drawn, or around the strokes")
    crown_drawn: bool = Field(description="whether the crown was drawn")
    size: tuple[int, int] = Field(description="width and height of the canvas")


class SketchTraceAnswer(Wire):
    """What sketches show."""

    rev: int | None
    front: TracedSketch
    side: TracedSketch | None
    warnings: list[StrokeWarning]
    grown: GrownSkeleton | None = Field(default=None, description="with ``grow``")
    photo: PhotoFrame | None = Field(default=None, description="of the front's canvas, with ``grown``")
    score: dict[str, float] | None = Field(default=None, description="how the tree resembles them, with ``grown``")


class PhotoInfo(Wire):
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
                "warnings": [],
            }
        }
    )

    id: str
    width: int
    height: int
    sha256: str = Field(description="of the uploaded bytes")
    created: str
    image: str = Field(description="the stored picture: PNG, upright, sRGB, without metadata")
    warnings: list[StrokeWarning] = Field(default_factory=list, description="what was mended in reading it")


class PhotoPage(Wire):
    """Photos, newest first; ``next`` is the cursor of the next page."""

    photos: list[PhotoInfo]
    next: str | None


class Failure(Wire):
    """Why a model, or the search for a capture's cameras, failed."""

    code: str
    detail: str
    retryable: bool


class MakerInfo(Wire):
    """Who made something."""

    id: str
    name: str = Field(description="empty where they are no longer known")


class ModelInfo(Wire):
    """A tree that was made, or waits to be made."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "id": "mdl_0a1b2c3d4e5f60718293a4b5",
                "name": "The old oak",
                "tags": ["park", "oak"],
                "maker": {"id": "usr_7a8b9c0d1e2f30415263f4a5", "name": "Ann"},
                "photo": "pho_5f0c8e1d2b3a49c6d7e8f901",
                "capture": None,
                "status": "running",
                "phase": "grow",
                "phase_fraction": 0.4,
                "progress": 0.36,
                "queue_position": None,
                "eta_s": 2.1,
                "attempt": 1,
                "error": None,
                "score": None,
                "taken": None,
                "report": None,
                "files": {"strokes.json": "/v1/models/mdl_0a1b2c3d4e5f60718293a4b5/strokes.json"},
                "settings": {"height": 14.0},
                "seed": 1,
                "engine": "treestroke 0.1.0+1a2b3c4d5e6f",
                "created": "2026-05-04T09:31:00.000Z",
                "started": "2026-05-04T09:31:01.000Z",
                "finished": None,
            }
        }
    )

    id: str
    name: str
    tags: list[str] = Field(default_factory=list)
    maker: MakerInfo | None = Field(default=None, description="null where nobody signs in")
    photo: str | None = Field(description="null where it is made of sketches alone, of a capture, or of a clip")
    capture: str | None = Field(default=None, description="where it is made of one")
    clip: str | None = Field(default=None, description="where it is made of one")
    status: Status
    phase: str | None = Field(description="the step under way")
    phase_fraction: float = Field(ge=0, le=1)
    progress: float = Field(ge=0, le=1)
    queue_position: int | None = Field(description="1 for the next one")
    eta_s: float | None = Field(description="seconds until it is finished, as others took")
    attempt: int
    error: Failure | None
    score: dict[str, float] | None
    taken: Taken | None = Field(default=None, description="with the report")
    report: dict[str, Any] | None = Field(description="as the command line's --report")
    files: dict[str, str]
    settings: dict[str, Any]
    seed: int
    engine: str
    created: str
    started: str | None
    finished: str | None


class ModelPage(Wire):
    """Models, newest first; ``next`` is the cursor of the next page, which follows an empty one of a search too."""

    models: list[ModelInfo]
    next: str | None


class Reason(Wire):
    """Why something is not so: for programs and for people."""

    code: str
    detail: str


class Fault(Wire):
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
                "title": HTTPStatus.UNPROCESSABLE_ENTITY.phrase,
                "status": 422,
                "detail": "branches/0: the trunk neither touches nor points into the crown; draw it from the root up",
                "code": "trunk_outside_crown",
                "errors": [
                    {"pointer": "/branches/0", "code": "trunk_outside_crown", "detail": "the trunk neither touches .."}
                ],
                "request_id": "0d6c1f3a9be84572a1c05e7d42f8b963",
            }
        }
    )

    type: str
    title: str
    status: int
    detail: str
    code: str
    errors: list[Fault] = Field(default_factory=list)
    request_id: str = ""
    """By which the service's log tells of this request."""


class Health(Wire):
    """Whether the service works, part by part."""

    status: Literal["ok", "degraded", "down"]
    checks: dict[str, str] = Field(default_factory=dict)


class RateNow(Wire):
    """How many requests of a kind who asks may send, and how many are left."""

    name: str
    requests: int
    seconds: int
    remaining: int


class QuotaNow(Wire):
    """How much of a quota who asks has, and uses."""

    name: str = Field(description="stored_bytes, queued, running, models_a_day or streams")
    limit: int | None = Field(description="null: no limit")
    used: int


class Limits(Wire):
    """What the service takes."""

    photo_bytes: int
    photo_stored_bytes: int = Field(description="of a photo as it is kept, a PNG without loss")
    photos_stored_bytes: int = Field(description="of all photos together as they are kept, the deleted for a day too")
    photo_pixels: int
    photo_side_min: int
    photo_side_max: int
    photo_formats: list[str]
    strokes: int
    points: int
    json_bytes: int
    name_length: int
    leaf_bytes: int = Field(description="of the picture of a leaf or a fruit")
    sketch_bytes: int = Field(description="of the picture of a sketch")
    trace_seconds: float
    capture_trace_seconds: float
    clip_bytes: int
    clip_formats: list[str]
    clip_seconds: float = Field(description="what is longer is cut there")
    clip_seconds_min: float
    clip_frames_min: int
    edits: int
    edit_points: int = Field(description="of a branch that an edit adds")
    model_seconds: float
    capture_photos_min: int = Field(description="photos of a capture whose cameras can be looked for")
    capture_photos_max: int
    solve_seconds: float
    wait_seconds: float
    settings: dict[str, dict[str, Any]] = Field(description="each setting's default and what is allowed")
    keep_days: float
    followers: int = Field(description="requests that follow models or captures at once, by events or by Prefer: wait")
    rates: list[RateNow] = Field(description="of who asks; none of a service without keys")
    quotas: list[QuotaNow] = Field(description="of the team of who asks; none of a service without keys")


class Version(Wire):
    """Which treestroke this is."""

    version: str
    engine: str
    api: str
