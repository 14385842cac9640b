"""What the service sends of clips in its responses, for its documents and its clients."""

from pydantic import ConfigDict, Field

from treestroke.schemas import MakerInfo, Point, StrokeWarning, TraceAnswer
from treestroke.wire_strokes import Wire


class ClipInfo(Wire):
    """A stored clip: a video of one tree."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "id": "clp_3e4f5a6b7c8d9e0f1a2b3c4d",
                "name": "ash.mp4",
                "maker": None,
                "width": 1920,
                "height": 1080,
                "frames": 240,
                "frames_per_second": 30.0,
                "seconds": 8.0,
                "bytes": 5242880,
                "sha256": "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
                "media_type": "video/mp4",
                "created": "2026-05-04T09:30:00.000Z",
                "video": "/v1/clips/clp_3e4f5a6b7c8d9e0f1a2b3c4d/video",
                "notes": [],
            }
        }
    )

    id: str
    name: str = Field(description="its file name; empty where it came without")
    maker: MakerInfo | None = Field(default=None, description="null where nobody signs in")
    width: int = Field(description="of its frames, upright, pixels")
    height: int
    frames: int = Field(description="how many there are at the even rate")
    frames_per_second: float = Field(description="even, at most about 30, whatever the file's own")
    seconds: float
    bytes: int
    sha256: str = Field(description="of the uploaded bytes")
    media_type: str
    created: str
    video: str = Field(description="the uploaded file")
    notes: list[StrokeWarning] = Field(description="what was left out or changed in reading it")


class ClipPage(Wire):
    """Clips, newest first; ``next`` is the cursor of the next page."""

    clips: list[ClipInfo]
    next: str | None


class UploadInfo(Wire):
    """A clip that arrives in pieces."""

    model_config = ConfigDict(
        json_schema_extra={"example": {"id": "upl_6c7d8e9f0a1b2c3d4e5f6a7b", "offset": 8388608, "clip": None}}
    )

    id: str
    offset: int = Field(description="how many bytes have arrived")
    clip: str | None = Field(description="the id of the clip that was made of it")


class Tracks(Wire):
    """Points of the tree that are followed through a clip, in pixels of its frames."""

    frames_per_second: float
    every: int = Field(description="each place is so many frames after the one before")
    points: list[list[Point | None]] = Field(description="for each track its places, null where it is not seen")


class ClipTraceAnswer(TraceAnswer):
    """What was found in one frame of a clip, as in a photo, and the tracks through all of its frames."""

    frame: int = Field(description="the frame that was drawn on")
    tracks: Tracks
