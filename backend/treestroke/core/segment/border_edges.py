"""Whether a tree that was found ends where its photo shows an edge: where it does not, background was taken for it."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Mask, Picture

AROUND_PX = 7
"""Side of the square, px, over which the colours on each side of a border are averaged."""
LEAST_SEEN = 0.02
"""Share of that square that a side must hold for its colour to count."""
PLAIN = 10.0
"""Difference of the colours of both sides, steps of 255, below which there is no edge."""


def share_without_edge(photo: Picture, found: Mask, region: Mask) -> float:
    """Measure on which share of the border of what was found (h, w) a photo (h, w, 3), sRGB, shows no edge: 0 to 1.

    Only what lies well within the ``region`` (h, w) in which it was looked for counts, since that ends there anyway.
    """
    near = np.ones((3, 3), np.uint8)
    mask = found.astype(np.uint8)
    inside, outside = (np.asarray(side > 0) for side in (cv2.erode(mask, near), 1 - cv2.dilate(mask, near)))
    within = cv2.erode(region.astype(np.uint8), np.ones((AROUND_PX, AROUND_PX), np.uint8))
    (inner, seen), (outer, seen_outside) = (_mean(photo, side) for side in (inside, outside))
    border = ~inside & ~outside & (within > 0) & (np.minimum(seen, seen_outside) > LEAST_SEEN)
    differs = np.linalg.norm((inner - outer)[border], axis=1)
    return float((differs < PLAIN).mean()) if len(differs) else 0.0


def _mean(photo: Picture, side: Mask) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return the mean colour (h, w, 3) of the pixels of a side (h, w) around each pixel, and their share (h, w)."""
    size = (AROUND_PX, AROUND_PX)
    share = np.asarray(cv2.blur(side.astype(np.float32), size), dtype=np.float32)
    total = cv2.blur(photo.astype(np.float32) * side[..., None], size)
    return np.asarray(total / np.maximum(share, 1e-6)[..., None], dtype=np.float32), share
