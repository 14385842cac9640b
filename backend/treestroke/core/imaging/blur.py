"""Broad averages of pictures."""

import cv2
import numpy as np

from treestroke.core.types import Floats


def broadly_blurred(picture: Floats, sigma: float, beyond: int = cv2.BORDER_REPLICATE) -> Floats:
    """Average a picture (h, w) over a Gaussian of this standard deviation, px, computed on fewer pixels.

    ``beyond`` says what lies beyond the border, as OpenCV's border types: its nearest pixel, or 0 by BORDER_CONSTANT.
    """
    rows, columns = picture.shape
    step = max(1.0, sigma / 3)
    size = (max(1, round(columns / step)), max(1, round(rows / step)))
    small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    soft = cv2.GaussianBlur(small, (0, 0), sigma / step, borderType=beyond)
    return np.asarray(cv2.resize(soft, (columns, rows), interpolation=cv2.INTER_LINEAR))
