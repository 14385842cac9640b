"""Where the trunk is, if its stroke runs beside it or begins before it.

Below the crown a trunk is a stripe that differs from what is on both sides of it, whatever its colour. So it can be
found before colours are learnt from the pixels under the stroke.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.polyline import resample
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.trace.stem_sides import sides_seen
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
"""Stripes overlap whose middles are nearer than this share of both their half widths together. One under the stroke
that overlaps the best in part shows half of the trunk; one that holds all of it is the trunk, the best its lit side."""
CLEAR, CLEARER = 2.0, 1.6
"""Least contrast of a trunk beside the stroke, in deviations of its colours, and how many times that of any other
stripe under the stroke it must be: of 150 strokes on their trunks, some by their edges, none is moved; of 200 beside
them by once or one and a half times their width 105 are moved onto them and 2 away from them."""
DOUBTED, DOUBTED_BY = 1.5, 2.5
"""Least contrast of a stripe beside the stroke, and how many times that of any under it, that make the stroke doubtful:
of 63 strokes on their trunks none is doubted; of 255 beside them by 1.5 to 2.5 times their width and not moved 88 are,
86 of them toward the trunk."""
UNSEEN, UNCLEAR_SIDES = 0.9, 0.4
"""Least contrast of a stripe under the stroke, and least clearness of a stem's two sides there, of which one is reached
where there is a trunk: of 43 strokes on their trunks one reaches neither (a cane in a dark room), of 169 that lie 0.2
or 0.3 tree heights beside theirs 101 do."""
USUAL, NEAR = 0.017, 0.015
"""Half width of a usual trunk, and how far beside its stroke its sides are looked for, as shares of the height."""
NOISE = 4.0
"""Added to deviations, steps of 255: no stripe is smoother than a camera's noise."""


BEFORE, LEAST_BEFORE = 0.12, 0.02
"""Greatest and least length of a stroke that lies on the ground before the trunk, as shares of the tree's height."""
LIKE_GROUND, ALIKE = 0.4, 0.8
"""Distance of a colour under the stroke from those beside it, over the trunk's, up to which it is the ground's; and of
the ground's colours above and below the foot, up to which the ground goes on there. (Of 50 strokes down to the foot
none is shortened; of 89 that begin 0.04 to 0.1 below it 41 are, to within 0.02, and none by more.)"""
GROUND_ROWS, TRUNK_ROWS = 0.9, 0.4
"""Least share of places on the ground before the foot, and the greatest one just above it."""
ABOVE_FOOT, BESIDE_FOOT = 8, 5
"""Places just above the foot by which the trunk, and the ground beside it, are judged."""


@dataclass(frozen=True, eq=False)
class _Strip:
    """The photo on both sides of a stroke, below the crown.

    Attributes
    ----------
    colours
        (rows, columns, 3) sRGB: a row for each place along the stroke, root first, a column for each offset.
    line
        (rows, 2) the stroke there, px.
    offsets, across
        (columns,) distances from the stroke, px, along the direction (2,).
    along, step
        Distance between rows, and between columns, px.
    """

    colours: Floats
    line: Floats
    offsets: Floats
    across: Floats
    along: float
    step: float


def _strip(photo: Picture, stroke_px: Floats, crown: Mask, height_px: float) -> _Strip | None:
    """Return the photo (h, w, 3) beside a stroke (n, 2), px, below a crown (h, w); None where too little lies there."""
    along, step = max(1.0, ALONG * height_px), max(1.0, ACROSS * height_px)
    line = resample(stroke_px, along)
    below = line[np.logical_and.accumulate(~sample_nearest(crown, line, False))]
    if len(below) < FEWEST:
        return None
    chord = below[-1] - below[0]
    across = np.array([-chord[1], chord[0]]) / max(float(np.hypot(*chord)), 1e-9)
    offsets = step * np.arange(-int(FURTHEST * height_px / step), int(FURTHEST * height_px / step) + 1.0)
    colours = sample_nearest(photo, below[:, None] + offsets[:, None] * across, 0).astype(np.float64)
    return _Strip(colours, below, offsets, across, along, step)


