"""The compiled form of `plain_covering`; arrays are C-contiguous."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Indices

def lower(
    nearest: NDArray[np.float32],
    cards: NDArray[np.float32],
    kinds: Indices,
    dots: NDArray[np.float32],
    starts: Indices,
) -> None:
    """Lower depths as `plain_covering.lower` does.

    Raises
    ------
    ValueError
        The arrays do not fit together.
    """
