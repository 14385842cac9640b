"""Snapping of a loose stroke to the branch beside it (an open active contour solved exactly, Amini et al. 1990)."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import normals, resample, smoothed
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.types import Floats

OFFSETS = 21
"""Number of sideways offsets that are compared at each place."""
EVIDENCE, DISTANCE, BEND = 0.5, 1.2, 400.0
"""Weights of branch odds, distance from the stroke and bending, tuned on strokes jittered by 0.7 % of the photo."""


def snap(line_px: Floats, odds: NDArray[np.float32], reach_px: float, step_px: float) -> Floats:
    """Move a stroke (n, 2), px, sideways by at most ``reach_px`` onto branch pixels, in steps of ``step_px``.

    The stroke is first smoothed; then the cheapest sequence of sideways offsets is found exactly, by dynamic
    programming: branch odds (h, w), smoothed over a branch's width, attract the line, distance from the stroke and
    bending hold it back. The ends stay near the stroke's own. Source: Amini, Weymouth and Jain 1990.
    """
    smooth = _smooth(line_px, step_px, 2.5 * reach_px)
    offsets = np.linspace(-reach_px, reach_px, OFFSETS)
    side = normals(smooth)
    places = smooth[:, None] + offsets[:, None] * side[:, None]
    cost = -EVIDENCE * sample_nearest(odds, places, -6.0) + DISTANCE * (offsets / reach_px) ** 2
    bending = BEND * (step_px / reach_px) * np.subtract.outer(offsets, offsets) ** 2 / reach_px**2
    chosen = offsets[cheapest(cost, bending)]
    return _smooth(smooth + blur(chosen, 2.0)[:, None] * side, step_px, step_px)


def _smooth(line_px: Floats, step_px: float, span_px: float) -> Floats:
    """Smooth a line (n, 2) over ``span_px`` and resample it in equal steps; the ends stay."""
    even = resample(line_px, step_px)
    if len(even) < 3:
        return even
    return resample(blur(even, span_px / step_px), step_px)


def blur(values: Floats, sigma: float) -> Floats:
    """Blur values (n, ...), any unit, along the first axis by ``sigma`` samples; ends and their directions stay."""
    count = len(values)
    flat = values.reshape(count, -1)
    ahead, behind = 2 * flat[0] - flat[:0:-1], 2 * flat[-1] - flat[-2::-1]
    long = np.concatenate([ahead, flat, behind])
    return smoothed(long, sigma)[count - 1 : 2 * count - 1].reshape(values.shape)


def cheapest(cost: Floats, change: Floats) -> NDArray[np.int64]:
    """Return the cheapest columns (n,) down a table (n, k); going from column a to b adds ``change[b, a]``."""
    total, back = cost[0], []
    for row in cost[1:]:
        sums = total[None, :] + change
        best = sums.argmin(axis=1)
        back.append(best)
        total = row + sums[np.arange(len(best)), best]
    columns = [int(total.argmin())]
    for best in reversed(back):
        columns.append(int(best[columns[-1]]))
    return np.array(columns[::-1], dtype=np.int64)
