"""The normal map of bark, from the brightness of its texture and the pattern of its form."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.mesh.bark_pattern import standardized
from treestroke.core.types import Floats

_FINE, _BROAD = 0.8, 14.0  # px: finer detail is the camera's noise, broader variation is lighting
_STEEPEST = 1.3  # rise over run; steeper slopes would be black in any light
_PX_PER_RADIUS = 122.0  # texture pixels over a stem's radius: 256 are a third of its girth


@dataclass(frozen=True)
class NormalMapParams:
    """Depth of the bark.

    Attributes
    ----------
    depth
        Standard deviation of its height, as a share of the stem's radius, 0 to 0.1.
    from_texture
        Share of the height that comes from the texture's brightness, 0 to 1; the rest comes from the pattern.
    """

    depth: float = 0.012
    from_texture: float = 0.6

    def __post_init__(self) -> None:
        if not 0 <= self.depth <= 0.1 or not 0 <= self.from_texture <= 1:
            raise ValueError(f"depth must be 0 to 0.1 and from_texture 0 to 1, got {self}")


def bark_normal_map(texture: NDArray[np.uint8], pattern: Floats, params: NormalMapParams) -> NDArray[np.uint8]:
    """Compute the tangent-space normal map (h, w, 3) of bark, uint8; 128 is 0.

    Texels darker than their surroundings lie deeper. x is right, y up, z out of the bark. The map tiles in both
    directions, as the texture (h, w, 3), sRGB, and the pattern (h, w) of `bark_pattern`, deviation 1, do.

    Raises
    ------
    ValueError
        Texture and pattern differ in size.

    Notes
    -----
    The normals are those of a height field (Blinn, "Simulation of Wrinkled Surfaces", 1978), encoded as in glTF 2.0,
    section 3.9.3.
    """
    if texture.shape[:2] != pattern.shape:
        raise ValueError(f"texture and pattern must be of one size, got {texture.shape} and {pattern.shape}")
    light = np.log(texture.astype(np.float64).mean(axis=2) + 8.0)
    detail = standardized(_blurred(light, _FINE) - _blurred(light, _BROAD))
    share, smooth = params.from_texture, _blurred(pattern, _FINE)
    height = _PX_PER_RADIUS * params.depth * (share * np.clip(detail, -3, 2) + (1 - share) * smooth)
    rise_x = 0.5 * (np.roll(height, -1, axis=1) - np.roll(height, 1, axis=1))
    rise_y = 0.5 * (np.roll(height, 1, axis=0) - np.roll(height, -1, axis=0))
    slope = np.hypot(rise_x, rise_y)
    limit = _STEEPEST * np.tanh(slope / _STEEPEST) / np.maximum(slope, 1e-9)
    normals = np.stack([-limit * rise_x, -limit * rise_y, np.ones_like(height)], axis=-1)
    normals /= np.sqrt((normals**2).sum(axis=-1, keepdims=True))
    return np.asarray(np.clip(np.rint(128.0 + 127.0 * normals), 0, 255), dtype=np.uint8)


def _blurred(values: Floats, sigma: float) -> Floats:
    """Blur values (h, w) by a Gaussian of ``sigma`` px that wraps around the edges."""
    edge = int(np.ceil(3 * sigma))
    wide = np.pad(values, edge, mode="wrap")
    return np.asarray(cv2.GaussianBlur(wide, (0, 0), sigma)[edge:-edge, edge:-edge])
