"""Where the ground is, if a trunk ends at a hedge, fence or car that hides its foot.

There the photo changes at one level on both sides of the trunk: at the occluder's top, where the stroke ends, and again
at its lower edge. Where a trunk stands on a lawn, what is beside its foot goes on below it.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Picture

BAND = 0.025
"""Height of the bands of rows above and below a level that are compared, as a share of the tree's height."""
BESIDE, FURTHER = (0.03, 0.1), (0.3, 0.4)
"""How far beside the trunk columns are compared, and further away, as shares of the height."""
NOISE = 4.0
"""Added to the deviation of colours, steps of 255: no surface is smoother than a camera's noise."""
AT_TOP, TOP, LOWER = 0.02, 2.0, 2.9
"""How near the stroke's end the top is (share of the height), and the least changes, in deviations, at the top and at
the lower edge. (Of 9 trees whose foot a hedge, fence or car hides, 7 reach both, of 45 others none.)"""
LOWEST, NARROW, WIDE = 0.04, 0.16, 0.35
"""Least height of an occluder, and the greatest of one that is as wide as a car, and of one that goes on beyond
`FURTHER`, as shares of the tree's height."""
GOES_ON = 1.5
"""Least change at the top further away, in deviations, for an occluder to go on there."""
BEHIND = 0.15
"""How far above the occluder's lower edge the trunk stands behind it, as a share of the occluder's height."""

_Map = NDArray[np.float32]


def hidden_ground(photo: Picture, root_px: Floats, height_px: float) -> float | None:
    """Return the row, px, of the ground behind what hides a trunk's foot; None where nothing does.

    ``photo`` is (h, w, 3), sRGB; ``root_px`` (2,) is where the trunk's stroke begins, ``height_px`` the tree's height.
    """
    x, y = root_px
    band = max(2, int(BAND * height_px))
    first, last = int(y - 0.08 * height_px), int(y + WIDE * height_px) + band
    first, last = max(first, 0), min(last, len(photo))
    if last - first < 4 * band:
        return None
    part = cv2.cvtColor(photo[first:last], cv2.COLOR_RGB2LAB).astype(np.float32)
    rows = np.arange(first + band, last - band + 1)
    share = (rows - y) / height_px
    near, far = (_changes(part, x, height_px, reach, band) for reach in (BESIDE, FURTHER))
    at_top = np.abs(share) <= AT_TOP
    if not at_top.any() or near[at_top].max() < TOP:
        return None
    below = (share >= LOWEST) & (share <= (WIDE if far[at_top].max() >= GOES_ON else NARROW))
    if not below.any() or near[below].max() < LOWER:
        return None
    lower = float(rows[below][near[below].argmax()])
    return lower - BEHIND * (lower - float(y))


def _changes(part: _Map, x: float, height_px: float, reach: tuple[float, float], band: int) -> _Map:
    """Return the change of colour (n,), deviations, at each level of a part of a photo (h, w, 3) in Lab.

    It is the smaller one of the changes left and right of a column ``x``, px, at a distance within ``reach``.
    """
    least, most = (share * height_px for share in reach)
    columns = np.arange(part.shape[1]) + 0.5 - x
    sides = [part[:, (turn * columns > least) & (turn * columns <= most)] for turn in (-1, 1)]
    if min(side.shape[1] for side in sides) == 0:
        return np.zeros(len(part) - 2 * band + 1, dtype=np.float32)
    return np.asarray(np.minimum(*(_change(side.mean(axis=1), band) for side in sides)))


def _change(rows: _Map, band: int) -> _Map:
    """Return the change (n,) between the bands of rows (h, 3) above and below each level, in their deviations."""
    windows = np.lib.stride_tricks.sliding_window_view(rows, band, axis=0)
    mean, spread = windows.mean(axis=2), windows.std(axis=2).mean(axis=1)
    apart = np.linalg.norm(mean[band:] - mean[:-band], axis=1)
    return np.asarray(apart / (NOISE + spread[band:] + spread[:-band]))
