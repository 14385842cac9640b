"""The foliage as one view shows it, on a coarse grid: where it is and what colour it has."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.appearance import View
from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.paint.palette import SPRAY, lab_from_rgb, unshaded
from treestroke.core.types import Floats, Indices, Mask

CELLS_ACROSS = 800
"""Cells over the foliage's breadth: a spray is about 16 cells wide, a leaf 4 (500 cells hide 2 % less of the foliage;
1200 are no better; 6 crowns)."""
CELLS_OF_MANY = 400
"""The same where many views show a crown: they bound its leaves together."""
MIN_STEP_PX = 0.25
"""Least side of a cell: a tiny tree's cells are finer than its pixels."""
PADDING = 3
"""Empty cells around the foliage, so that points outside read as outside."""
AROUND = 4.0
"""Side of the window that shows the colour around a spray, over `SPRAY`."""
AROUND_WEIGHT = 1e-3
"""Weight of what is around: it counts where a spray shows next to no leaf's colour."""


@dataclass(frozen=True, eq=False)
class FoliageGrid:
    """Square cells over the foliage's box in a picture.

    Attributes
    ----------
    camera
        The picture's camera.
    step_px
        Side of a cell, px.
    corner_px
        (x, y) of the grid's top-left corner, px.
    cell_m
        Side of a cell at the crown's middle, metres.
    inside
        (rows, columns) whether foliage covers most of the cell.
    leaves_from
        (rows, columns) depth, metres, from which on leaves may lie: minus infinity in the foliage, that of the wood
        where wood is seen, infinity elsewhere.
    labs
        (rows * columns, 3) mean of the leaves' colour over a spray, CIE Lab, unshaded as the atlas's; outside the
        foliage the colour of the nearest part of it.
    """

    camera: Camera
    step_px: float
    corner_px: tuple[float, float]
    cell_m: float
    inside: Mask
    leaves_from: NDArray[np.float32]
    labs: Floats

    @property
    def breadth_m(self) -> float:
        """Breadth of the foliage, metres."""
        return self.cell_m * breadth(self.inside)

    def cells_of(self, points_world: Floats) -> Indices:
        """Index (n,) into the flattened grid of the cells onto which world points (n, 3), metres, project.

        Points that project beside the grid get the nearest cell of its border.
        """
        rows, columns = self.inside.shape
        x, y = self.positions_of(points_world).T
        column = np.clip(x, 0, columns - 1).astype(np.int64)
        return np.asarray(np.clip(y, 0, rows - 1).astype(np.int64) * columns + column)

    def positions_of(self, points_world: Floats) -> Floats:
        """Project world points (n, 3), metres, to positions (n, 2) in the grid: x right and y down, in cells."""
        return self._cropped.pixels_from_world(points_world) / self.step_px

    @cached_property
    def _cropped(self) -> Camera:
        """The camera of the grid's part of the picture."""
        rows, columns = self.inside.shape
        return self.camera.cropped(self.corner_px, (columns, rows))

    def pixels_of(self, cells: Indices, within: Floats) -> Floats:
        """Return picture points (n, 2), px, in cells of flat index (n,), at positions (n, 2), shares of a cell."""
        row, column = np.divmod(cells, self.inside.shape[1])
        return np.array(self.corner_px) + (np.stack([column, row], axis=1) + within) * self.step_px

    def deeper(self, cells: Indices, depth_m: Floats) -> Mask:
        """Tell whether leaves may lie at depths (n, p), metres, in cells of flat index (n, p): flags (n, p)."""
        return np.asarray(self.leaves_from.take(cells) < depth_m)


def breadth(foliage: Mask) -> float:
    """Breadth, px, of a foliage (h, w): its width, or that of a square as large where it is a narrow column."""
    columns = np.flatnonzero(foliage.any(axis=0))
    return max(float(columns[-1] - columns[0] + 1), float(np.sqrt(np.count_nonzero(foliage))))


