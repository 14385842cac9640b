"""Statistics of 8-bit values by counting them."""

import numpy as np
from numpy.typing import NDArray


def median_of_bytes(values: NDArray[np.uint8]) -> float:
    """Return the median of values (n,), 0 to 255, one at least; it equals numpy's, which sorts, and is faster."""
    up_to = np.cumsum(np.bincount(values, minlength=256))
    lower, upper = np.searchsorted(up_to, ((len(values) - 1) // 2, len(values) // 2), side="right")
    return float(lower + upper) / 2
