"""What the photos of a capture tell together."""

from collections.abc import Sequence
from typing import Any

from treestroke.service.fingerprints import digest
from treestroke.store.tables import CapturePhoto


def warnings_of(photos: Sequence[CapturePhoto]) -> list[dict[str, Any]]:
    """Return what was mended when photos were read, each with the photo's name as its place."""
    return [{**warning, "stroke": f"photos/{photo.name}"} for photo in photos for warning in photo.warnings]


def fingerprint(photos: Sequence[CapturePhoto]) -> str:
    """Return a digest of what decides over a structure beside the engine: photos in the order of their names."""
    return digest([[photo.name, photo.blob, photo.focal_length_px] for photo in photos])