def foliage_grid(view: View, crown_middle: Floats, cells_across: int = CELLS_ACROSS) -> FoliageGrid:
    """Lay a grid over a view's foliage and average the picture's colours in its cells.

    ``crown_middle`` (3,), world, metres, is where the side of a cell is measured; ``cells_across`` are as many as lie
    side by side over the foliage's breadth.

    Raises
    ------
    ValueError
        The view shows no foliage.
    """
    mask = view.foliage
    if not mask.any():
        raise ValueError("a foliage grid needs a view that shows foliage")
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    top, bottom, left, right = int(rows[0]), int(rows[-1]) + 1, int(columns[0]), int(columns[-1]) + 1
    step = max(
        MIN_STEP_PX if cells_across == CELLS_ACROSS else 1.0,
        max(right - left, float(np.sqrt(mask.sum()))) / cells_across,
    )
    step = step if step >= 1 else 1 / round(1 / step)  # finer cells than pixels share the pixels' borders
    shrink = cv2.INTER_AREA if step >= 1 else cv2.INTER_NEAREST
    size = (max(1, round((right - left) / step)), max(1, round((bottom - top) / step)))
    box = (slice(top, bottom), slice(left, right))
    part = mask[box].astype(np.uint8)
    share = _padded(cv2.resize(part * view.opacity[box], size, interpolation=shrink))
    inside = np.asarray(share > 0.5) if (share > 0.5).any() else np.asarray(share > 0)
    weight = view.own_colour[box]
    weighted = cv2.multiply(view.picture[box].astype(np.float32), cv2.merge([weight] * 3))
    colour = cv2.resize(cv2.merge([weighted, weight]), size, interpolation=shrink)
    return FoliageGrid(
        camera=view.camera,
        step_px=step,
        corner_px=(left - PADDING * step, top - PADDING * step),
        cell_m=step * float(view.camera.pixel_size(crown_middle[None])[0]),
        inside=inside,
        leaves_from=_depths(view.leaves_from[box], inside, size),
        labs=_spray_labs(_padded(colour), inside, cells_across).take(_nearest_inside(inside), axis=0),
    )


def side_grid(side: Silhouette[Camera], front: FoliageGrid) -> FoliageGrid:
    """Lay a grid over the foliage as it is imagined from a side, with cells as large as the front's; without colours.

    Raises
    ------
    ValueError
        The silhouette is empty.
    """
    rows, columns = np.flatnonzero(side.mask.any(axis=1)), np.flatnonzero(side.mask.any(axis=0))
    if len(rows) == 0:
        raise ValueError("a foliage grid needs a silhouette that shows foliage")
    part = side.mask[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1].astype(np.float32)
    size = [max(1, round(length / front.step_px)) for length in part.shape[::-1]]
    shrink = cv2.INTER_AREA if front.step_px >= 1 else cv2.INTER_NEAREST
    inside = np.asarray(_padded(cv2.resize(part, size, interpolation=shrink)) > 0.5)
    corner = float(columns[0]) - PADDING * front.step_px, float(rows[0]) - PADDING * front.step_px
    leaves_from = np.where(inside, -np.inf, np.inf).astype(np.float32)
    return FoliageGrid(side.camera, front.step_px, corner, front.cell_m, inside, leaves_from, np.zeros((0, 3)))


def _depths(leaves_from: NDArray[np.float32], inside: Mask, size: tuple[int, int]) -> NDArray[np.float32]:
    """Depth (rows, columns), metres, from which on leaves may lie; ``size`` is the grid's without its border."""
    near = cv2.resize(leaves_from, size, interpolation=cv2.INTER_NEAREST)
    near = np.pad(near, PADDING, constant_values=np.inf)
    return np.where(inside, -np.inf, np.where(np.isfinite(near), near, np.inf)).astype(np.float32)


def _padded(image: NDArray[Any]) -> NDArray[np.float32]:
    """Add the empty border, and compute in float32 from here on."""
    border = [(PADDING, PADDING), (PADDING, PADDING), (0, 0)][: image.ndim]
    return np.pad(image.astype(np.float32), border)


def _spray_labs(colour: NDArray[np.float32], inside: Mask, across: int) -> Floats:
    """Colour of the sprays at the cells inside (n, 3), CIE Lab, by each cell's colour times weight, and weight (4)."""
    sides = (round(SPRAY * across), round(AROUND * SPRAY * across))
    near, around = (cv2.blur(colour, (side, side)) for side in sides)
    cells = np.flatnonzero(inside)
    near, around = (np.asarray(part).reshape(-1, 4).take(cells, axis=0) for part in (near, around))
    total = near + np.float32(AROUND_WEIGHT) * around + np.float32(1e-9) * colour.mean(axis=(0, 1))
    mean = total[:, :3] / np.maximum(total[:, 3:], np.float32(1e-20))
    return unshaded(lab_from_rgb(np.clip(np.rint(mean), 0, 255).astype(np.uint8)))


def _nearest_inside(inside: Mask) -> Indices:
    """For each cell of the grid, flat, the nearest cell inside, as a rank among those."""
    _, labels = cv2.distanceTransformWithLabels(
        (~inside).astype(np.uint8), cv2.DIST_L2, 3, labelType=cv2.DIST_LABEL_PIXEL
    )
    rank = np.zeros(int(labels.max()) + 1, dtype=np.int64)
    rank[labels[inside]] = np.arange(np.count_nonzero(inside))
    return np.asarray(rank[labels].ravel())
