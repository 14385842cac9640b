"""Photos of a capture at the size that they are solved and modelled at."""

import cv2
import numpy as np

from treestroke.core.capture import CapturedPhoto
from treestroke.core.types import Picture

CAPTURED_SIDE = 1280
"""Longest side, px, at which a capture's photos are solved and modelled."""


def captured_photo(name: str, photo: Picture, focal_px: float | None) -> CapturedPhoto:
    """Reduce an upright photo (h, w, 3), sRGB, where it is large.

    ``focal_px`` is its lens's focal length, px of the photo, where that is known.
    """
    height, width = photo.shape[:2]
    scale = min(1.0, CAPTURED_SIDE / max(width, height))
    if scale == 1:
        return CapturedPhoto(name, photo, focal_px)
    size = max(1, round(width * scale)), max(1, round(height * scale))
    picture = np.asarray(cv2.resize(photo, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
    return CapturedPhoto(name, picture, None if focal_px is None else focal_px * size[0] / width, (width, height))
