"""Whether a crown stands out from what is around it."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Mask

SIDE = 700
"""Long side, px, to which the photo is reduced for this."""
GRAIN_PX = 3.0
"""Size of the light and dark spots of leaves, px at that size."""
BINS = np.array([24, 12, 12], dtype=np.uint8)
"""Width of a histogram's bins in L, a and b, CIE Lab as 8 bits."""
INNER = 0.3
"""Depth inside the crown, relative to its greatest, beyond which nearly all is foliage although strokes are loose."""
LEAST, LEAST_SMOOTH = 0.1, 0.5
"""Least divergence in colour of a good crown, 0 to 1, and of one that is smoother inside than around.

Tuned on 22 good strokes, all of which must pass, and 63 crowns on sky, lawn, walls and other trees, of which 43 fail.
On strokes that were kept out of the tuning, 0 of 8 good ones and 10 of 14 others fail.
"""


def stands_out(pixels: NDArray[np.uint8], inside: Mask, side: int) -> bool:
    """Tell whether a crown's inside (h, w) differs from its surroundings on a part (h, w, 3) of a photo, sRGB.

    The whole photo's long side is ``side`` px. Leaves differ from sky and lawn in fine light and dark, or else in
    colour.
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
    """Fine light and dark (h, w) of a photo, sRGB: its grey's distance, 0 to 255, from its blurred grey."""
    grey = cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY).astype(np.float32)
    return np.asarray(cv2.absdiff(grey, cv2.GaussianBlur(grey, (0, 0), GRAIN_PX)), dtype=np.float32)


def _divergence(first: NDArray[np.uint8], second: NDArray[np.uint8]) -> float:
    """Jensen-Shannon divergence, 0 to 1, of the histograms of two sets of colours (n, 3), CIE Lab as 8 bits.

    Source: Lin 1991, with logarithms to base 2.
    """
    shares = [_shares(colours) for colours in (first, second)]
    middle = (shares[0] + shares[1]) / 2
    return float(sum(_relative_entropy(share, middle) for share in shares) / 2)


def _shares(colours: NDArray[np.uint8]) -> Floats:
    """Share of the colours (n, 3), CIE Lab as 8 bits, in each bin of a histogram (bins,)."""
    l_bins, a_bins, b_bins = (255 // BINS + 1).tolist()
    l_bin, a_bin, b_bin = (colours // BINS).T.astype(np.int64)
    bins = (l_bin * a_bins + a_bin) * b_bins + b_bin
    return np.bincount(bins, minlength=l_bins * a_bins * b_bins) / len(colours)


def _relative_entropy(share: Floats, middle: Floats) -> float:
    """Kullback-Leibler divergence, in bits, of a histogram (bins,) from another."""
    occurs = share > 0
    return float((share[occurs] * np.log2(share[occurs] / middle[occurs])).sum())
