"""Correlation of windows of two pictures, whatever their brightness and contrast."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Grey = NDArray[np.float32]
"""(h, w) brightness, 0 to 255."""


@dataclass(frozen=True, eq=False)
class Windows:
    """A picture with the moments of the square windows about its pixels.

    Attributes
    ----------
    picture
        (h, w) brightness, 0 to 255.
    side
        Side of the windows, px.
    mean, spread
        (h, w) mean and standard deviation in each window.
    """

    picture: Grey
    side: int
    mean: Grey
    spread: Grey


def windows_of(picture: Grey, side: int, flat: float) -> Windows:
    """Measure the windows of a picture (h, w), 0 to 255; a spread under ``flat`` counts as that: nothing to match."""
    mean = np.asarray(cv2.blur(picture, (side, side)), dtype=np.float32)
    variance = cv2.sqrBoxFilter(picture, -1, (side, side)) - mean**2
    return Windows(picture, side, mean, np.sqrt(np.maximum(variance, np.float32(flat**2))))


def correlation(one: Windows, other: Windows) -> Grey:
    """Correlate the windows (h, w) of two pictures of one size: -1 to 1."""
    product = cv2.blur(one.picture * other.picture, (one.side, one.side)) - one.mean * other.mean
    return np.asarray(product / (one.spread * other.spread), dtype=np.float32)
