"""Shade between sprays of needles or scales, under a stroke: it has the colours of wood, and is none."""

from collections.abc import Sequence

import cv2
import numpy as np

from treestroke.core.geometry.polyline import normals
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.trace.appearance import Odds
from treestroke.core.types import Floats, Mask

CLEAR = 0.2
"""Least difference of wood along a line from wood beside it, -1 to 1, by which a stem or limb is seen. (Of the places
along 12 strokes in the crowns of synthetic pines where wood is seen 83 % reach it, of the others 21 %.)"""
BESIDE, BESIDE_PX = 1.3, 2.0
"""How far beside the line it is compared, in radii plus px."""
ALONG = 9
"""Number of places along a line that are judged together."""


def shade_under(lines: Sequence[tuple[Floats, Floats]], smooth: Odds, crown: Mask) -> Mask:
    """Return where (h, w) there is shade under strokes' lines (n, 2), px, with their radii (n,), in a crown (h, w).

    Wood is told by log odds (h, w), averaged over the grain of bark.
    """
    shade = np.zeros(crown.shape, dtype=np.uint8)
    seen = np.clip(smooth, -1.0, 1.0)
    for points, radii in lines:
        aside = (BESIDE * radii + BESIDE_PX)[:, None] * normals(points)
        on, left, right = (
            cv2.blur(sample_nearest(seen, points + side * aside, -1.0)[:, None], (1, ALONG))[:, 0]
            for side in (0, -1, 1)
        )
        clear = (on - np.maximum(left, right)) / 2 > CLEAR
        for value, places in ((1, ~clear), (0, clear)):
            for (x, y), radius in zip(points[places].tolist(), radii[places].tolist(), strict=True):
                cv2.circle(shade, (int(x), int(y)), int(radius) + 1, value, cv2.FILLED)
    return np.asarray(crown & (shade > 0))
