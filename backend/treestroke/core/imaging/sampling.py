"""Reading pictures at continuous pixel coordinates."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats


def sample_nearest(image: NDArray[Any], points_px: Floats, outside: Any) -> NDArray[Any]:
    """Read an image (h, w, ...) at points (..., 2), px: the value of the pixel around each; ``outside`` beyond it."""
    column = np.floor(points_px[..., 0]).astype(np.int64)
    row = np.floor(points_px[..., 1]).astype(np.int64)
    height, width = image.shape[:2]
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    values = image[np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)]
    return np.where(inside.reshape(inside.shape + (1,) * (values.ndim - inside.ndim)), values, outside)
