"""Leaves in the shade told from ground that is as dark, by how rough they are.

The darkest leaves of a crown, low and within, have the colours of the lawn, road or wall in their shade. But light and
dark change faster among leaves than on these. Among brighter pixels colour decides alone: sky between leaves is bright,
and rough by the leaves around it.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Mask, Picture

AROUND = 0.05
"""Side of the square in which roughness is measured, as a share of the crown's size (the root of its area)."""
DARK = 0.15
"""Share of leaves, the darkest ones, that may have the ground's colours (at 0.2 the trace of a bare tree changes as the
hand shakes)."""
MOST_ODDS = 1.5
"""Limit of the log odds by roughness, in both directions. Tuned with `AROUND` on 24 crowns with known masks,
whose IoU stays, and on a tree over its own shadow, whose lower limbs were lost."""
STRIDE, FEWEST = 2, 100
"""Distance between the pixels that are looked at, and the least number of dark ones, among leaves and beside the crown,
by which roughness is judged."""
OFFSET = 8.0
"""Added to a brightness, steps of 255, before its logarithm is taken: noise in the dark is not rough."""
BINS, FINEST, COARSEST = 32, np.log(0.007), np.log(1.4)
"""Number and range of the steps of log roughness that are counted; the range is that of photos."""
EVERYWHERE = 0.05
"""Share of a count that is spread evenly."""


@dataclass(frozen=True, eq=False)
class Roughness:
    """Brightness, 0 to 255, and the step of roughness around each looked-at pixel of a photo."""

    brightness: NDArray[np.uint8]
    step: NDArray[np.uint8]


def roughness(pixels: Picture, inside: Mask) -> Roughness:
    """Measure how rough a photo (h, w, 3), sRGB, is at the scale of a crown (h, w).

    Roughness is the standard deviation of the logarithm of brightness.
    """
    brightness = cv2.cvtColor(np.ascontiguousarray(pixels[::STRIDE, ::STRIDE]), cv2.COLOR_RGB2GRAY)
    logarithm = cv2.LUT(brightness, np.log(np.arange(256) + OFFSET).astype(np.float32))
    side = 2 * round(0.5 * AROUND * float(np.sqrt(np.count_nonzero(inside))) / STRIDE) + 3
    mean = cv2.blur(logarithm, (side, side))
    variance = cv2.blur(logarithm * logarithm, (side, side)) - mean * mean
    half_log = cv2.log(np.maximum(variance, 1e-6))
    steps = (0.5 * half_log - FINEST) * ((BINS - 1) / (COARSEST - FINEST))
    return Roughness(np.asarray(brightness, dtype=np.uint8), np.clip(steps, 0, BINS - 1).astype(np.uint8))


def log_odds_by_roughness(rough: Roughness, leaves: Mask, inside: Mask) -> NDArray[np.float32]:
    """Return the log odds (h, w) that dark pixels are leaves, by how rough leaves (h, w) are and what is beside them.

    ``inside`` (h, w) is the crown stroke's. 0 for brighter pixels, and where too few are dark to judge by.
    """
    shape, leaves, inside = leaves.shape[::-1], leaves[::STRIDE, ::STRIDE], inside[::STRIDE, ::STRIDE]
    darkest = np.searchsorted(np.cumsum(np.bincount(rough.brightness[leaves], minlength=256)), DARK * leaves.sum())
    dark = rough.brightness < darkest
    within, beside = rough.step[leaves & dark], rough.step[dark & ~inside]
    if min(len(within), len(beside)) < FEWEST:
        return np.zeros(shape[::-1], dtype=np.float32)
    odds = np.log(_shares(within)) - np.log(_shares(beside))
    of_steps = np.clip(odds, -MOST_ODDS, MOST_ODDS).astype(np.float32)[rough.step] * dark
    return np.asarray(cv2.resize(of_steps, shape, interpolation=cv2.INTER_NEAREST))


def _shares(steps: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Return the share (BINS,) of each step among some (n,), smoothed."""
    count = np.convolve(np.bincount(steps, minlength=BINS) / len(steps), (0.25, 0.5, 0.25), "same")
    return np.asarray((1 - EVERYWHERE) * count + EVERYWHERE / BINS)
