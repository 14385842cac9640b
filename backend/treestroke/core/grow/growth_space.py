"""The crown as growth sees it: in pixels of a front picture, with depth in the same unit.

In this frame, (x, y, z) with y down and z toward the viewer, every level section of the crown is a circle about z = 0:
a crown that is not as deep as wide is stretched in depth before growth and back again after it.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import CrownVolume, Silhouette
from treestroke.core.geometry.outline_volume import Sections, sections_of
from treestroke.core.types import Floats, Mask

REFERENCE_WIDTH = 1000.0
"""Crown width, px, to which the pixel figures of growth refer (a photo of 1,500 px)."""
MOST_STRETCH = 4.0
"""Greatest factor by which a section is stretched or squeezed in depth to make it round."""


@dataclass(frozen=True, eq=False)
class PixelFrame:
    """Growth's frame.

    Attributes
    ----------
    camera
        Camera of the front picture.
    sections
        The crown's level sections at its rows, px.
    """

    camera: OrthographicCamera
    sections: Sections

    def pixels_of(self, points_world: Floats) -> Floats:
        """Carry world points (n, 3), metres, into the frame: (n, 3), px."""
        flat = self.camera.pixels_from_world(points_world)
        near_m, stretch = self._stretch(flat[:, 1])
        return np.column_stack([flat, self.camera.pixels_from_metres((points_world[:, 2] - near_m) * stretch)])

    def world_of(self, points_px: Floats) -> Floats:
        """Carry points (n, 3) of the frame, px, back into the world: (n, 3), metres."""
        points = self.camera.world_from_pixels(points_px[:, :2])
        near_m, stretch = self._stretch(self.camera.rows_from_heights(points[:, 1]))
        near = self.camera.metres_from_pixels(points_px[:, 2]) / stretch + near_m
        return np.column_stack([points[:, :2], near])

    def _stretch(self, rows_px: Floats) -> tuple[Floats, Floats]:
        """Distance (n,) of the sections' centres before Z = 0, metres, and width over depth (n,), at rows (n,), px."""
        crown = np.flatnonzero(self.sections.radius_px > 0)
        row = np.clip(np.floor(rows_px).astype(np.int64), crown[0], crown[-1])
        stretch = self.sections.radius_px[row] / np.maximum(self.sections.deep_px[row], 1e-9)
        near_m = self.camera.metres_from_pixels(self.sections.near_px[row])
        return near_m, np.clip(stretch, 1 / MOST_STRETCH, MOST_STRETCH)


def pixel_frame(volume: CrownVolume, camera: OrthographicCamera) -> PixelFrame:
    """Return the frame for growing in a crown volume, in the picture of a front camera."""
    return PixelFrame(camera, sections_of(volume, camera))


@dataclass(frozen=True, eq=False)
class GrowthSpace:
    """Where branches may grow, in growth's frame.

    Attributes
    ----------
    mask
        (h, w) the foliage, its holes closed.
    middle, radius
        (h,) centre's column and radius of the crown's section at each row, px.
    foot
        (3,) where the stem enters the crown, px.
    unit
        Pixels per pixel of the reference crown.
    """

    mask: Mask
    middle: Floats
    radius: Floats
    foot: Floats
    unit: float

    def inside(self, points: Floats) -> Mask:
        """Tell which points (..., 3), px, project into the foliage and lie within the sections: flags (...)."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        height, width = self.mask.shape
        within = (x >= 0) & (y >= 0) & (x < width) & (y < height)
        column = np.floor(np.where(within, x, 0)).astype(np.int64)
        row = np.floor(np.where(within, y, 0)).astype(np.int64)
        away = x - self.middle[row]
        round_enough = away * away + z * z <= self.radius[row] * self.radius[row]
        return np.asarray(within & self.mask[row, column] & round_enough)

    def turned(self, points: Floats) -> Floats:
        """Turn points (n, 3), px, by a quarter about the crown's axis: (m, 3), without those that leave the foliage."""
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


def growth_space(front: Silhouette[OrthographicCamera], sections: Sections, foot: Floats) -> GrowthSpace:
    """Return the space within a front silhouette and the crown's sections, px; the stem enters it at ``foot`` (3,), px.

    Raises
    ------
    ValueError
        The silhouette does not fit its camera.
    """
    if front.mask.shape != (front.camera.height, front.camera.width):
        raise ValueError(f"the foliage mask {front.mask.shape} does not fit the camera {front.camera}")
    unit = max(2 * float(sections.radius_px.max()) / REFERENCE_WIDTH, 1e-3)
    return GrowthSpace(np.ascontiguousarray(front.mask), sections.middle_px, sections.radius_px, foot, unit)


def in_mask(points: Floats, mask: Mask) -> Mask:
    """Tell which points (n, 3), px, project into a mask (h, w): flags (n,)."""
    cells = np.floor(points[:, :2]).astype(np.int64)
    height, width = mask.shape
    within = (cells >= 0).all(axis=1) & (cells[:, 0] < width) & (cells[:, 1] < height)
    cells = np.where(within[:, None], cells, 0)
    return np.asarray(within & mask[cells[:, 1], cells[:, 0]])
