"""Pull a loose stroke onto the branch that it means."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import normals, resample, smoothed
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.types import Floats

OFFSETS = 21
EVIDENCE = 0.5
STRAY = 1.2
BEND = 400.0
"""Weights of colour, distance from the stroke and bending, tuned on strokes jittered by 0.7 % of the photo."""


def snap(line_px: Floats, odds: NDArray[np.float32], reach_px: float, step_px: float) -> Floats:
    """Move a stroke (n, 2), px, sideways by at most ``reach_px`` onto branch pixels, in steps of ``step_px``.

    The stroke is first freed of the hand's tremor; then the cheapest line of sideways offsets is found exactly,
    by dynamic programming: branch pixels (``odds`` (h, w), smoothed over a branch's width) draw it, distance
    from the stroke and bending hold it. The ends stay near the stroke's own.
    """
    smooth = _steadied(line_px, step_px, 2.5 * reach_px)
    offsets = np.linspace(-reach_px, reach_px, OFFSETS)
    side = normals(smooth)
    places = smooth[:, None] + offsets[:, None] * side[:, None]
    cost = -EVIDENCE * sample_nearest(odds, places, -6.0) + STRAY * (offsets / reach_px) ** 2
    bending = BEND * (step_px / reach_px) * np.subtract.outer(offsets, offsets) ** 2 / reach_px**2
    chosen = offsets[_cheapest(cost, bending)]
    return _steadied(smooth + blurred(chosen, 2.0)[:, None] * side, step_px, step_px)


def _steadied(line_px: Floats, step_px: float, span_px: float) -> Floats:
    """Smooth a line over ``span_px`` and walk it in equal steps; the ends stay."""
    walked = resample(line_px, step_px)
    if len(walked) < 3:
        return walked
    return resample(blurred(walked, span_px / step_px), step_px)


def blurred(values: Floats, sigma: float) -> Floats:
    """Blur along the first axis; reflecting about the end points keeps both ends and their direction."""
    count = len(values)
    flat = values.reshape(count, -1)
    ahead, behind = 2 * flat[0] - flat[:0:-1], 2 * flat[-1] - flat[-2::-1]
    long = np.concatenate([ahead, flat, behind])
    return smoothed(long, sigma)[count - 1 : 2 * count - 1].reshape(values.shape)


def _cheapest(cost: Floats, change: Floats) -> NDArray[np.int64]:
    """Find the cheapest way (n,) through a table (n, k), where a step from a to b costs ``change[b, a]`` more."""
    total, back = cost[0], []
    for row in cost[1:]:
        ways = total[None, :] + change
        best = ways.argmin(axis=1)
        back.append(best)
        total = row + ways[np.arange(len(best)), best]
    way = [int(total.argmin())]
    for best in reversed(back):
        way.append(int(best[way[-1]]))
    return np.array(way[::-1], dtype=np.int64)
