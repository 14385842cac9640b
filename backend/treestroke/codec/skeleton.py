"""Skeletons as plain lists, for JSON."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.pipeline.grown_tree import LiveTree
from treestroke.core.skeleton.skeleton import Skeleton

_DIGITS = 2
"""Of a pixel: finer than any photo shows."""
_DIGITS_AT_10_M = 4
"""Of a metre; a tree ten times as high has one digit less."""


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


def plain_camera(camera: OrthographicCamera) -> dict[str, Any]:
    """Write a camera as the GLB's ``extras.photo`` has it."""
    return {
        "width": camera.width,
        "height": camera.height,
        "metres_per_pixel": camera.metres_per_pixel,
        "root": list(camera.root_px),
    }


def plain_grown(tree: LiveTree) -> dict[str, Any]:
    """Write a grown tree, metres, and the photo's camera as lists."""
    skeleton, camera = tree.skeleton, tree.camera
    height_m = max(float(np.ptp(skeleton.points[:, 1])), 1e-3)
    digits = _DIGITS_AT_10_M - round(math.log10(height_m / 10))
    return {
        "points": skeleton.points.round(digits).tolist(),
        "radii": skeleton.radii.round(digits).tolist(),
        "parents": skeleton.parents.tolist(),
        "born": tree.born.tolist(),
        "photo": plain_camera(camera),
    }
