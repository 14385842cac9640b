"""Which share of each pixel foliage covers."""

import cv2
import numpy as np

from treestroke.core.types import Mask, Opacity, Picture

RADIUS_PX = 4
"""Radius of the windows in which opacity is taken to be linear in the colour, px."""
EPSILON = 20.0**2
"""Squared difference of colours, 0 to 255, below which a window counts as plain."""


def matte(pixels: Picture, found: Mask) -> Opacity:
    """Estimate the share (h, w) of each pixel that foliage covers, by the foliage found (h, w) in a photo (h, w, 3).

    Source: He, Sun and Tang 2013, "Guided image filtering", section 3.6: a guided filter of the mask.
    """
    soft = cv2.ximgproc.guidedFilter(pixels, found.astype(np.float32), RADIUS_PX, EPSILON)
    return np.clip(soft, 0.0, 1.0).astype(np.float32)
