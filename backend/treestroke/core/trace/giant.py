"""Giant trunks, many times thicker than is usual, such as those of baobabs; and the limbs that rise from them."""

import cv2
import numpy as np

from treestroke.core.geometry.polyline import arc_lengths, normals
from treestroke.core.trace.snapping import blur
from treestroke.core.trace.thickness import half_widths
from treestroke.core.types import Floats, Mask

MOST_SHARE, GRAIN = 0.4, 0.008
"""Greatest radius of a giant trunk, and the width of cracks in its bark that are closed, as shares of the height."""
FEW_SIDES, MOST_SIDES = 0.1, 0.7
"""A trunk is a giant if its sides are seen within the usual radius at fewer places below the crown than the first
share (a baobab 0.00; the 20 other photos 0.29 and more), and within a giant's at more than the second."""
FREE = 0.2
"""Least length of a giant's stem below the crown, as a share of the height: over less, its ground may deceive."""
LEAST_PLACES = 4
"""Least number of places below the crown by which a trunk is judged."""
POST = 0.05
"""Greatest width of what stands before a giant's trunk or parts it, a post or a deep fold, as a share of the height."""
LIMBED = 1.1
"""Half-width of a giant's row relative to the median of all from which on limbs leave it there."""
STEADY = 15.0
"""Standard deviation, in steps of a line, over which a giant's bends from its trunk into the limb that goes on."""


def is_giant(below_px: Floats, wood: Mask, usual_px: float, height_px: float) -> bool:
    """Return whether wood (h, w) shows a stem, by its line (n, 2) below the crown, to be thicker than is usual."""
    if len(below_px) < LEAST_PLACES or arc_lengths(below_px)[-1] < FREE * height_px:
        return False
    if (~np.isnan(half_widths(below_px, wood, usual_px)[0])).mean() > FEW_SIDES:
        return False
    return bool((~np.isnan(half_widths(below_px, wood, MOST_SHARE * height_px)[0])).mean() > MOST_SIDES)


def upright(line_px: Floats, bare: Mask, wood: Mask, height_px: float) -> tuple[Floats, Floats]:
    """Return a giant's line (n, 2), px, in the middle of its wood (h, w), and its half-widths (n,) below the crown, px.

    A giant's outline is uneven and its stroke follows one of its limbs. Where it is ``bare`` (n,) its sides are
    therefore taken row by row, beyond posts and folds that stand before it; half-widths are NaN elsewhere.
    """
    level = line_px[bare]
    level[:, 0] = np.median(level[:, 0])
    beyond = np.ones((1, round(POST * height_px) | 1), dtype=np.uint8)
    even = cv2.GaussianBlur(wood.astype(np.float32), (0, 0), GRAIN * height_px) > 0.5
    solid = cv2.morphologyEx(even.astype(np.uint8), cv2.MORPH_CLOSE, beyond) > 0
    sides, middles = half_widths(level, solid, 2 * MOST_SHARE * height_px)
    sides[sides > LIMBED * np.nanmedian(sides)] = np.nan
    seen = np.flatnonzero(~np.isnan(sides))
    if len(seen):
        level += np.interp(np.arange(len(level)), seen, middles[seen])[:, None] * normals(level)
    halves = np.full(len(line_px), np.nan)
    halves[bare] = sides
    return blur(np.vstack([level, line_px[~bare]]), STEADY), halves


def fork_of(limb_px: Floats, axis_px: Floats, radius_px: float) -> int:
    """Return the index of the place on a giant's axis (n, 2), root first, at which a limb leaves it.

    The limb's line (m, 2) begins at the giant's side. Inside the giant it goes straight on as it leaves it, as near as
    the ground lets it: it stays above it by its own ``radius_px``.
    """
    ahead = limb_px[min(len(limb_px) - 1, LEAST_PLACES)] - limb_px[0]
    way = limb_px[0] - axis_px
    straight = way @ ahead / np.maximum(np.hypot(*way.T), 1e-9)
    straight[axis_px[:, 1] > axis_px[0, 1] - radius_px] = -np.inf
    return int(straight.argmax())
