"""What models are drawn over: a photo, a capture or a clip, against which strokes are checked."""

from dataclasses import dataclass
from typing import Any

from treestroke.service import captures, clips, tracer
from treestroke.service.capture_photos import warnings_of
from treestroke.service.model_request import ModelOrder
from treestroke.service.photos import Resources
from treestroke.store.tables import ModelPart, PhotoRow


@dataclass(frozen=True)
class Base:
    """What a tree is drawn over: its parts, stored already, and what was mended when they were read."""

    parts: dict[str, ModelPart]
    warnings: list[dict[str, Any]]


def base_of(resources: Resources, order: ModelOrder, photo: PhotoRow | None) -> Base:
    """Check what was drawn, against what it was drawn over, and return that."""
    if order.capture is not None:
        return _drawn_over_capture(resources, order)
    return _drawn_over_photo(resources, order, photo) if order.clip is None else _drawn_over_clip(resources, order)


def _drawn_over_clip(resources: Resources, order: ModelOrder) -> Base:
    """Check what was drawn, against the clip.

    Raises
    ------
    NotFound
        There is no such clip.
    """
    assert order.clip is not None
    assert order.drawing.frame is not None
    clip = clips.get_clip(resources, order.clip)
    size = clip.width, clip.height
    resources.tracers("", tracer.check_frame, order.drawing.frame, size, clip.frames)
    resources.blobs.check(clip.blob)
    return Base({"clip": ModelPart(name="clip", blob=clip.blob, media_type=clip.media_type)}, [])


def _drawn_over_photo(resources: Resources, order: ModelOrder, photo: PhotoRow | None) -> Base:
    """Check what was drawn, against the photo where there is one."""
    path = None if photo is None else resources.blobs.check(photo.blob)
    key = "" if photo is None else photo.blob
    resources.tracers(key, tracer.check_drawing, path, order.drawing, order.within)
    return Base({}, []) if photo is None else Base({"photo": _picture("photo", photo.blob)}, photo.warnings)


def _drawn_over_capture(resources: Resources, order: ModelOrder) -> Base:
    """Check what was drawn, against the capture; its photos and their cameras are parts that share its files.

    Raises
    ------
    NotFound
        There is no such capture.
    CaptureError
        It is not solved.
    """
    assert order.capture is not None
    assert order.drawing.views is not None
    capture = captures.find_capture(resources.database, order.capture)
    structure = captures.solved_structure(capture)
    sizes = {photo.name: (photo.width, photo.height) for photo in capture.photos}
    path = resources.blobs.check(structure)
    resources.tracers(structure, tracer.check_views, path, order.drawing.views, sizes)
    cameras = ModelPart(name="structure", blob=structure, media_type="application/json")
    pictures = {name: _picture(name, photo.blob) for photo in capture.photos for name in [f"photos/{photo.name}"]}
    return Base({**pictures, "structure": cameras}, warnings_of(capture.photos))


def _picture(name: str, blob: str) -> ModelPart:
    return ModelPart(name=name, blob=blob, media_type="image/png")
