"""The focal length that a camera wrote into a photo, in pixels."""

import math

_FULL_FRAME_MM = math.hypot(36.0, 24.0)
"""Diagonal of a 35 mm film frame, to which equivalent focal lengths refer (CIPA DCG-001)."""
_LEAST, _MOST = 0.2, 20.0
"""Focal lengths over the longest side that are believed."""


def focal_px(
    size: tuple[int, int], equivalent_mm: float | None, focal_mm: float | None = None, sensor_mm: float | None = None
) -> float | None:
    """Return the focal length, px, of a photo of a size (width, height), px; None if it is not known.

    Parameters
    ----------
    size
        As the camera recorded it, not cropped.
    equivalent_mm
        EXIF's FocalLengthIn35mmFilm; 0 or None if there is none.
    focal_mm, sensor_mm
        EXIF's FocalLength, and the length of the sensor's longest side (pixels over FocalPlaneXResolution).
    """
    longest = max(size)
    if equivalent_mm:
        found = equivalent_mm / _FULL_FRAME_MM * math.hypot(*size)
    elif focal_mm and sensor_mm:
        found = focal_mm / sensor_mm * longest
    else:
        return None
    return found if math.isfinite(found) and _LEAST * longest <= found <= _MOST * longest else None
