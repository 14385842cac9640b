"""Where a trunk ends that can be seen to go on below its stroke: people begin a stroke above the ground."""

import numpy as np

from treestroke.core.types import Floats, Mask

STEP = 0.004
"""Height of the bands of rows that are looked at one after another, as a share of the tree's height."""
LEAST, MOST = 0.045, 0.3
"""Least and greatest length that is added, as shares of the height: below 36 strokes down to the foot, 0.04 at most is
found; of as many that begin 0.06 above it, 21 go on to within 0.01 of it."""
GAP = 0.012
"""Longest stretch without a stem that is passed, as a share of the height."""
ROOM, WIDEST = 2.2, 3.2
"""How far beside the middle the stem is looked for, and its greatest width, in radii: mulch and shadow are wider."""
CORE = 0.7
"""Least share of the stem's middle half that is wood."""
FOLLOW = 0.3
"""Share by which the middle moves toward what was found, from band to band."""


def visible_foot(wood: Mask, root_px: Floats, radius_px: float, height_px: float) -> Floats | None:
    """Return the place (2,), px, down to which the photo shows a stem of wood (h, w); None if its stroke begins there.

    The stroke begins at ``root_px`` (2,), where the stem's radius is ``radius_px``.
    """
    x, y = root_px.tolist()
    radius, step = max(radius_px, 1.5), max(1, int(STEP * height_px))
    lowest = y
    for row in range(int(y) + step, min(len(wood) - step, int(y + MOST * height_px)), step):
        left = max(0, int(x - ROOM * radius))
        across = wood[row : row + step, left : int(x + ROOM * radius) + 1].mean(axis=0) > 0.5
        core = wood[row : row + step, max(0, int(x - radius / 2)) : int(x + radius / 2) + 1]
        if core.mean() > CORE and np.count_nonzero(across) <= WIDEST * radius:
            x += FOLLOW * (left + 0.5 + float(np.flatnonzero(across).mean()) - x)
            lowest = row + step
        elif row - lowest > GAP * height_px:
            break
    return np.array([x, float(lowest)]) if lowest - y >= LEAST * height_px else None
