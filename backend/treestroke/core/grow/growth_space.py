"""The crown as growth sees it: in the picture space of its front, px."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import CrownVolume, Silhouette
from treestroke.core.geometry.outline_volume import Sections, sections_of
from treestroke.core.types import Floats, Indices, Mask

REFERENCE_WIDTH = 1000.0
"""Crown width, px, to which the pixel figures of growth refer (a photo of 1,500 px)."""
DEPTHS = 2500
"""Number of places within the crown's sections that may attract branches in space."""
SHELL = 0.5
"""How far out in its section, as a share of the way, a place attracts branches: what is inside is filled on the way."""
LEAST_PX = 1e-9
"""What stands for the width and depth of a section where there is no crown, px."""


@dataclass(frozen=True, eq=False)
class GrowthSpace:
    """Where branches may grow, px.

    Attributes
    ----------
    mask
        (h, w) the foliage, its holes closed.
    sections
        The crown's level sections at its rows.
    foot
        (3,) where the stem enters the crown.
    unit
        Pixels per pixel of the reference crown.
    depths
        (m, 3) places spread evenly over the outer part of the crown's volume.
    """

    mask: Mask
    sections: Sections
    foot: Floats
    unit: float
    depths: Floats

    def inside(self, points: Floats) -> Mask:
        """Tell which points (..., 3), px, project into the foliage and lie within the sections: flags (...)."""
        x, y = points[..., 0], points[..., 1]
        height, width = self.mask.shape
        within = (x >= 0) & (y >= 0) & (x < width) & (y < height)
        column = np.floor(np.where(within, x, 0)).astype(np.int64)
        away, deep = self._from_middle(points, row := self._rows(points))
        return np.asarray(within & self.mask[row, column] & (away * away + deep * deep <= 1))

    def reach(self, points: Floats) -> Floats:
        """Measure the distance of points (..., 3), px, from their section's middle, over that of its edge: (...)."""
        return np.asarray(np.hypot(*self._from_middle(points, self._rows(points))))

    def grid(self, count: int) -> Floats:
        """Spread about ``count`` points (m, 2), px, evenly over the foliage, rows first."""
        step = max(np.sqrt(self.mask.sum() / count), 1.0)
        height, width = self.mask.shape
        x, y = np.meshgrid(np.arange(step / 2, width, step), np.arange(step / 2, height, step))
        points = np.stack([x.ravel(), y.ravel()], axis=1)
        cells = np.floor(points).astype(np.int64)
        return np.asarray(points[self.mask[cells[:, 1], cells[:, 0]]])

    def _rows(self, points: Floats) -> Indices:
        return np.clip(np.floor(points[..., 1]), 0, len(self.mask) - 1).astype(np.int64)

    def _from_middle(self, points: Floats, row: Indices) -> tuple[Floats, Floats]:
        sections = self.sections
        across = (points[..., 0] - sections.middle_px[row]) / sections.radius_px[row]
        return across, (points[..., 2] - sections.near_px[row]) / sections.deep_px[row]


def growth_space(crown: CrownVolume, front: Silhouette[OrthographicCamera], foot: Floats) -> GrowthSpace:
    """Return the space within a crown volume and its front silhouette; the stem enters it at ``foot`` (3,), px.

    Raises
    ------
    ValueError
        The silhouette does not fit its camera.
    """
    if front.mask.shape != (front.camera.height, front.camera.width):
        raise ValueError(f"the foliage mask {front.mask.shape} does not fit the camera {front.camera}")
    of = sections_of(crown, front.camera)
    sections = Sections(of.middle_px, np.maximum(of.radius_px, LEAST_PX), of.near_px, np.maximum(of.deep_px, LEAST_PX))
    unit = max(2 * float(of.radius_px.max()) / REFERENCE_WIDTH, 1e-3)
    places = _lattice(of)
    points = front.camera.world_from_picture_space(places)
    depths = places[crown.inside(points) & (crown.reach(points) >= SHELL)]
    return GrowthSpace(np.ascontiguousarray(front.mask), sections, foot, unit, depths)


def _lattice(sections: Sections) -> Floats:
    """Spread points (m, 3), px, evenly over a box about a crown: about `DEPTHS` of them lie within its sections."""
    rows = np.flatnonzero(sections.radius_px > 0)
    middle, radius, near, deep = (
        column[rows] for column in (sections.middle_px, sections.radius_px, sections.near_px, sections.deep_px)
    )
    step = max(float(np.cbrt(np.pi * (radius * deep).sum() / DEPTHS)), 1.0)
    low = np.array([(middle - radius).min(), rows[0], (near - deep).min()])
    high = np.array([(middle + radius).max(), rows[-1] + 1.0, (near + deep).max()])
    axes = (np.arange(start + step / 2, end, step) for start, end in zip(low, high, strict=True))
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def in_mask(points: Floats, mask: Mask) -> Mask:
    """Tell which points (n, 3), px, project into a mask (h, w): flags (n,)."""
    cells = np.floor(points[:, :2]).astype(np.int64)
    height, width = mask.shape
    within = (cells >= 0).all(axis=1) & (cells[:, 0] < width) & (cells[:, 1] < height)
    cells = np.where(within[:, None], cells, 0)
    return np.asarray(within & mask[cells[:, 1], cells[:, 0]])
