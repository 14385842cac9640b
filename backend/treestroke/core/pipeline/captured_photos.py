"""Photos of a capture at the size that they are solved and modelled at."""

import cv2
import numpy as np

from treestroke.core.capture import CapturedPhoto
from treestroke.core.types import Picture

CAPTURED_SIDE = 1600
"""Longest side, px, at which a capture's photos are kept: features of larger ones find no better cameras."""


def captured_photo(name: str, picture: Picture, focal_share: float | None) -> CapturedPhoto:
    """Reduce an upright photo (h, w, 3), sRGB, where it is large.

    ``focal_share`` is its lens's focal length over the photo's longer side, where that is known.
    """
    height, width = picture.shape[:2]
    scale = min(1.0, CAPTURED_SIDE / max(width, height))
    if scale < 1:
        size = max(1, round(width * scale)), max(1, round(height * scale))
        picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
    focal_px = None if focal_share is None else focal_share * max(picture.shape[:2])
    return CapturedPhoto(name, picture, focal_px, (width, height))
