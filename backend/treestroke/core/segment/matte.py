"""Which share of each pixel foliage covers: a matte.

Between leaves, and at a crown's fringe, most pixels show foliage and background mixed. Where the colours of both are
known near by, the share follows from how far the pixel's colour lies from the background's toward the foliage's; where
they are alike, only from how likely that colour is.
"""

from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Mask, Opacity, Picture

SURE_LEAF, SURE_GROUND = 0.8, 0.25
"""Likelihoods from which on a pixel, with its eight neighbours, is nothing but foliage, or nothing but background."""
REACHES, LEAST_REACH_PX = (0.00375, 0.015, 0.06), 1.5
"""Distances over which sure colours are averaged, as shares of the picture's longer side, and the least, px: the
nearest that there are count. (With distances in pixels photos of 900 and 2400 px agree by 0.952 instead of 0.959.)"""
FURTHER = 0.03
"""Weight of what lies within the next greater distance."""
ASIDE, ASIDE_FROM = 20.0, 16.0
"""How far aside of the line between both colours, steps of 255, a pixel counts half by where it lies along it, and from
where on aside counts: mixed pixels lie on the line, leaves in light and in shade, and windows before a wall, do not."""
DOUBT = (0.6, 0.9)
"""Likelihoods at which a pixel aside of that line is background, and foliage."""
PURE = 0.15
"""Share of the way from one colour to the other within which a pixel is as good as pure: leaves and background vary,
too (mean error 0.07 instead of 0.09; 14 crowns)."""
NOISE = 24.0
"""Distance of both colours, steps of 255, at which the colours count as much as the likelihood."""
STRIP_ROWS = 32
"""Rows of a picture whose shares are found at a time."""

_Map = NDArray[np.float32]
Value = TypeVar("Value", np.float32, np.uint8)


def matte(pixels: Picture, likely: Opacity, region: Mask) -> Opacity:
    """Estimate the share (h, w) of each pixel (h, w, 3), sRGB, of a region (h, w) that foliage covers; 0 outside it.

    ``likely`` (h, w) is the probability, 0 to 1, that a pixel of its colour at its place is foliage.

    Source: the compositing equation, solved for known colours as by Gastal and Oliveira 2010, "Shared sampling for
    real-time alpha matting", equation 2. We average the colours of sure pixels near by instead of choosing a pair of
    them, and take pixels aside of the line between both colours for what is likelier. Judged on 20 crowns with known
    masks or mattes (`docs/papers.md`).
    """
    near, likely = np.ones((3, 3), np.uint8), likely * region
    leaf = _near_by(pixels, cv2.erode(likely, near) > SURE_LEAF)
    ground = _near_by(pixels, cv2.dilate(likely, near) < SURE_GROUND)
    alpha = np.zeros_like(likely)
    # Strips of a few rows stay in the processor's cache, and most of them are wider than the crown.
    for top in range(0, len(region), STRIP_ROWS):
        columns = np.flatnonzero(region[top : top + STRIP_ROWS].any(axis=0))
        if len(columns):
            part = slice(top, top + STRIP_ROWS), slice(columns[0], columns[-1] + 1)
            alpha[part] = _share(pixels[part].astype(np.float32), leaf[part], ground[part], likely[part]) * region[part]
    return alpha


def _share(colours: _Map, leaf: _Map, ground: _Map, likely: Opacity) -> Opacity:
    """Share (h, w) that foliage covers of colours (h, w, 3), by those of foliage and background (h, w, 3) near by."""
    way, offset = leaf - ground, colours - ground
    apart = np.maximum(np.sqrt(_dot(way, way)), np.float32(1))
    along = _dot(offset, way) / apart
    aside = np.maximum(np.sqrt(np.maximum(_dot(offset, offset) - along**2, 0)) - ASIDE_FROM, 0)
    mixed = ASIDE**2 / (ASIDE**2 + aside**2)
    share = np.clip((along / apart - PURE) / (1 - 2 * PURE), 0, 1)
    by_likelihood = np.clip((likely - DOUBT[0]) / (DOUBT[1] - DOUBT[0]), 0, 1)
    share = mixed * share + (1 - mixed) * by_likelihood
    clear = apart**2 / (apart**2 + NOISE**2)
    return np.asarray(clear * share + (1 - clear) * likely, dtype=np.float32)


def _near_by(pixels: Picture, sure: NDArray[np.bool_]) -> _Map:
    """Mean colour (h, w, 3) of the sure pixels (h, w) near each pixel, averaged at half the size."""
    height, width = sure.shape
    size, mask = (max(1, width // 2), max(1, height // 2)), sure.astype(np.uint8) * np.uint8(255)
    masked = np.asarray(cv2.bitwise_and(pixels, pixels, mask=mask), dtype=np.uint8)
    weighted = np.dstack([_resized(masked, size), _resized(mask, size)]).astype(np.float32)
    total = np.full(weighted.shape, 1e-12, dtype=np.float32)
    for rank, share in enumerate(REACHES):
        reach = max(LEAST_REACH_PX, share * max(sure.shape))
        total += np.float32(FURTHER**rank) * _blurred(weighted, reach / 2)
    return _resized(total[..., :3] * (np.float32(255) / total[..., 3:]), (width, height))


def _blurred(image: _Map, reach: float) -> _Map:
    """Average over a Gaussian, computed on fewer pixels."""
    height, width = image.shape[:2]
    step = max(1, int(reach / 1.5))
    small = _resized(image, (max(1, width // step), max(1, height // step)))
    return _resized(np.asarray(cv2.GaussianBlur(small, (0, 0), reach / step), dtype=np.float32), (width, height))


def _resized(image: NDArray[Value], size: tuple[int, int]) -> NDArray[Value]:
    """Return an image (h, w) or (h, w, c) at a size (width, height): averaged where that is smaller."""
    smaller = size[0] < image.shape[1]
    resized = cv2.resize(image, size, interpolation=cv2.INTER_AREA if smaller else cv2.INTER_LINEAR)
    return np.asarray(resized, dtype=image.dtype)


def _dot(first: _Map, second: _Map) -> _Map:
    """Scalar product (h, w) of two maps of vectors (h, w, 3)."""
    return np.asarray(cv2.transform(cv2.multiply(first, second), np.ones((1, 3), np.float32)))
