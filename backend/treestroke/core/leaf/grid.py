"""The foliage as the photo shows it, on a coarse grid: where it is and what colour it has."""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Camera
from treestroke.core.paint.palette import flattened, lab_from_rgb
from treestroke.core.types import Floats, Indices, Mask, Picture

CELLS_ACROSS = 500
"""Cells over the foliage's width: a spray is about 10 cells wide, a leaf 2 to 3."""
MIN_STEP_PX = 0.25
"""A tiny tree is laid out finer than its pixels, but not without end."""
PADDING = 3
"""Empty cells around the foliage, so that points outside read as outside."""
LOCAL_CELLS, BROAD_CELLS = 0.6, 5.0
"""Standard deviations of the local means of colour, cells: a leaf (its own light and dark), and a whole spray."""


@dataclass(frozen=True, eq=False)
class FoliageGrid:
    """Square cells over the foliage's box.

    Attributes
    ----------
    camera
        The photo's camera.
    step_px
        Side of a cell, px.
    corner_px
        (x, y) of the grid's top-left corner, px.
    inside
        (rows, columns) whether most of the cell is foliage.
    front
        (rows, columns) world Z, metres, behind which leaves may lie: infinite in the foliage, that of the wood where
        wood is seen, minus infinite elsewhere.
    labs, broad_labs
        (rows * columns, 3) mean of the foliage's colour over a leaf and over a spray, CIE Lab, light flattened as
        the atlas's; outside the foliage the colour of the nearest part of it.
    """

    camera: Camera
    step_px: float
    corner_px: tuple[float, float]
    inside: Mask
    front: NDArray[np.float32]
    labs: Floats
    broad_labs: Floats

    @property
    def cell_m(self) -> float:
        """Side of a cell, metres."""
        return self.step_px * self.camera.metres_per_pixel

    def columns_rows(self, x_m: Floats, y_m: Floats) -> tuple[Floats, Floats]:
        """Place world X and Y, metres, in the grid: continuous columns and rows."""
        root_x, root_y = self.camera.root_px
        column = (x_m / self.camera.metres_per_pixel + root_x - self.corner_px[0]) / self.step_px
        row = (root_y - self.corner_px[1] - y_m / self.camera.metres_per_pixel) / self.step_px
        return column, row

    def flat_cells(self, x_m: Floats, y_m: Floats) -> Indices:
        """Index into the flattened grid of the cells that hold world X and Y; points outside give its border."""
        column, row = self.columns_rows(x_m, y_m)
        rows, columns = self.inside.shape
        column_index = np.clip(column, 0, columns - 1).astype(np.int64)
        return np.asarray(np.clip(row, 0, rows - 1).astype(np.int64) * columns + column_index)

    def x_y_of(self, flat: Indices, within: Floats) -> tuple[Floats, Floats]:
        """World X and Y of places within cells: flat index (n,) and position in the cell (n, 2), 0 to 1."""
        row, column = np.divmod(flat, self.inside.shape[1])
        x_px = self.corner_px[0] + (column + within[:, 0]) * self.step_px
        y_px = self.corner_px[1] + (row + within[:, 1]) * self.step_px
        points = self.camera.world_from_pixels(np.stack([x_px, y_px], axis=1))
        return points[:, 0], points[:, 1]


def foliage_grid(photo: Picture, front: NDArray[np.float32], camera: Camera) -> FoliageGrid:
    """Lay a grid over the foliage and average the photo (h, w, 3) in its cells.

    ``front`` (h, w) is infinite in the foliage, the wood's world Z where the photo shows wood, else minus infinite.

    Raises
    ------
    ValueError
        There is no foliage, or the map is not of the photo's size.
    """
    mask = np.isposinf(front)
    if mask.shape != photo.shape[:2] or not mask.any():
        raise ValueError(f"a foliage grid needs a mask with foliage of the photo's size, got {mask.shape}")
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    top, bottom, left, right = int(rows[0]), int(rows[-1]) + 1, int(columns[0]), int(columns[-1]) + 1
    step = max(MIN_STEP_PX, (right - left) / CELLS_ACROSS)
    step = step if step >= 1 else 1 / round(1 / step)  # finer cells than pixels share the pixels' borders
    shrink = cv2.INTER_AREA if step >= 1 else cv2.INTER_NEAREST
    size = (max(1, round((right - left) / step)), max(1, round((bottom - top) / step)))
    part = mask[top:bottom, left:right].astype(np.uint8)
    foliage = cv2.bitwise_and(photo[top:bottom, left:right], photo[top:bottom, left:right], mask=part)
    share = _padded(cv2.resize(part * np.uint8(255), size, interpolation=shrink) / np.float32(255))
    total = _padded(cv2.resize(foliage, size, interpolation=shrink).reshape(*size[::-1], 3))
    inside = np.asarray(share > 0.5) if (share > 0.5).any() else np.asarray(share > 0)
    fine, broad = (_mean_labs(total, share, sigma, inside) for sigma in (LOCAL_CELLS, BROAD_CELLS))
    near = cv2.resize(front[top:bottom, left:right].astype(np.float32), size, interpolation=cv2.INTER_NEAREST)
    near = np.pad(near, PADDING, constant_values=-np.inf)
    behind = np.where(inside, np.inf, np.where(np.isfinite(near), near, -np.inf)).astype(np.float32)
    nearest = _nearest_inside(inside)
    corner = (left - PADDING * step, top - PADDING * step)
    return FoliageGrid(camera, step, corner, inside, behind, fine[nearest], broad[nearest])


def _padded(image: NDArray[Any]) -> NDArray[np.float32]:
    """Add the empty border, and compute in float32 from here on."""
    border = [(PADDING, PADDING), (PADDING, PADDING), (0, 0)][: image.ndim]
    return np.pad(image.astype(np.float32), border)


def _mean_labs(colour: NDArray[np.float32], share: NDArray[np.float32], sigma: float, inside: Mask) -> Floats:
    """Local mean colour of the cells inside (n, 3)."""
    total = cv2.GaussianBlur(colour, (0, 0), sigma)
    amount = cv2.GaussianBlur(share, (0, 0), sigma)
    mean = np.clip(total / np.maximum(amount, np.float32(1e-4))[..., None], 0, 255).astype(np.uint8)
    return flattened(lab_from_rgb(mean[inside]))


def _nearest_inside(inside: Mask) -> Indices:
    """For each cell of the grid, flat, the nearest cell inside, as a rank among those."""
    _, labels = cv2.distanceTransformWithLabels(
        (~inside).astype(np.uint8), cv2.DIST_L2, 3, labelType=cv2.DIST_LABEL_PIXEL
    )
    rank = np.zeros(int(labels.max()) + 1, dtype=np.int64)
    rank[labels[inside]] = np.arange(np.count_nonzero(inside))
    return np.asarray(rank[labels].ravel())
