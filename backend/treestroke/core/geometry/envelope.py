"""The crown turned about its own middle: how far a tree may reach in depth."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Camera, Floats
from treestroke.core.geometry.polyline import smoothed


@dataclass(frozen=True, eq=False)
class Envelope:
    """A solid of circular sections, one a photo row, each spanning its row of the crown.

    Attributes
    ----------
    camera
        The photo's camera.
    middle_px
        (height,) column of each section's centre, px.
    radius_px
        (height,) radius of each section, px; 0 where the row holds no crown.
    """

    camera: Camera
    middle_px: Floats
    radius_px: Floats

    def reach(self, points_world: Floats) -> Floats:
        """Distance of points (n, 3), metres, from their section's centre over its radius; 1 is the surface."""
        points_px = self.camera.pixels_from_world(points_world)
        row = np.clip(np.floor(points_px[:, 1]).astype(np.int64), 0, self.camera.height - 1)
        x = points_px[:, 0] - self.middle_px[row]
        z = points_world[:, 2] / self.camera.metres_per_pixel
        return np.hypot(x, z) / np.maximum(self.radius_px[row], 1e-9)

    def half_depth(self, points_world: Floats) -> Floats:
        """Greatest |Z| (n,), metres, inside the envelope at the points' X and Y (0 outside it)."""
        points_px = self.camera.pixels_from_world(points_world)
        row = np.clip(np.floor(points_px[:, 1]).astype(np.int64), 0, self.camera.height - 1)
        x = points_px[:, 0] - self.middle_px[row]
        half_px = np.sqrt(np.maximum(self.radius_px[row] ** 2 - x**2, 0.0))
        return half_px * self.camera.metres_per_pixel


def envelope_of_mask(mask: NDArray[np.bool_], camera: Camera) -> Envelope:
    """Turn a crown mask (height, width) about the middle of its rows.

    A row's span is its first to last crown pixel; spans are smoothed over 2 % of the crown's height so
    that one stray twig gives no disc. Rows above and below the crown have radius 0.

    Raises
    ------
    ValueError
        The mask is empty or not of the camera's size.
    """
    if mask.shape != (camera.height, camera.width):
        raise ValueError(f"mask {mask.shape} does not fit the camera {camera}")
    rows = np.flatnonzero(mask.any(axis=1))
    if rows.size == 0:
        raise ValueError("an empty crown has no envelope")
    top, bottom = int(rows[0]), int(rows[-1])
    left = np.interp(np.arange(top, bottom + 1), rows, mask.argmax(axis=1)[rows])
    right = np.interp(np.arange(top, bottom + 1), rows, mask.shape[1] - mask[:, ::-1].argmax(axis=1)[rows])
    sigma = 0.02 * (bottom - top + 1)
    left, right = (smoothed(side, sigma) for side in (left, right))
    middle, radius = np.zeros(camera.height), np.zeros(camera.height)
    middle[:top], middle[bottom + 1 :] = (left[0] + right[0]) / 2, (left[-1] + right[-1]) / 2
    middle[top : bottom + 1], radius[top : bottom + 1] = (left + right) / 2, (right - left) / 2
    return Envelope(camera, middle, radius)