def way_to_trunk(photo: Picture, stroke_px: Floats, crown: Mask, height_px: float) -> tuple[Floats, bool]:
    """Return the way (2,), px, from a trunk's stroke (n, 2), root first, to the trunk, and whether that is sure.

    It is zero where the stroke is on the trunk, and where nothing beside it looks more like one; not sure then where
    nothing under it looks like one, either. ``photo`` is (h, w, 3), sRGB; ``crown`` (h, w) is where leaves may be.
    """
    strip = _strip(photo, stroke_px, crown, height_px)
    if strip is None:
        return np.zeros(2), True
    step = strip.step
    middle, half, contrast = _stripes(strip.colours, max(1, int(WIDEST * height_px / step)))
    middle, half = strip.offsets[middle], half * step
    near = np.where(np.abs(middle) <= APART * half + 2 * step, contrast, 0.0)
    best, clearest = int(near.argmax()), int(contrast.argmax())
    under = np.abs(middle) <= half + 1.5 * step
    away = np.abs(middle - middle[best])
    rival = (away >= ASIDE * (half + half[best])) | (away + half[best] <= half)
    least = max(CLEAR, CLEARER * float(contrast[under & rival].max(initial=0.0)))
    if near[best] > least and not under[best]:
        return strip.across * middle[best], True
    least = max(DOUBTED, DOUBTED_BY * float(contrast[under].max(initial=0.0)))
    if contrast[clearest] > least:
        return strip.across * middle[clearest], False
    unseen = float(contrast[under].max(initial=0.0)) < UNSEEN
    reach = (USUAL + NEAR) * height_px
    return np.zeros(2), not (unseen and sides_seen(strip.line, photo, USUAL * height_px, reach) < UNCLEAR_SIDES)


def ground_before_trunk(photo: Picture, stroke_px: Floats, crown: Mask, height_px: float) -> float:
    """Return the length, px, of the first part of a trunk's stroke (n, 2) that lies on the ground before its foot.

    It is 0 where that is not sure: where the ground beside the foot does not go on above it, a hedge may hide the foot.
    ``photo`` is (h, w, 3), sRGB; ``crown`` (h, w) is where leaves may be.
    """
    strip = _strip(photo, stroke_px, crown, height_px)
    if strip is None:
        return 0.0
    most = min(int(BEFORE * height_px / strip.along), len(strip.colours) - FEWEST // 2)
    upper = strip.colours[min(most, len(strip.colours) // 2) :]
    middle, half, contrast = _stripes(upper, max(1, int(WIDEST * height_px / strip.step)))
    contrast = np.where(np.abs(strip.offsets[middle]) <= half * strip.step, contrast, 0.0)
    best = int(contrast.argmax())
    if contrast[best] < CLEAR:
        return 0.0
    inside, sides = _inside_and_sides(strip.colours, int(middle[best]), int(half[best]))
    trunk = np.median(inside[most:], axis=0)
    apart = np.linalg.norm(trunk - sides, axis=2).min(axis=0)
    ground = np.linalg.norm(inside - sides, axis=2).min(axis=0) < LIKE_GROUND * apart
    foot = int(np.cumsum(2 * ground[:most] - 1).argmax()) + 1
    if ground[:foot].mean() < GROUND_ROWS or ground[foot : foot + ABOVE_FOOT].mean() > TRUNK_ROWS:
        return 0.0
    beside, length = sides.mean(axis=0), foot * strip.along
    before, after = (np.median(part, axis=0) for part in (beside[:foot][-BESIDE_FOOT:], beside[foot:][:BESIDE_FOOT]))
    goes_on = np.linalg.norm(before - after) <= ALIKE * np.linalg.norm(trunk - after)
    return length if goes_on and length >= LEAST_BEFORE * height_px else 0.0


def _inside_and_sides(colours: Floats, middle: int, half: int) -> tuple[Floats, Floats]:
    """Return the mean colours (rows, 3) in a stripe of a strip (rows, columns, 3), and (2, rows, 3) on both its sides.

    Each is the median of three rows.
    """
    side = max(2, half)
    left, right = middle - half - 1, middle + half + 2
    parts = [(left + 1, right - 1), (left - side, left), (right, right + side)]
    means = np.stack([colours[:, start:end].mean(axis=1) for start, end in parts])
    padded = np.pad(means, [(0, 0), (1, 1), (0, 0)], mode="edge")
    steady = np.median([padded[:, :-2], padded[:, 1:-1], padded[:, 2:]], axis=0)
    return steady[0], steady[1:]


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
