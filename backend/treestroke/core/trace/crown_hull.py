"""The crown's outline where none was drawn."""

import cv2
import numpy as np

from treestroke.core.skeleton.branched import Branched
from treestroke.core.types import Floats

MARGIN = 0.06
"""Distance of the outline from the strokes, as a share of the tree's height."""
CORNERS = 24
"""Number of corners of the circle that rounds the hull."""


def estimate_crown(tree: Branched, height: float, canvas: tuple[int, int]) -> Floats:
    """Return the rounded convex hull (k, 2), px, of a tree without the bare part of its trunk, clipped to the canvas.

    The trunk is bare up to its first bud; of a trunk alone the upper half is taken. ``height`` is the tree's, px.
    """
    stem = np.flatnonzero(tree.branch == 0)
    buds = tree.skeleton.parents[1:][np.diff(tree.branch) != 0]
    forks = stem[np.isin(stem, buds)]
    first = int(forks[0]) if len(forks) else int(stem[len(stem) // 2])
    shown = tree.skeleton.points[(tree.branch > 0) | (np.arange(len(tree)) >= first)]
    angle = np.linspace(0.0, 2 * np.pi, CORNERS, endpoint=False)
    ring = MARGIN * height * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    hull = cv2.convexHull((shown[:, None] + ring).reshape(-1, 2).astype(np.float32))[:, 0].astype(np.float64)
    return np.clip(hull, 0.0, np.array(canvas, dtype=np.float64))
