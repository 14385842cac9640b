"""Crown and wood as masks: drawn, closed, frayed."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Mask

CLOSED_SHARE = {"leaves": 0.02, "needles": 0.035, "scales": 0.02, "palm": 0.0, "bare": 0.05}
"""Gaps narrower than this share of the crown's size are closed, by what the picture shows."""
LEAFED_SHARE = 0.14
"""The same for a bare tree that is given leaves: the gaps between its twigs."""
CLUMP, FRAY = 0.045, 0.05
"""Size of generated clumps of leaves, and depth of the bays between them, as shares of the crown's size."""
GAP = 1.9
"""Sky shows where the clumps' density is this many standard deviations below its mean."""


def seen_from_front(tree: Skeleton, camera: OrthographicCamera) -> Skeleton:
    """Project a 3D skeleton, metres, to its 2D skeleton in a picture, px."""
    return Skeleton(camera.pixels_from_world(tree.points), camera.pixels_from_metres(tree.radii), tree.parents)


def drawn(tree: Skeleton, shape: tuple[int, ...]) -> Mask:
    """Draw a 2D skeleton, px, as wide as its wood: flags (h, w) of a picture of this shape."""
    return ~np.isnan(drawn_depth(tree, np.ones(len(tree), dtype=bool), np.zeros(len(tree)), shape, 1.0))


def drawn_depth(
    tree: Skeleton, shown: Mask, depth_m: Floats, shape: tuple[int, ...], breadth: float
) -> NDArray[np.float32]:
    """Draw the depth (n,), metres, of a 2D skeleton's (px) edges as (h, w), ``breadth`` times as wide as the wood.

    Only edges with both joints ``shown`` (n,) are drawn; elsewhere the depth is NaN.
    """
    drawn = np.full(shape, np.nan, np.float32)
    joints = np.flatnonzero((tree.parents >= 0) & shown & shown[tree.parents])
    parents = tree.parents[joints]
    sixteenths = np.round((tree.points - 0.5) * 16).astype(int)
    widths = np.maximum(1, (breadth * (tree.radii[joints] + tree.radii[parents])).astype(int))
    edges = (sixteenths[parents], sixteenths[joints], depth_m[joints], widths)
    for start, end, depth, width in zip(*(column.tolist() for column in edges), strict=True):
        cv2.line(drawn, start, end, depth, width, cv2.LINE_8, 4)
    return drawn


def closed(mask: Mask, share: float) -> Mask:
    """Close gaps of a foliage mask (h, w) that are narrower than a share of its size."""
    size = max(3, int(2 * share * np.sqrt(mask.sum())) | 1)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    edge = cv2.copyMakeBorder(mask.astype(np.uint8), size, size, size, size, cv2.BORDER_CONSTANT, value=0)
    return cv2.morphologyEx(edge, cv2.MORPH_CLOSE, kernel)[size:-size, size:-size].astype(bool)


def frayed(crown: Mask, rng: np.random.Generator, gap: float = GAP) -> Mask:
    """Fray the outline of a crown (h, w, flags) into clumps of leaves, and open gaps between them.

    Sky shows where the clumps' density is ``gap`` standard deviations below its mean.
    """
    size = float(np.sqrt(crown.sum()))
    height, width = crown.shape
    coarse = (max(2, round(width / (CLUMP * size))), max(2, round(height / (CLUMP * size))))
    clumps = cv2.resize(rng.standard_normal(coarse[::-1]), (width, height), interpolation=cv2.INTER_CUBIC)
    inward = cv2.distanceTransform(np.pad(crown.astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    bays = FRAY * size * np.clip(0.3 - 0.5 * clumps, 0.0, 1.0)
    return np.asarray(crown & (inward > bays) & (clumps > -gap))
