"""The relief of bark: normals that light falls on, from a texture's own detail and the pattern of its kind."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.mesh.grain import unit
from treestroke.core.types import Floats

_FINE, _BROAD = 0.8, 14.0  # px: finer is the camera's noise, broader is light and no relief
_STEEPEST = 1.3  # rise over run; steeper would be black in any light
_PX_PER_RADIUS = 122.0  # texture pixels over a stem's radius: 256 are a third of its girth


@dataclass(frozen=True)
class ReliefParams:
    """How deep a bark is.

    Attributes
    ----------
    depth
        Deviation of its height, as a share of the stem's radius, 0 to 0.1.
    own
        Share of that which comes from the texture's own light and dark; the pattern has the rest.
    """

    depth: float = 0.012
    own: float = 0.6

    def __post_init__(self) -> None:
        if not 0 <= self.depth <= 0.1 or not 0 <= self.own <= 1:
            raise ValueError(f"a relief's depth must be 0 to 0.1 and its own share 0 to 1, got {self}")


def bark_relief(texture: NDArray[np.uint8], grain: Floats, params: ReliefParams) -> NDArray[np.uint8]:
    """Turn a bark texture (h, w, 3), sRGB, and its pattern (h, w) into normals (h, w, 3), 128 being 0.

    What is darker than its surroundings lies deeper. x is right, y up, z out of the bark; the relief repeats in both
    directions as the texture does.

    Raises
    ------
    ValueError
        Texture and pattern differ in size.
    """
    if texture.shape[:2] != grain.shape:
        raise ValueError(f"texture and pattern must be of one size, got {texture.shape} and {grain.shape}")
    light = np.log(texture.astype(np.float64).mean(axis=2) + 8.0)
    detail = unit(_around(light, _FINE) - _around(light, _BROAD))
    pattern = _around(grain, _FINE)
    height = _PX_PER_RADIUS * params.depth * (params.own * np.clip(detail, -3, 2) + (1 - params.own) * pattern)
    rise_x = 0.5 * (np.roll(height, -1, axis=1) - np.roll(height, 1, axis=1))
    rise_y = 0.5 * (np.roll(height, 1, axis=0) - np.roll(height, -1, axis=0))
    steep = np.hypot(rise_x, rise_y)
    soft = _STEEPEST * np.tanh(steep / _STEEPEST) / np.maximum(steep, 1e-9)
    normals = np.stack([-soft * rise_x, -soft * rise_y, np.ones_like(height)], axis=-1)
    normals /= np.sqrt((normals**2).sum(axis=-1, keepdims=True))
    return np.asarray(np.clip(np.rint(128.0 + 127.0 * normals), 0, 255), dtype=np.uint8)


def _around(values: Floats, sigma: float) -> Floats:
    """Blur (h, w) around the edges."""
    edge = int(np.ceil(3 * sigma))
    wide = np.pad(values, edge, mode="wrap")
    return np.asarray(cv2.GaussianBlur(wide, (0, 0), sigma)[edge:-edge, edge:-edge])
