"""Twigs of a bare tree before the sky: dark lines too thin for the voxels in which the tree is looked for."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Mask, Opacity, Picture

WIDEST_PX = 13
"""Width, px, up to which what is darker than the sky on both sides is a twig."""
LEAST_SHARE = 0.3
"""Share of a pixel that a twig covers from which on it is followed. Tuned, as the other numbers here, on 18 shots of a
rendered bare oak: mattes reach an IoU of 0.86, not 0.83."""
GAP_PX = 5
"""Side of the square that joins the parts of a broken line, px."""
LEAST_CONTRAST = 40.0
"""How much darker than the sky wood must be, steps of 255."""
SKY_VARIES = 45.0
"""How far from the sky about the tree's top its brightness may be, steps of 255."""
TOP = 0.15
"""Share of the tree's height in the picture, from its top, about which the sky is measured."""
ASIDE_PX, ATTACHED_PX = 12, 7
"""How far from what is neither sky nor tree twigs are followed; and how near the tree it may be part of it."""
MOST_ADDED = 0.5
"""Greatest area of the twigs, over the tree's: more is a background that is no sky."""
DARK = 0.3
"""Quantile of the tree's brightness that a twig has."""


def with_twigs(picture: Picture, opacity: Opacity) -> Opacity:
    """Add the twigs that leave a bare tree to its opacity (h, w), as far as they stand before the sky.

    ``picture`` (h, w, 3), sRGB. A pixel's share follows from its brightness between wood and the sky on both sides,
    which is a closing's (black top hat: Meyer 1979; the sky is brighter than wood). Twigs are followed from the tree on
    (hysteresis: Canny 1986).
    """
    tree = np.asarray(opacity >= 0.5)
    if not tree.any():
        return opacity
    share = _shares(cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY).astype(np.float32), tree)
    followed = _joined((share >= LEAST_SHARE) | tree, tree)
    if (followed & ~tree).sum() > MOST_ADDED * tree.sum():
        return opacity
    return np.where(followed, np.maximum(opacity, 0.5 + 0.5 * share), opacity).astype(np.float32)


def _shares(brightness: NDArray[np.float32], tree: Mask) -> NDArray[np.float32]:
    """Return the share (h, w) of each pixel that a twig covers, by brightness (h, w); 0 where no sky is about it."""
    twig = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (WIDEST_PX, WIDEST_PX))
    around = cv2.morphologyEx(cv2.GaussianBlur(brightness, (0, 0), 0.5), cv2.MORPH_CLOSE, twig)
    rows = np.flatnonzero(tree.any(axis=1))
    top = tree[: rows[0] + max(1, int(TOP * (rows[-1] - rows[0])))]
    wood, sky = float(np.quantile(brightness[tree], DARK)), float(np.median(around[: len(top)][top]))
    other = np.abs(around - sky) > SKY_VARIES
    near = cv2.dilate(tree.astype(np.uint8), np.ones((2 * ATTACHED_PX + 1,) * 2, np.uint8)) > 0
    foreign = cv2.morphologyEx((other & ~tree).astype(np.uint8), cv2.MORPH_OPEN, np.ones((5, 5), np.uint8)) * ~near
    beside = cv2.dilate(foreign, np.ones((2 * ASIDE_PX + 1,) * 2, np.uint8)) > 0
    contrast = around - wood
    share = np.clip((around - brightness) / np.maximum(contrast, LEAST_CONTRAST), 0, 1)
    return np.where(beside | other | (contrast < LEAST_CONTRAST), 0, share).astype(np.float32)


def _joined(candidates: Mask, tree: Mask) -> Mask:
    """Return the candidates (h, w) that hang on the tree (h, w), across small gaps."""
    closed = cv2.morphologyEx(candidates.astype(np.uint8), cv2.MORPH_CLOSE, np.ones((GAP_PX, GAP_PX), np.uint8))
    count, labels = cv2.connectedComponents(closed, connectivity=8)
    kept = np.zeros(count, dtype=np.bool_)
    kept[np.unique(labels[tree])] = True
    kept[0] = False
    return np.asarray(candidates & kept[labels])
