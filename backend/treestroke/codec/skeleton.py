"""Skeletons as plain lists, for JSON."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from treestroke.core.skeleton.skeleton import Skeleton

_DIGITS = 2
"""Of a pixel: finer than any photo shows."""


def plain_skeleton(skeleton: Skeleton | None, stroke: NDArray[np.int64]) -> dict[str, list[Any]]:
    """Write a traced skeleton, px, and each joint's stroke (its index or -1) as lists, empty without a skeleton."""
    if skeleton is None:
        return {"points": [], "radii": [], "parents": [], "stroke": []}
    return {
        "points": skeleton.points.round(_DIGITS).tolist(),
        "radii": skeleton.radii.round(_DIGITS).tolist(),
        "parents": skeleton.parents.tolist(),
        "stroke": stroke.tolist(),
    }
