"""Features of two photos that show the same place, found by their descriptors alone."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Indices, Mask
from treestroke.engines.features import LENGTH

_RATIO = 0.8
"""Greatest angle to a feature's best match, over that to the next best (Lowe 2004, section 7.1)."""
_FARTHEST_RAD = 0.9
"""Greatest angle between the descriptors of a match."""


def match_descriptors(first: NDArray[np.float32], second: NDArray[np.float32], ratio: float = _RATIO) -> Indices:
    """Match the features of two photos by their descriptors (n, 128) and (k, 128): pairs of rows (m, 2).

    Each of a pair is the other's best match, and clearly better than the next best for both.
    """
    if len(first) < 2 or len(second) < 2:
        return np.zeros((0, 2), np.int64)
    likeness = first @ second.T
    rows = np.arange(len(first))
    columns = likeness.argmax(axis=1)
    best = likeness[rows, columns]
    mutual = best == likeness.max(axis=0)[columns]
    rows, columns, best = rows[mutual], columns[mutual], best[mutual]
    likeness[rows, columns] = -1.0  # what is left at most is the next best
    next_best = np.maximum(likeness.max(axis=1)[rows], likeness.max(axis=0)[columns])
    kept = clear(best, next_best, ratio)
    return np.column_stack([rows[kept], columns[kept]])


def clear(best: NDArray[np.float32], next_best: NDArray[np.float32], ratio: float) -> Mask:
    """Tell which matches are clear: products (m,) of the descriptors with the best and with the next best."""
    angle = _angle(best)
    return np.asarray((angle < ratio * _angle(next_best)) & (angle < _FARTHEST_RAD))


def _angle(product: NDArray[np.float32]) -> Floats:
    """Return the angles (m,), radians, between descriptors by their products (m,)."""
    return np.arccos(np.clip(np.asarray(product, np.float64) / LENGTH**2, 0.0, 1.0))
