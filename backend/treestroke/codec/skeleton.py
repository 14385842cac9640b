"""Skeletons as lists, for the JSON of responses."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.pipeline.grown_tree import LiveTree
from treestroke.core.skeleton.skeleton import Skeleton

_DIGITS = 2
"""Decimals of a pixel: finer than any photo shows."""
_DIGITS_AT_10_M = 4
"""Decimals of a metre, for a tree of 10 m; one less for a tree ten times as high."""


def plain_skeleton(skeleton: Skeleton | None, stroke: NDArray[np.int64]) -> dict[str, list[Any]]:
    """Return a traced skeleton, px, and the stroke index of each joint (n,), or -1, as lists; empty without one."""
    if skeleton is None:
        return {"points": [], "radii": [], "parents": [], "stroke": []}
    return {
        "points": skeleton.points.round(_DIGITS).tolist(),
        "radii": skeleton.radii.round(_DIGITS).tolist(),
        "parents": skeleton.parents.tolist(),
        "stroke": stroke.tolist(),
    }


def plain_camera(camera: OrthographicCamera) -> dict[str, Any]:
    """Return a camera as it stands in the GLB's ``extras.photo``: px and metres per pixel."""
    return {
        "width": camera.width,
        "height": camera.height,
        "metres_per_pixel": camera.metres_per_pixel,
        "root": list(camera.root_px),
    }


def plain_grown(tree: LiveTree) -> dict[str, Any]:
    """Return a grown tree, metres, and the photo's camera as lists."""
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
