"""Pictures with transparent pixels."""

import numpy as np

from treestroke.core.types import Picture

ROWS = 256
"""Rows that are blended at a time, so that a large picture takes little memory."""


def over_white(picture: Picture) -> Picture:
    """Lay a picture (h, w, 4), sRGB with straight alpha, over white: (h, w, 3); one without alpha is returned as it is.

    Source: Porter and Duff 1984, "Compositing digital images", the operator "over".
    """
    if picture.shape[2] == 3:
        return picture
    laid = np.empty((*picture.shape[:2], 3), dtype=np.uint8)
    for top in range(0, len(picture), ROWS):
        strip = picture[top : top + ROWS].astype(np.uint16)
        alpha = strip[..., 3:]
        laid[top : top + ROWS] = (alpha * strip[..., :3] + (255 - alpha) * 255 + 127) // 255
    return laid
