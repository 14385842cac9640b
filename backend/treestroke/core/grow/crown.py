"""The crown as growth sees it: in photo pixels, with depth in the same unit."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.envelope import Envelope
from treestroke.core.types import Floats

REFERENCE_WIDTH = 1000.0
"""Crown width, px, to which the pixel figures of growth refer (a photo of 1,500 px)."""


@dataclass(frozen=True, eq=False)
class Crown:
    """Where branches may grow; its frame is (x, y, z): photo px, y down, z toward the viewer in px too.

    Attributes
    ----------
    mask
        (height, width) the foliage.
    middle, radius
        (height,) the envelope's sections, px.
    foot
        (3,) where the stem enters the crown, px.
    unit
        Photo px per pixel of the reference crown.
    """

    mask: NDArray[np.bool_]
    middle: Floats
    radius: Floats
    foot: Floats
    unit: float

    def inside(self, points: Floats) -> NDArray[np.bool_]:
        """Tell which points (..., 3) project into the foliage and lie within the envelope."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        height, width = self.mask.shape
        within = (x >= 0) & (y >= 0) & (x < width) & (y < height)
        column = np.floor(np.where(within, x, 0)).astype(np.int64)
        row = np.floor(np.where(within, y, 0)).astype(np.int64)
        away = x - self.middle[row]
        round_enough = away * away + z * z <= self.radius[row] * self.radius[row]
        return np.asarray(within & self.mask[row, column] & round_enough)

    def turned(self, points: Floats) -> Floats:
        """Turn points (n, 3) by a quarter about the crown's axis; drop those that leave the foliage."""
        row = np.clip(np.floor(points[:, 1]).astype(np.int64), 0, len(self.middle) - 1)
        x = self.middle[row] - points[:, 2]
        turned = np.stack([x, points[:, 1], points[:, 0] - self.middle[row]], axis=1)
        return np.asarray(turned[self.inside(turned)])

    def grid(self, count: int) -> Floats:
        """Spread about ``count`` points (m, 2), px, evenly over the foliage, rows first."""
        step = max(np.sqrt(self.mask.sum() / count), 1.0)
        height, width = self.mask.shape
        x, y = np.meshgrid(np.arange(step / 2, width, step), np.arange(step / 2, height, step))
        points = np.stack([x.ravel(), y.ravel()], axis=1)
        cells = np.floor(points).astype(np.int64)
        return np.asarray(points[self.mask[cells[:, 1], cells[:, 0]]])


def crown_of(mask: NDArray[np.bool_], envelope: Envelope, foot: Floats) -> Crown:
    """Measure the crown of a foliage mask (height, width); ``foot`` is where its stem enters it, px.

    Raises
    ------
    ValueError
        The mask does not fit the envelope's camera.
    """
    if mask.shape != (envelope.camera.height, envelope.camera.width):
        raise ValueError(f"the foliage mask {mask.shape} does not fit the camera {envelope.camera}")
    unit = max(2 * float(envelope.radius_px.max()) / REFERENCE_WIDTH, 1e-3)
    return Crown(np.ascontiguousarray(mask), envelope.middle_px, envelope.radius_px, foot, unit)


def pixels_of(points_world: Floats, camera: Camera) -> Floats:
    """Carry world points (n, 3), metres, into the crown's frame, px."""
    flat = camera.pixels_from_world(points_world)
    return np.column_stack([flat, points_world[:, 2] / camera.metres_per_pixel])


def world_of(points_px: Floats, camera: Camera) -> Floats:
    """Carry points (n, 3) of the crown's frame, px, into the world, metres."""
    return camera.world_from_pixels(points_px[:, :2], points_px[:, 2] * camera.metres_per_pixel)


def in_mask(points: Floats, mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Tell which points (n, 3), px, project into a mask."""
    cells = np.floor(points[:, :2]).astype(np.int64)
    height, width = mask.shape
    within = (cells >= 0).all(axis=1) & (cells[:, 0] < width) & (cells[:, 1] < height)
    cells = np.where(within[:, None], cells, 0)
    return np.asarray(within & mask[cells[:, 1], cells[:, 0]])
