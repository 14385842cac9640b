"""What the service sends of captures in its responses, for its documents and its clients."""

from typing import Literal

from pydantic import ConfigDict, Field

from treestroke.schemas import Failure, GrownSkeleton, MakerInfo, PhotoFrame, Place, Point, Reason, StrokeWarning, Taken
from treestroke.wire_strokes import Wire

Pose = tuple[float, float, float, float]
CaptureStatus = Literal["unsolved", "queued", "running", "solved", "failed"]


class CapturePhotoInfo(Wire):
    """A photo of a capture."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "id": "cph_1c2d3e4f5a6b7c8d9e0f1a2b",
                "name": "IMG_03.jpg",
                "width": 3024,
                "height": 4032,
                "sha256": "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
                "focal_px": 3028.4,
                "created": "2026-05-04T09:30:00.000Z",
                "image": "/v1/captures/cap_7b1d0c2e3f4a5968778695a4/photos/cph_1c2d3e4f5a6b7c8d9e0f1a2b/image",
                "warnings": [],
                "used": None,
                "reason": None,
            }
        }
    )

    id: str
    name: str = Field(description="its file name; with a number where another photo of the capture had it")
    width: int
    height: int
    sha256: str = Field(description="of the uploaded bytes")
    focal_px: float | None = Field(description="focal length, where its camera wrote it into the file")
    created: str
    image: str = Field(description="the stored picture: PNG, upright, sRGB, without metadata")
    warnings: list[StrokeWarning] = Field(default_factory=list, description="what was mended in reading it")
    used: bool | None = Field(description="whether its camera was found; null before the capture is solved")
    reason: Reason | None = Field(description="why its camera was not found")


class CameraInfo(Wire):
    """The camera that took a photo: x right, y down, z forward."""

    photo: str = Field(description="the photo's name")
    camera_from_world: tuple[Pose, Pose, Pose] = Field(description="3 x 4, by rows")
    focal_px: float
    principal_px: Point
    size_px: tuple[int, int] = Field(description="width and height of the upright photo")


class CloudInfo(Wire):
    """Points that several photos show; evenly chosen ones where there are many."""

    points: list[Place]
    colours: list[tuple[int, int, int]] = Field(description="sRGB, 0 to 255")


class CaptureState(Wire):
    """How far a capture is."""

    id: str
    name: str
    maker: MakerInfo | None = Field(default=None, description="null where nobody signs in")
    status: CaptureStatus
    phase: str | None = Field(description="the step under way")
    phase_fraction: float = Field(ge=0, le=1)
    progress: float = Field(ge=0, le=1)
    queue_position: int | None = Field(description="1 for the next one")
    eta_s: float | None = Field(description="seconds until its cameras are found, as others took")
    attempt: int
    error: Failure | None = Field(description="why its cameras were not found")
    photo_count: int
    engine: str | None = Field(description="the version that looked for its cameras")
    created: str
    started: str | None
    finished: str | None


class CaptureInfo(CaptureState):
    """Photos of one tree from several places, and what is known of where they were taken.

    Cameras and points are in one frame: right-handed, Y up; its origin, its turn about Y and its scale mean nothing.
    """

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "id": "cap_7b1d0c2e3f4a5968778695a4",
                "name": "The old oak, all around",
                "maker": None,
                "status": "unsolved",
                "phase": None,
                "phase_fraction": 0.0,
                "progress": 0.0,
                "queue_position": None,
                "eta_s": None,
                "attempt": 0,
                "error": None,
                "photo_count": 0,
                "engine": None,
                "created": "2026-05-04T09:30:00.000Z",
                "started": None,
                "finished": None,
                "photos": [],
                "cameras": [],
                "cloud": None,
            }
        }
    )

    photos: list[CapturePhotoInfo] = Field(description="by name")
    cameras: list[CameraInfo] = Field(description="of the photos that are used")
    cloud: CloudInfo | None = Field(description="once it is solved")


class CapturePage(Wire):
    """Captures, newest first; ``next`` is the cursor of the next page."""

    captures: list[CaptureState]
    next: str | None


class TracedView(Wire):
    """Where a photo of a capture shows the tree: closed rings by the even-odd rule, pixels of the upright photo."""

    photo: str = Field(description="the photo's name")
    foliage: list[list[Point]]


class SeenSkeleton(Wire):
    """The visible branches of a capture's tree after edits, in the capture's frame."""

    points: list[Place]
    radii: list[float]
    parents: list[int]
    seen: list[bool] = Field(description="false where a joint only joins what is seen, or was added by an edit")


class CrownSurface(Wire):
    """The surface of a crown that was measured, in the capture's frame."""

    points: list[Place]
    triangles: list[tuple[int, int, int]] = Field(description="indices of points, counterclockwise from outside")
    guessed: list[bool] = Field(description="whether a point lies on a side that no photo was taken from")


class CaptureTraceAnswer(Wire):
    """What the photos of a capture show of its tree."""

    rev: int | None
    photos: list[TracedView] = Field(description="those that are used")
    skeleton: SeenSkeleton
    crown: CrownSurface
    tree_from_capture: tuple[Pose, Pose, Pose] = Field(
        description="3 x 4, by rows: from a point of the capture's frame to the GLB's, metres"
    )
    taken: Taken
    warnings: list[StrokeWarning]
    grown: GrownSkeleton | None = Field(default=None, description="with ``grow``; in the GLB's frame")
    photo: PhotoFrame | None = Field(default=None, description="of the front, with ``grown``")
