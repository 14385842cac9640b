"""Both sides of a stem below the crown, followed together: a stripe whose middle and width change slowly.

Colours tell bark from what is behind it only where the two differ: a trunk is charred below and light above, and has
the colours of the lawn that it stands on. But along a trunk two edges run side by side, while all else changes.
"""

import cv2
import numpy as np

from treestroke.core.geometry.polyline import normals
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.trace.snapping import blur
from treestroke.core.trace.thickness import to_edges
from treestroke.core.types import Floats, Indices, Picture

FEWEST_BARE = 9
"""Least number of places below the crown along which a stem's sides are followed."""
SMOOTH, STEADY = 10.0, 4.0
"""Standard deviations, places along a stem, over which the stroke's line is smoothed before its sides are looked for,
and over which the middle between them is averaged. (Of 76 strokes on 19 trunks with known sides, shaky and waving ones,
the middle comes out 0.11 radii beside the true one in the mean, and the radius 6 % from it; by the colours of wood 0.12
radii and 7 %, with bends where what is behind the trunk has its colours.)"""
STEPS = 5
"""Steps across a stem's usual half-width in which its sides are looked for."""
ALONG, ACROSS, FINEST_PX = 1.5, 0.8, 0.7
"""Standard deviations, places along and steps across, and least px across, over which colours are averaged."""
STRONG, FAINT = 0.8, 2.0
"""Rank of edges beside a stem, at each place, beyond which a stronger one counts no more: it is another thing's; and
strength, Lab units a step, up to which an edge is none, but noise."""
USUAL, UNUSUAL = 0.35, 0.1
"""Standard deviation of the logarithm of a half-width about the usual one, and what one that far off costs twice."""
ROW, HIDDEN = 2.0, 0.25
"""Standard deviation, places along a stem, over which the clearness of its sides is averaged, and the least, of 1, at
which they are seen: a hedge may stand before it."""
ASIDE = 0.1
"""What a middle as far beside the line as is looked for costs, in edges of full strength."""
SWAY, WIDEN = 0.15, 0.3
"""What it costs to move the middle, and to change the half-width, by one step from one place to the next."""


def bare_stem(line_px: Floats, photo: Picture, usual_px: float, reach_px: float) -> tuple[Floats, Floats]:
    """Return the line (n, 2) in the middle of a bare stem beside a stroke's (n, 2), and its half-widths (n,), px.

    The photo is (h, w, 3), sRGB; the stem's middle lies up to ``reach_px`` from the line, its half-widths around
    ``usual_px``. They are NaN where a side is not seen.
    """
    axis, widest = blur(line_px, SMOOTH), 2 * usual_px
    widths, offsets, clear = _sides(axis, photo, usual_px, reach_px)
    _, middles = to_edges(axis, (widths, offsets), photo, widest + reach_px)
    line = axis + blur(middles, STEADY)[:, None] * normals(axis)
    halves, _ = to_edges(line, (widths, np.zeros(len(line))), photo, widest)
    return line, np.where(blur(clear, ROW) < HIDDEN, np.nan, halves)


def sides_seen(line_px: Floats, photo: Picture, usual_px: float, reach_px: float) -> float:
    """Return how clear, 0 to 1, both sides of a stem beside a stroke's line (n, 2), px, are in a photo (h, w, 3)."""
    return float(_sides(blur(line_px, SMOOTH), photo, usual_px, reach_px)[2].mean())


def joined(below_px: Floats, line_px: Floats) -> Floats:
    """Return a line (n, 2), px, that begins with another one (m, 2) of as many first places, and turns into its own."""
    count = len(below_px)
    share = np.minimum((count - np.arange(count)) / STEADY, 1.0)[:, None]
    return np.concatenate([share * below_px + (1 - share) * line_px[:count], line_px[count:]])


def _sides(line_px: Floats, photo: Picture, usual_px: float, reach_px: float) -> tuple[Floats, Floats, Floats]:
    """Return half-widths and middles (n,), px, of the stripe beside a line (n, 2) with the strongest edges.

    The third is the strength (n,), 0 to 1, of the weaker edge. The stripe is found exactly, by dynamic programming over
    its middle and its half-width.
    """
    step = usual_px / STEPS
    most = int(np.ceil(reach_px / step))
    middles, widths = np.arange(-most, most + 1), np.arange(STEPS // 2, 2 * STEPS + 1)
    edges = _edges(line_px, photo, step, int(most + widths[-1]))
    left, right = (edges.shape[1] // 2 + middles[:, None] + side * widths for side in (-1, 1))
    price = ASIDE * (middles[:, None] / most) ** 2 + UNUSUAL * (np.log(widths / STEPS) / USUAL) ** 2
    middle, width = _cheapest(price - edges[:, left] - edges[:, right]).T
    place = np.arange(len(edges))
    weaker = np.minimum(edges[place, left[middle, width]], edges[place, right[middle, width]])
    return step * widths[width], step * middles[middle], weaker


def _edges(line_px: Floats, photo: Picture, step: float, most: int) -> Floats:
    """Return the strength of edges, 0 to 1, at (n, 2 most + 1) places across a line (n, 2), each ``step`` px apart."""
    across = step * np.arange(-most, most + 1)[:, None] * normals(line_px)[:, None]
    strip = sample_nearest(photo, line_px[:, None] + across, 0)
    colours = cv2.cvtColor(strip.astype(np.float32) / 255.0, cv2.COLOR_RGB2Lab)
    smooth = cv2.GaussianBlur(colours, (0, 0), max(ACROSS, FINEST_PX / step), sigmaY=ALONG)
    edges = np.linalg.norm(np.gradient(smooth, axis=1), axis=2).astype(np.float64)
    strong = np.maximum(np.quantile(edges, STRONG, axis=1, keepdims=True) - FAINT, FAINT)
    return np.asarray(np.clip((edges - FAINT) / strong, 0.0, 1.0))


def _cheapest(cost: Floats) -> Indices:
    """Return the cheapest middle and width (n, 2), as indices, through costs (n, middles, widths)."""
    moves = [(m, w, SWAY * abs(m) + WIDEN * abs(w)) for m in (-1, 0, 1) for w in (-1, 0, 1)]
    count, wide = cost.shape[1:]
    total, back = cost[0], []
    for row in cost[1:]:
        before = np.pad(total, 1, constant_values=np.inf)
        ways = np.stack([before[1 + m : 1 + m + count, 1 + w : 1 + w + wide] + price for m, w, price in moves])
        best = ways.argmin(axis=0)
        back.append(best)
        total = row + np.take_along_axis(ways, best[None], axis=0)[0]
    middle, width = divmod(int(total.argmin()), wide)
    chosen = [(middle, width)]
    for best in reversed(back):
        m, w, _ = moves[int(best[middle, width])]
        middle, width = middle + m, width + w
        chosen.append((middle, width))
    return np.array(chosen[::-1], dtype=np.int64)
