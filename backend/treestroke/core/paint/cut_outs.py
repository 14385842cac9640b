"""Pictures of a leaf or a fruit that are cut out of their background."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.paint.palette import lab_from_rgb
from treestroke.core.types import Floats, Mask, Picture

VISIBLE_ALPHA = 26
"""Alpha, 0 to 255, from which a pixel of a picture counts as visible."""
SOLID_ALPHA = 128
"""Alpha, 0 to 255, from which a pixel's colour is the leaf's or the fruit's own.

Higher than ALPHA_CUT, at which cards are cut when they are drawn: pixels between the two are edges, whose colour blends
with the transparent ground's.
"""
LONGEST_PX = 360
"""Long side to which a picture is reduced: larger than any drawing of it."""


def opaque_part(picture: Picture) -> Picture:
    """Crop a picture (h, w, 4), sRGB with straight alpha, to the bounding box of its visible pixels.

    Raises
    ------
    ValueError
        The picture has another shape or type, or all of it is transparent.
    """
    if picture.ndim != 3 or picture.shape[2] != 4 or picture.dtype != np.uint8:
        given = f"{picture.shape} {picture.dtype}"
        raise ValueError(f"the picture of a leaf or a fruit must be (h, w, 4) uint8, got {given}")
    opaque = visible(picture)
    if not opaque.any():
        raise ValueError("the picture of a leaf or a fruit needs pixels that are not transparent")
    rows, columns = np.flatnonzero(opaque.any(axis=1)), np.flatnonzero(opaque.any(axis=0))
    return picture[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def visible(picture: Picture) -> Mask:
    """Tell which pixels (h, w) of a picture (h, w, 4) are visible."""
    return np.asarray(picture[..., 3] >= VISIBLE_ALPHA)


def reduced(picture: Picture) -> Picture:
    """Shrink a picture (h, w, 4), straight alpha, to a long side of LONGEST_PX px; smaller ones stay as they are.

    Transparent pixels do not contribute to the colour.
    """
    scale = LONGEST_PX / max(picture.shape[:2])
    if scale >= 1:
        return picture
    size = (max(2, round(scale * picture.shape[1])), max(2, round(scale * picture.shape[0])))
    colour = cv2.resize(
        cv2.multiply(picture[..., :3], cv2.merge([picture[..., 3]] * 3), scale=1 / 255),
        size,
        interpolation=cv2.INTER_AREA,
    )
    alpha = cv2.resize(picture[..., 3], size, interpolation=cv2.INTER_AREA)
    straight = colour.astype(np.float64) * 255 / np.maximum(alpha, 1)[..., None]
    return np.concatenate([np.clip(np.rint(straight), 0, 255).astype(np.uint8), alpha[..., None]], axis=2)


def resized_premultiplied(picture: Picture, width: int, height: int) -> NDArray[np.float32]:
    """Resize a picture (h, w, 4), straight alpha, to width and height, px.

    Returns
    -------
    (height, width, 4): sRGB, 0 to 255, times alpha; and alpha, 0 to 1.

    Source: premultiplied alpha, Porter and Duff 1984: transparent pixels then add no colour.
    """
    alpha = picture[..., 3:].astype(np.float32) / 255
    premultiplied = np.concatenate([alpha * picture[..., :3].astype(np.float32), alpha], axis=2)
    filtering = cv2.INTER_AREA if height < picture.shape[0] else cv2.INTER_LINEAR
    resized = cv2.resize(premultiplied, (width, height), interpolation=filtering)
    return np.asarray(resized.reshape(height, width, 4), dtype=np.float32)


def mean_lab(picture: Picture) -> Floats:
    """Mean colour (3,), CIE Lab, of the visible pixels of a picture (h, w, 4)."""
    return np.asarray(lab_from_rgb(picture[visible(picture)][:, :3]).mean(axis=0))


def mean_solid_colour(picture: Picture) -> Floats:
    """Mean colour (3,), sRGB, 0 to 255, of the solid pixels of a picture (h, w, 4)."""
    solid = (picture[..., 3] >= SOLID_ALPHA).astype(np.uint8)
    total = cv2.sumElems(cv2.bitwise_and(picture, picture, mask=solid))[:3]
    return np.array(total) / np.count_nonzero(solid)
