"""Where a trunk that a brush drew stands on the ground."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import arc_lengths
from treestroke.core.types import Floats

REACH = 2.0
"""Radii above the ground below which a trunk's line is drawn anew."""
WIDEST = 4.0
"""Radii: where its ink is wider on either side it is the ground's, not the trunk's."""


def stood(points: Floats, radii: Floats, ink: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Let a trunk's line (n, 2), root first, px, with radii (n,), stand on the middle of its foot, as wide as that is.

    Thinning leads a wide foot's line into one of its corners; near the ground the middles of the rows of ink are the
    line instead, as the two-sketch paper (section 4) has them everywhere. A line that lies rather than stands is given
    back as it is.
    """
    reach = REACH * float(np.percentile(radii[: max(2, len(radii) // 4)], 75))
    ground = _ground(points[0], ink, 2 * reach)
    above = np.flatnonzero((points[:, 1] <= ground - reach) & (arc_lengths(points) <= 4 * reach))
    if len(above) == 0:
        return points, radii
    first = int(above[0])
    rows = _rows(points[first], float(radii[first]), ink, ground)
    if len(rows) == 0 or abs(rows[-1, 0] - points[first, 0]) > reach:
        return points, radii
    return np.vstack([rows[::-1, :2], points[first:]]), np.append(rows[::-1, 2], radii[first:])


def _ground(root: Floats, ink: NDArray[np.bool_], reach: float) -> float:
    """Find the lower edge, y, of the ink that hangs together with a root within reach of it."""
    low = np.maximum(np.floor(root - reach).astype(int), 0)
    x, y = np.floor(root).astype(int) - low
    near = ink[low[1] : int(root[1] + reach) + 1, low[0] : int(root[0] + reach) + 1]
    _, labels = cv2.connectedComponents(near.astype(np.uint8), connectivity=8)
    own = np.flatnonzero((labels == labels[y, x]).any(axis=1)) if near[y, x] else [y]
    return float(own[-1] + low[1] + 1)


def _rows(start: Floats, radius: float, ink: NDArray[np.bool_], ground: float) -> Floats:
    """Give middle x, y and half width (m, 3) of the rows of ink below a place, down to the ground.

    A foot never narrows: what is round is the brush's end.
    """
    found, x, widest = [], float(start[0]), WIDEST * radius
    for y in range(int(start[1]) + 1, int(ground)):
        gaps = np.flatnonzero(~np.concatenate([[False], ink[y], [False]]))
        at = int(np.searchsorted(gaps, x + 1, side="right"))
        left, right = float(gaps[at - 1]), float(gaps[at]) - 1.0
        if not left <= x <= right or right - left > 2 * widest:
            break
        x, radius = 0.5 * (left + right), max(radius, 0.5 * (right - left))
        found.append((x, y + 1.0, radius))
    return np.array(found).reshape(-1, 3)
