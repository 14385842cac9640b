"""Features of a photo: places that other photos show again, each with a descriptor of what is around it.

SIFT: Lowe 2004, "Distinctive Image Features from Scale-Invariant Keypoints"; descriptors compared by Hellinger's
kernel: Arandjelovic and Zisserman 2012, "Three things everyone should know to improve object retrieval".
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Picture

LENGTH = 512.0
"""Length of every descriptor; its components are whole numbers, so that sums of products of them are exact."""
_MOST = 8000
_CONTRAST = 0.005
"""Least contrast of a feature; an eighth of Lowe's: where there is more to see, only the strongest count anyway."""
_EDGE = 10.0
"""Greatest ratio of principal curvatures; Lowe's."""


@dataclass(frozen=True, eq=False)
class Features:
    """Features of a photo, the most salient first.

    Attributes
    ----------
    points_px
        (n, 2) where they are in the photo of its own size.
    sizes_px
        (n,) their diameters.
    descriptors
        (n, 128) float32 whole numbers, each row of length `LENGTH` or nearly.
    sharpness
        How much of the photo's detail is fine, to be compared between photos of one scene.
    """

    points_px: Floats
    sizes_px: Floats
    descriptors: NDArray[np.float32]
    sharpness: float

    def __len__(self) -> int:
        return len(self.points_px)


def find_features(picture: Picture) -> Features:
    """Find the features of an upright photo (h, w, 3) sRGB, at most 8000."""
    grey = cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY)
    sift = cv2.SIFT.create(_MOST, 3, _CONTRAST, _EDGE, 1.6, enable_precise_upscale=True)
    found, raw = sift.detectAndCompute(grey, None)
    points = np.array([one.pt for one in found]).reshape(-1, 2) + 0.5
    sizes = np.array([one.size for one in found])
    response = np.array([one.response for one in found])
    order = np.argsort(-response, kind="stable")
    descriptors = np.zeros((0, 128), np.float32) if raw is None else _hellinger(np.asarray(raw, np.float64))
    return Features(points[order], sizes[order], descriptors[order], _sharpness(np.asarray(grey, np.uint8)))


def _hellinger(raw: Floats) -> NDArray[np.float32]:
    """Return descriptors (n, 128) whose products measure likeness as Hellinger's kernel does, in whole numbers."""
    shares = raw / np.maximum(raw.sum(axis=1, keepdims=True), 1e-9)
    return np.asarray(np.round(LENGTH * np.sqrt(shares)), np.float32)


def _sharpness(grey: Picture) -> float:
    """Measure how much of a picture's detail is fine: energy of the Laplacian at half over that at a quarter size.

    At full size the noise of the sensor and of JPEG would count as detail of a blurred photo.
    """
    half = cv2.resize(grey, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    quarter = cv2.resize(half, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    fine, coarse = (float(cv2.Laplacian(one, cv2.CV_32F).var()) for one in (half, quarter))
    return fine / max(coarse, 1e-9)
