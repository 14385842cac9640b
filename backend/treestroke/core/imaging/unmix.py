"""Colours of what covers a picture in part, freed of the background that shines through."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Indices, Mask, Opacity, Picture

NEAR, FAR = 0.06, 0.3
"""Half sides of the windows in which colours are averaged, shares of the cover's height: what lies beside a place, and
for places with nothing beside them."""
FURTHER = 1e-3
"""Weight of the far window, and of the whole picture after it: each counts where those before hold next to nothing."""
COARSE = 4
"""Factor by which a picture is reduced before it is averaged."""
TINT = 12.0
"""Difference in hue and saturation between cover and background, steps of 255, below which a tint tells nothing."""
FRINGE = 0.03
"""Side of the window in which gaps are near enough to tint what is beside them, a share of the cover's height."""
BORDER = 0.1
"""Weight of a cover's colour at its border, into which the background shines, relative to that amid it."""
OPEN = 0.05
"""Opacity below which a pixel shows the background alone."""
LUMA = np.array([[0.299], [0.587], [0.114]], dtype=np.float32)
"""Share of red, green and blue in luma (ITU-R BT.601)."""

_Colours = NDArray[np.float32]


def unmixed(picture: Picture, opacity: Opacity, sure: Mask) -> Picture:
    """Estimate the colours F (h, w, 3), sRGB, of a cover from pixels I = a F + (1 - a) B with opacities a (h, w).

    First guesses of F and of the background B are the mean colours beside each pixel: of what surely has the cover's
    colour (``sure`` (h, w)), amid it rather than at its border, into which the background shines; and of what nothing
    covers, so that B is the wall or the sky at that height and in the gaps. What they leave unexplained of the pixel is
    added to F in proportion to its opacity. Where nothing covers, the picture stays.

    A matte takes light leaves before a light sky for thin ones. So the more opaque a pixel is, the more of its own
    lightness it keeps; hue and saturation are F's. It takes leaves' edges for leaves, too: so beside gaps, what leads
    from F's hue toward B's goes.

    Source: Forte 2021, "Approximate fast foreground colour estimation", equation 5; keeping the lightness and dropping
    the tint are ours.
    """
    covered = opacity > OPEN
    rows, place = np.flatnonzero(covered.any(axis=1)), np.flatnonzero(covered)
    if len(rows) == 0:
        return picture
    height, colours = int(rows[-1] - rows[0]) + 1, picture.astype(np.float32)
    sure_share = np.where(sure if sure.any() else covered, opacity, np.float32(0))
    inner = np.asarray(cv2.erode(sure_share, np.ones((3, 3), np.uint8)), dtype=np.float32)
    front = _beside(colours, sure_share * (inner + np.float32(BORDER)), height, place)
    back = _beside(colours, (~covered).astype(np.float32), height, place)
    own, share = _planes(colours, place), opacity.take(place)
    left = share * (own - share * front - (1 - share) * back)
    cleared = np.clip(front + _untinted(left, back - front, _beside_gaps(opacity, height).take(place)), 0, 255)
    result = picture.copy()
    lit = _with_lightness(cleared, share * own + (1 - share) * cleared)
    result.reshape(-1, 3)[place] = np.rint(lit).astype(np.uint8).T
    return result


def _planes(colours: _Colours, place: Indices) -> _Colours:
    """Return colours (h, w, 3) at places (n,), flat, channel by channel (3, n): numpy is slow along short rows."""
    return np.stack([plane.take(place) for plane in cv2.split(colours)])


def _untinted(left: _Colours, way: _Colours, near: _Colours) -> _Colours:
    """Take out of colours (3, n) what leads toward the background, grey apart, near (n,) its gaps.

    ``way`` (3, n) leads from the cover's colour to the background's.
    """
    tint = way - _sum(way) / np.float32(3)
    toward = _sum(left * tint) / (_sum(tint * tint) + np.float32(TINT**2))
    return np.asarray(left - (near * np.maximum(toward, 0)) * tint)


def _beside_gaps(opacity: Opacity, height: int) -> Opacity:
    """Tell how near (h, w) gaps are, 0 to 1: four times their share in a window about each pixel."""
    side = 2 * max(1, round(0.5 * FRINGE * height)) + 1
    return np.asarray(np.minimum(4 * (1 - cv2.blur(opacity, (side, side))), 1))


def _with_lightness(colours: _Colours, other: _Colours) -> _Colours:
    """Scale colours (3, n) to the lightness of others (3, n), as far as sRGB holds them."""
    factor = (_sum(LUMA * other) + 1) / (_sum(LUMA * colours) + 1)
    return np.asarray(colours * np.minimum(factor, 255 / np.maximum(colours.max(axis=0), 1)))


def _sum(values: _Colours) -> _Colours:
    """Sum of the three channels (n,) of values (3, n)."""
    return np.asarray(values[0] + values[1] + values[2])


def _beside(colours: _Colours, weight: Opacity, height: int, place: Indices) -> _Colours:
    """Mean colour (3, n) in windows about some places (n,), flat, of pixels (h, w, 3) by their weight (h, w).

    ``height`` is the cover's.
    """
    size = max(1, colours.shape[1] // COARSE), max(1, colours.shape[0] // COARSE)
    parts = (cv2.multiply(colours, cv2.merge([weight] * 3)), weight)
    weighted = cv2.merge([cv2.resize(part, size, interpolation=cv2.INTER_AREA) for part in parts])
    total = np.broadcast_to(np.float32(FURTHER**2) * weighted.mean(axis=(0, 1)), weighted.shape).astype(np.float32)
    for reach, share in ((NEAR, 1.0), (FAR, FURTHER)):
        side = 2 * max(1, round(reach * height / COARSE)) + 1
        total += np.float32(share) * cv2.blur(weighted, (side, side), borderType=cv2.BORDER_REPLICATE)
    mean = total[..., :3] / np.maximum(total[..., 3:], np.float32(1e-12))
    return _planes(np.asarray(cv2.resize(mean, colours.shape[1::-1], interpolation=cv2.INTER_LINEAR)), place)
