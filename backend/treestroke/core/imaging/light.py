"""How much light a picture shows: sRGB to linear light and back, exposure, and shade taken out."""

from functools import cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Mask, Picture

Light = NDArray[np.floating[Any]]
"""Linear light (..., 3) or (...), 0 to 1."""

LIT = 0.75
"""Quantile of a tree's lightness by which its exposure is judged: leaves and bark that light falls on."""
LEAST_LIGHTNESS = 32.0
"""Lightness, CIE Lab, to which a darker tree's lit parts are brought. Those of 13 dark trees in good light (holm oak,
juniper, spruce, oak) lie at 32 to 44, of three trees at dusk and by night at 12 to 18."""
FADING = 0.25
"""How fast colours fade as they are brightened: saturation falls with the gain to minus this power. In the dark, much
of a hue is the camera's noise and the sky's blue."""
MOST_GAIN = 16.0
"""Greatest gain: in a darker photo there is little more than the camera's noise."""
SHADE_REACH = 0.06
"""Standard deviation of the blur that finds a crown's shade, as a share of the tree's height: of boughs, not leaves."""
MOST_SHADE = 3.0
"""Greatest factor by which shade is lightened and sunlight is dimmed."""
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Share of linear red, green and blue in luminance (ITU-R BT.709)."""
SAMPLES = 50_000
"""Most pixels of a tree, evenly spaced, by which its exposure is judged."""
STEPS = 2**16 - 1
"""Steps of linear light that are told apart on the way to sRGB: twenty between its darkest two values."""
DARK = 0.003
"""Luminance added before logarithms, so that noise in black is no contrast."""


def linear_light(srgb: Floats) -> Floats:
    """Convert sRGB, 0 to 255, to linear light, 0 to 1 (IEC 61966-2-1)."""
    c = srgb / 255.0
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def srgb_light(linear: Light) -> Picture:
    """Convert linear light, clipped to 0 to 1, to sRGB, 0 to 255 (IEC 61966-2-1)."""
    steps = np.clip(linear, 0.0, 1.0) * STEPS + 0.5
    return np.take(_srgb_table(), steps.astype(np.uint16))


def luminance_of_lightness(lightness: Floats) -> Floats:
    """Convert CIE Lab lightness, 0 to 100, to luminance, 0 to 1 (CIE 1976)."""
    return np.where(lightness > 8.0, ((lightness + 16.0) / 116.0) ** 3, lightness / 903.3)


def brightened(linear: Light, gain: float) -> Light:
    """Multiply linear light (n, 3), 0 to 1, by a gain from 1 on, by less the lighter it is: white stays white.

    Hues stay: a colour's channels have one factor, by the largest of them.
    """
    largest = np.maximum(np.maximum(linear[..., 0], linear[..., 1]), linear[..., 2])  # a maximum over an axis is slow
    return np.asarray(linear * (gain / (1.0 + (gain - 1.0) * largest))[..., None])


def exposed(picture: Picture, tree: Mask) -> Picture:
    """Brighten a dark picture (h, w, 3), sRGB, so that the tree on it (h, w) can be seen; others stay as they are.

    One gain in linear light brings the lit parts of the tree to `LEAST_LIGHTNESS`; colours fade a little with it. Only
    the box around the tree is brightened.
    """
    if not tree.any():
        return picture
    place = np.flatnonzero(tree)
    linear = _light_table()[picture.reshape(-1, 3)[place[:: len(place) // SAMPLES + 1]]]
    lit = max(float(np.quantile(linear @ LUMINANCE, LIT)), 1e-6)
    gain = min(float(luminance_of_lightness(np.array(LEAST_LIGHTNESS))) / lit, MOST_GAIN)
    if gain <= 1.0:
        return picture
    left, top, width, height = cv2.boundingRect(tree.astype(np.uint8))
    box = slice(top, top + height), slice(left, left + width)
    # Channel after channel in memory: numpy is slow along short rows.
    planes = np.ascontiguousarray(np.moveaxis(picture[box], -1, 0))
    bright = brightened(np.moveaxis(_light_table().astype(np.float32).take(planes), 0, -1), gain)
    red, green, blue = LUMINANCE.astype(np.float32)
    grey = (bright[..., 0] * red + bright[..., 1] * green + bright[..., 2] * blue)[..., None]
    seen = picture.copy()
    seen[box] = srgb_light(grey + gain**-FADING * (bright - grey))
    return seen


def evened(picture: Picture, tree: Mask) -> Picture:
    """Take the light and shade of boughs out of a tree (h, w) on a picture (h, w, 3), sRGB; leaves keep theirs.

    Source: homomorphic filtering, Oppenheim, Schafer and Stockham 1968: log light less its blur.
    """
    rows = np.flatnonzero(tree.any(axis=1))
    if len(rows) == 0:
        return picture
    linear = _light_table()[picture[tree]]
    logs, weight = np.zeros((2, *tree.shape), dtype=np.float32)
    logs[tree], weight[tree] = np.log(linear @ LUMINANCE + DARK), 1.0
    sigma = max(1.0, SHADE_REACH * (rows[-1] - rows[0] + 1))
    slow = cv2.GaussianBlur(logs, (0, 0), sigma)[tree] / cv2.GaussianBlur(weight, (0, 0), sigma)[tree]
    factor = np.clip(np.exp(slow.mean() - slow), 1 / MOST_SHADE, MOST_SHADE)
    flat = picture.copy()
    flat[tree] = srgb_light(linear * factor[:, None])
    return flat


@cache
def _light_table() -> Floats:
    """Linear light of every 8-bit value (256,)."""
    return linear_light(np.arange(256.0))


@cache
def _srgb_table() -> Picture:
    """sRGB, 0 to 255, of linear light in `STEPS` even steps from 0 to 1."""
    c = np.linspace(0.0, 1.0, STEPS + 1)
    srgb = np.where(c <= 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055)
    return np.asarray(np.rint(255.0 * srgb), dtype=np.uint8)
