"""Weighs branches by the leaves they bear, so that foliage is dense where the views show it dense."""

from collections.abc import Sequence

import cv2
import numpy as np

from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.geometry.outline_volume import half_widths_px
from treestroke.core.imaging.blur import broadly_blurred
from treestroke.core.leaf.arrangement import thin_edges
from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats

BREADTH = 0.02
"""Standard deviation, as a share of the tree's height, over which foliage and branches are averaged."""
OPAQUE = 0.97
"""Share of the light that the densest foliage stops; a picture cannot tell more behind a closed crown."""
MOST = 4.0
"""Greatest weight over the mean; more would crowd clumps on lonely twigs."""
SHELL = 0.45
"""Share of its leaves that a branch at the volume's surface loses: growth crowds twigs there, while leaves do not crowd
there (4 trees with known leaves)."""


def leaf_weights(
    skeleton: Skeleton, grids: Sequence[FoliageGrid], volume: CrownVolume, height: float, even: bool
) -> Floats:
    """Weigh each joint's edge (n,) by the leaves that it bears for its length; 0 on thick wood, if any is thin.

    Leaves follow the layers of foliage that the views show, shared out among the branches seen in the same place; where
    ``even`` (a conifer), each height bears as much as another. ``height`` is the tree's, metres.

    Source: Beer and Lambert's law, by which gaps in a canopy tell its leaf area (Monsi and Saeki 1953).
    """
    middles = (skeleton.points + skeleton.points[skeleton.parents]) / 2
    leafy = thin_edges(skeleton) & volume.admits(middles)
    weight = leafy * (1 - SHELL * np.minimum(volume.reach(middles), 1.0) ** 2)
    wood = weight * edge_lengths(skeleton)
    share = np.mean([_shares(middles, wood, grid, height, volume if even else None) for grid in grids], axis=0)
    mean = (share * wood).sum() / max(wood.sum(), 1e-12)
    return np.asarray(weight * np.minimum(share / max(mean, 1e-12), MOST))


def _shares(middles: Floats, wood: Floats, grid: FoliageGrid, height: float, even: CrownVolume | None) -> Floats:
    """Layers of leaves over the wood (n,), metres, that is seen about edges' middles (n, 3) in one view: (n,)."""
    cells, sigma = grid.cells_of(middles), BREADTH * height / grid.cell_m
    density = np.bincount(cells, wood, grid.inside.size).astype(np.float64).reshape(grid.inside.shape)
    wanted = _layers(grid, sigma)
    wanted = wanted if even is None else wanted / _half_widths(grid, even)[:, None]
    return np.asarray(
        _blurred(wanted, sigma).ravel()[cells] / np.maximum(_blurred(density, sigma).ravel()[cells], 1e-12)
    )


def _layers(grid: FoliageGrid, sigma: float) -> Floats:
    """Layers of leaves over each cell (rows, columns), from the share of gaps around it; wood fills gaps, too."""
    inside = (grid.leaves_from < np.inf).astype(np.float64)
    return np.asarray(-np.log(1 - OPAQUE * np.clip(_blurred(inside, sigma), 0, 1)) * inside)


def _half_widths(grid: FoliageGrid, volume: CrownVolume) -> Floats:
    """Half the crown's width at each row of the grid (rows,), px, a tenth of the widest at least."""
    rows, columns = grid.inside.shape
    middles_px = grid.pixels_of(np.arange(rows) * columns, np.full((rows, 2), 0.5))
    radius = half_widths_px(volume, grid.camera)
    row = np.clip(np.floor(middles_px[:, 1]).astype(np.int64), 0, len(radius) - 1)
    return np.asarray(np.maximum(radius[row], 0.1 * radius.max()))


def _blurred(image: Floats, sigma: float) -> Floats:
    """Average over a Gaussian; cells beyond the border count as empty."""
    return broadly_blurred(image, sigma, cv2.BORDER_CONSTANT)
