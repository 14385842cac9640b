"""The traced foliage and branches, drawn over the photo."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.skeleton.skeleton import Skeleton

_FOLIAGE = np.array([70.0, 200.0, 90.0])
_DRAWN, _FOUND = (255, 214, 64), (255, 96, 64)
_SUBPIXEL_BITS = 4


def draw_overlay(
    photo: NDArray[np.uint8], foliage: NDArray[np.bool_], skeleton: Skeleton | None, stroke: NDArray[np.int64]
) -> NDArray[np.uint8]:
    """Tint the foliage (h, w) and draw the skeleton, px, over a photo (h, w, 3), sRGB.

    Branches under a stroke (its index in ``stroke`` (n,)) are yellow, those found without one (-1) orange; lines are as
    wide as the wood.

    Returns
    -------
    (h, w, 3) uint8, sRGB.
    """
    picture = photo.astype(np.float64)
    picture[foliage] = 0.6 * picture[foliage] + 0.4 * _FOLIAGE
    canvas = picture.round().astype(np.uint8)
    if skeleton is not None:
        _draw_wood(canvas, skeleton, stroke)
    return canvas


def _draw_wood(canvas: NDArray[np.uint8], skeleton: Skeleton, stroke: NDArray[np.int64]) -> None:
    """Draw each edge of the skeleton on a canvas (h, w, 3), as wide as the wood."""
    fixed = np.round((skeleton.points - 0.5) * 2**_SUBPIXEL_BITS).astype(int).tolist()
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0:
            colour = _DRAWN if stroke[joint] >= 0 else _FOUND
            width = max(2, round(float(skeleton.radii[joint] + skeleton.radii[parent])))
            cv2.line(canvas, fixed[parent], fixed[joint], colour, width, cv2.LINE_AA, _SUBPIXEL_BITS)
