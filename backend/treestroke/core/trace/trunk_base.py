"""The base of a brushed trunk, where it meets the ground."""

import cv2
import numpy as np

from treestroke.core.geometry.polyline import arc_lengths
from treestroke.core.types import Floats, Mask

REACH = 2.0
"""Height above the ground, in radii, below which the trunk's line is replaced."""
WIDEST = 4.0
"""Half width, in radii, beyond which ink is the ground's and not the trunk's."""


def centre_trunk_base(points: Floats, radii: Floats, ink: Mask) -> tuple[Floats, Floats]:
    """Centre a trunk's line (n, 2), root first, px, with radii (n,), px, on its base in the ink (h, w).

    Thinning leads a wide base's line into one of its corners. Near the ground the line therefore follows the middles of
    the rows of ink, with half their widths as radii; the two-sketches paper (section 4) does so everywhere. The line is
    returned unchanged if it does not rise from the ground.
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


def _ground(root: Floats, ink: Mask, reach: float) -> float:
    """Return the y, px, of the lower edge of the ink that is connected with a root (2,), px, within reach of it."""
    low = np.maximum(np.floor(root - reach).astype(int), 0)
    x, y = np.floor(root).astype(int) - low
    near = ink[low[1] : int(root[1] + reach) + 1, low[0] : int(root[0] + reach) + 1]
    _, labels = cv2.connectedComponents(near.astype(np.uint8), connectivity=8)
    rows = np.flatnonzero((labels == labels[y, x]).any(axis=1)) if near[y, x] else [y]
    return float(rows[-1] + low[1] + 1)


def _rows(start: Floats, radius: float, ink: Mask, ground: float) -> Floats:
    """Return the middle (x, y) and half width (m, 3), px, of the rows of ink from a point (2,) down to the ground.

    Half widths never decrease downward: a base that gets narrower is the round end of the brush.
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
