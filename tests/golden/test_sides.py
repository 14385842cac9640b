"""Whether the examples' trees are as rich from the sides, which no photo shows, as from the front."""

from collections.abc import Callable
from functools import cache

import cv2
import numpy as np
import pytest
from tests.conftest import EXAMPLES

import treestroke
from treestroke.core.geometry.silhouette import framing, silhouettes

pytestmark = pytest.mark.golden

EXAMPLE_TREES = ("burr_oak_dusk", "sugar_maple_autumn", "osage_orange_autumn", "oak_02")
TALL_PX = 300
RATIOS = {"outline": (0.7, 1.4), "openness": (0.6, 1.7), "asymmetry": (0.5, 2.0)}
"""Least and greatest ratio of the sides' mean to the front. A crown turned about its trunk has 0.5 to 0.6 of its
asymmetry."""


def outline(mask: np.ndarray) -> float:
    """Return the outline's length over the root of the area."""
    smooth = (cv2.GaussianBlur(mask.astype(np.float32), (0, 0), 0.005 * TALL_PX) > 0.5).astype(np.uint8)
    contours = cv2.findContours(smooth, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0]
    return float(sum(cv2.arcLength(contour, True) for contour in contours) / np.sqrt(mask.sum()))


def openness(mask: np.ndarray) -> float:
    """Return the share of the silhouette, its gaps closed, that is sky."""
    wide = int(0.05 * TALL_PX) | 1
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (wide, wide))
    closed = cv2.morphologyEx(np.pad(mask.astype(np.uint8), wide), cv2.MORPH_CLOSE, kernel)
    return float(1 - mask.sum() / closed.sum())


def asymmetry(mask: np.ndarray) -> float:
    """Return how differently far the crown reaches left and right of its trunk, mean over rows: 0 where it is even."""
    crown = mask[: int(0.75 * TALL_PX)]
    rows, middle = crown[crown.any(axis=1)], mask.shape[1] / 2
    left, right = middle - rows.argmax(axis=1), middle - rows[:, ::-1].argmax(axis=1)
    return float((np.abs(left - right) / np.maximum(np.abs(left) + np.abs(right), 1)).mean())


@cache
def ratios(name: str) -> dict[str, float]:
    """Return the ratio of each figure's mean over three sides to that of the front."""
    tree = treestroke.model(EXAMPLES / f"{name}.jpg", EXAMPLES / f"{name}.strokes.json").tree
    assert tree.leaf is not None
    surfaces = tree.bark, tree.leaf
    front, *sides = silhouettes(surfaces, framing(surfaces, TALL_PX))
    return {
        figure.__name__: float(np.mean([figure(side) for side in sides])) / figure(front)
        for figure in (outline, openness, asymmetry)
    }


@pytest.mark.parametrize("name", EXAMPLE_TREES)
def test_the_sides_are_as_broken_open_and_lopsided_as_the_front(name: str, measured: Callable[[str], None]) -> None:
    found = ratios(name)
    measured(f"sides over front, {name}: " + ", ".join(f"{key} {value:.2f}" for key, value in found.items()))
    for figure, (least, most) in RATIOS.items():
        assert least < found[figure] < most, found
