"""Where the trunk is, if its stroke runs beside it.

Below the crown a trunk is a stripe that differs from what is on both sides of it, whatever its colour. So it can be
found before colours are learnt from the pixels under the stroke.
"""

import numpy as np

from treestroke.core.geometry.polyline import resample
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.types import Floats, Mask, Picture

FURTHEST, WIDEST = 0.13, 0.05
"""How far beside its stroke a trunk is looked for, and its greatest half width, as shares of the tree's height."""
ALONG, ACROSS = 0.006, 0.004
"""Distance between the places that are compared, along the stroke and across it, as shares of the tree's height."""
FEWEST = 12
"""Least number of places along the stroke below the crown."""
APART = 4.0
"""Greatest distance of a trunk from its stroke, in half widths of its clearest stripe, which may be its lit side alone:
a hasty hand misses a trunk by its width, not by more."""
ASIDE = 0.8
"""Stripes overlap whose middles are nearer than this share of both their half widths together."""
CLEAR, CLEARER = 2.0, 1.6
"""Least contrast of a trunk beside the stroke, in deviations of its colours, and how many times that of any other
stripe under the stroke it must be: of 131 strokes on their trunks, some by their edges, none is moved; of 177 beside
them by once or one and a half times their width 106 are moved onto them and 3 away from them."""
NOISE = 4.0
"""Added to deviations, steps of 255: no stripe is smoother than a camera's noise."""


def way_to_trunk(photo: Picture, stroke_px: Floats, crown: Mask, height_px: float) -> Floats:
    """Return the way (2,), px, from a trunk's stroke (n, 2), root first, to the trunk beside it; zeros if it is on it.

    ``photo`` is (h, w, 3), sRGB; ``crown`` (h, w) is where leaves may be.
    """
    line = resample(stroke_px, max(1.0, ALONG * height_px))
    below = line[np.logical_and.accumulate(~sample_nearest(crown, line, False))]
    if len(below) < FEWEST:
        return np.zeros(2)
    chord = below[-1] - below[0]
    across = np.array([-chord[1], chord[0]]) / max(float(np.hypot(*chord)), 1e-9)
    step = max(1.0, ACROSS * height_px)
    offsets = np.arange(-int(FURTHEST * height_px / step), int(FURTHEST * height_px / step) + 1) * step
    colours = sample_nearest(photo, below[:, None] + offsets[:, None] * across, 0).astype(np.float64)
    middle, half, contrast = _stripes(colours, max(1, int(WIDEST * height_px / step)))
    middle, half = offsets[middle], half * step
    near = np.where(np.abs(middle) <= APART * half + 2 * step, contrast, 0.0)
    best = int(near.argmax())
    under = np.abs(middle) <= half + 1.5 * step
    other = np.abs(middle - middle[best]) >= ASIDE * (half + half[best])
    least = max(CLEAR, CLEARER * float(contrast[under & other].max(initial=0.0)))
    return across * middle[best] if near[best] > least and not under[best] else np.zeros(2)


def _stripes(colours: Floats, widest: int) -> tuple[Floats, Floats, Floats]:
    """Return middle, half width and contrast (n,) of all stripes along rows of colours (rows, columns, 3).

    Middles and half widths are in columns; contrast is the distance of a stripe's colour from the nearer one of its two
    sides, in deviations inside the stripe.
    """
    usual = np.median(colours, axis=0)
    noise = float(np.median(np.abs(colours - usual))) + NOISE
    sums, squares = (np.vstack([np.zeros(3), np.cumsum(values, axis=0)]) for values in (usual, usual**2))
    found = []
    for half in range(1, widest + 1):
        side = max(2, half)
        middle = np.arange(half + side + 1, len(usual) - half - side - 1)
        start, end = middle - half, middle + half + 1
        inside = (sums[end] - sums[start]) / (end - start)[:, None]
        spread = np.sqrt(np.maximum((squares[end] - squares[start]) / (end - start)[:, None] - inside**2, 0.0))
        sides = ((sums[start - 1] - sums[start - 1 - side]) / side, (sums[end + 1 + side] - sums[end + 1]) / side)
        contrast = np.minimum(*(np.linalg.norm(inside - other, axis=1) for other in sides))
        found.append((middle, np.full(len(middle), half), contrast / (noise + spread.mean(axis=1))))
    middles, halves, contrasts = (np.concatenate(part) for part in zip(*found, strict=True))
    return middles, halves, contrasts
