"""Foliage that a hasty crown stroke cuts off: the same foliage goes on a little beyond the line, and ends there.

Where foliage goes on far beyond the line it is taken for a neighbour's, for a hedge or for a lawn, and left out.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Mask

RAYS = 720
"""Directions from the crown's middle in which foliage is followed outward."""
FURTHEST = 0.09
"""How far beyond the line cut foliage may reach, as a share of the crown's size (the root of its area)."""
GAP, INSIDE = 0.012, 0.04
"""Gaps in the foliage that are passed, and how far inside the line it must be foliage, too, as shares of the size."""
CLEAR = 0.05
"""How far there must be next to no foliage where it ends, as a share of the size: else it is a sparse neighbour's."""
DENSE = 0.6
"""Share from which on what lies along a ray counts as foliage."""
LEAST = 0.01
"""Least share of the crown that is cut off: a line that cuts less was drawn with care, and stays."""
GRAIN = 0.004
"""Standard deviation over which leaf pixels are counted, as a share of the size."""
SPREAD = 9
"""Rays over which the reach is the median one: single twigs do not count."""


def cut_foliage(odds: NDArray[np.float32], inside: Mask) -> Mask:
    """Return the foliage (h, w) that goes on beyond the line and ends there.

    ``odds`` (h, w) are log odds by colour that a pixel is a leaf, ``inside`` (h, w) is the crown stroke's.
    """
    size = float(np.sqrt(inside.sum()))
    rows, columns = np.nonzero(inside)
    middle = (float(columns.mean()), float(rows.mean()))
    furthest = float(np.hypot(rows - middle[1], columns - middle[0]).max()) + 2 * FURTHEST * size
    leafy = (cv2.GaussianBlur((odds > 0).astype(np.float32), (0, 0), max(0.8, GRAIN * size)) > 0.5).astype(np.uint8)
    shape = (int(furthest), RAYS)
    leaf, crown = (
        cv2.warpPolar(part, shape, middle, furthest, cv2.INTER_NEAREST | cv2.WARP_FILL_OUTLIERS) > 0
        for part in (leafy, inside.astype(np.uint8))
    )
    line = crown.shape[1] - crown[:, ::-1].argmax(axis=1)
    end = line + np.where(line < crown.shape[1], _reach(leaf, line, size), 0)
    x, y = (np.arange(side, dtype=np.float32) - at for side, at in zip(inside.shape[::-1], middle, strict=True))
    radius, turn = cv2.cartToPolar(*np.meshgrid(x, y), angleInDegrees=True)
    ray = np.minimum(turn * (RAYS / 360), RAYS - 1).astype(np.int64)
    cut = ~inside & (leafy > 0) & (radius < end[ray])
    return np.asarray(cut & (np.count_nonzero(cut) >= LEAST * np.count_nonzero(inside)))


def _reach(leaf: Mask, line: NDArray[np.int64], size: float) -> NDArray[np.int64]:
    """Return how far foliage reaches beyond the line (n,) along rays (n, m), px; 0 if none is cut or it never ends."""
    gap, deep, most, clear = (max(1, int(share * size)) for share in (GAP, INSIDE, FURTHEST, CLEAR))
    passed = cv2.morphologyEx(leaf.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((1, 2 * gap + 1), np.uint8)) > 0
    place = np.clip(line[:, None] + np.arange(-deep, most + clear), 0, leaf.shape[1] - 1)
    along = np.take_along_axis(passed, place, axis=1)
    within, after = along[:, :deep], along[:, deep:]
    ends = np.where(after.all(axis=1), after.shape[1], (~after).argmax(axis=1))
    beyond = np.take_along_axis(np.cumsum(after, axis=1), np.minimum(ends + clear, after.shape[1])[:, None] - 1, axis=1)
    ends_clear = (ends < most) & (beyond[:, 0] - ends < (1 - DENSE) * clear)
    reach = np.where((within.mean(axis=1) >= DENSE) & ends_clear, ends, 0)
    rays = np.lib.stride_tricks.sliding_window_view(np.pad(reach, SPREAD // 2, mode="wrap"), SPREAD)
    return np.asarray(np.median(rays, axis=1).astype(np.int64))
