"""Shapes as sums of discs."""

import cv2
import numpy as np

from treestroke.core.types import Floats, Mask


def cover_with_discs(shape: Mask, least: float, most: float) -> Floats:
    """Cover a shape (h, w) with discs that lie in it, large ones first: (n, 3) column, row and radius, px.

    Each next disc is the largest, up to ``most``, about a pixel that none covers; those under ``least`` are left out.

    Source: the medial axis, Blum 1967: a shape is the sum of the largest discs in it.
    """
    inner = cv2.distanceTransform(np.pad(shape.astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    free = np.minimum(inner, most)
    discs = list[tuple[float, float, float]]()
    while free.size and (radius := float(free.max())) >= least:
        row, column = divmod(int(free.argmax()), shape.shape[1])
        discs.append((column + 0.5, row + 0.5, radius))
        cv2.circle(free, (column, row), int(radius), 0.0, -1)
    return np.array(discs, dtype=np.float64).reshape(-1, 3)
