"""A crown's outline where none was drawn."""

import cv2
import numpy as np

from treestroke.core.skeleton.branched import Branched
from treestroke.core.types import Floats

MARGIN = 0.06
"""Of the tree's height: as far as leaves stand out from the strokes."""
CORNERS = 24
"""Of the ring around each point of the hull."""


def crown_around(tree: Branched, height: float, canvas: tuple[int, int]) -> Floats:
    """Draw the rounded hull (k, 2), px, round all of a tree but the bare foot of its trunk, within the canvas.

    The trunk is bare up to its first bud, if there is one; of a trunk alone the upper half is taken.
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
