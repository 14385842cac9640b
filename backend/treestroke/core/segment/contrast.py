"""Whether a crown stands out from what is around it."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Mask

SIDE = 700
"""Long side of the photo, px, at which a crown is looked at."""
GRAIN_PX = 3.0
"""Size of leaves' light and dark, at that size."""
SHADES = np.array([24, 12, 12], dtype=np.uint8)
"""Differences in Lab that count as another colour."""
INNER = 0.3
"""Depth inside the crown, over its greatest, from which on nearly all is foliage: strokes are loose."""
LEAST, LEAST_SMOOTH = 0.1, 0.5
"""Difference in colour that a crown has at least, and one whose inside is smoother than what is around it, 0 to 1.

Tuned on 22 good strokes, none of which may fail, and 63 crowns on sky, lawn, walls and other trees, of which 43 do; of
those kept out of that 0 of 8 and 10 of 14.
"""


def stands_out(pixels: NDArray[np.uint8], inside: Mask, side: int) -> bool:
    """Tell whether a crown's inside (h, w) differs from what is around it on a part (h, w, 3) of a photo, sRGB.

    The photo's long side is ``side`` px. Leaves differ from sky and lawn in fine light and dark, or else in colour.
    """
    scale = min(1.0, SIDE / side)
    size = max(1, round(inside.shape[1] * scale)), max(1, round(inside.shape[0] * scale))
    small = np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
    within = cv2.resize(inside.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST) > 0
    if within.all() or not within.any():
        return True
    depth = cv2.distanceTransform(np.pad(within.astype(np.uint8), 1), cv2.DIST_L2, 3)[1:-1, 1:-1]
    colours = np.asarray(cv2.cvtColor(small, cv2.COLOR_RGB2LAB), dtype=np.uint8)
    differs = _divergence(colours[depth > INNER * depth.max()], colours[~within])
    grain = _grain(small)
    return differs >= (LEAST if grain[within].mean() >= grain[~within].mean() else LEAST_SMOOTH)


def _grain(pixels: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Fine light and dark (h, w) of a photo."""
    grey = cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY).astype(np.float32)
    return np.asarray(cv2.absdiff(grey, cv2.GaussianBlur(grey, (0, 0), GRAIN_PX)), dtype=np.float32)


def _divergence(one: NDArray[np.uint8], other: NDArray[np.uint8]) -> float:
    """How far two sets of colours (n, 3), Lab, are apart, 0 to 1 (Jensen and Shannon's divergence of their counts)."""
    shares = [_shares(colours) for colours in (one, other)]
    middle = (shares[0] + shares[1]) / 2
    return float(sum(_entropy(share, middle) for share in shares) / 2)


def _shares(colours: NDArray[np.uint8]) -> Floats:
    """Share of each shade among colours (n, 3), Lab."""
    lightness, red, yellow = (255 // SHADES + 1).tolist()
    of_lightness, of_red, of_yellow = (colours // SHADES).T.astype(np.int64)
    cells = (of_lightness * red + of_red) * yellow + of_yellow
    return np.bincount(cells, minlength=lightness * red * yellow) / len(colours)


def _entropy(share: Floats, middle: Floats) -> float:
    there = share > 0
    return float((share[there] * np.log2(share[there] / middle[there])).sum())
