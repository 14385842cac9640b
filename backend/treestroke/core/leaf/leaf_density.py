"""How many leaves each branch bears, so that foliage is dense where the photo shows it dense."""

import cv2
import numpy as np

from treestroke.core.geometry.envelope import Envelope
from treestroke.core.leaf.arrangement import thin_edges
from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats

BREADTH = 0.02
"""Standard deviation, as a share of the tree's height, over which foliage and branches are averaged."""
OPAQUE = 0.97
"""Share of the light that the densest foliage stops; what is behind a closed crown no photo tells."""
MOST = 4.0
"""Most leaves a branch bears for its length, against the mean; more would be clumps on lonely twigs."""
SHELL = 0.45
"""Share of its leaves that a branch at the solid's surface gives up: growth's twigs crowd there, a crown's leaves do
not (4 trees with known leaves)."""


def bearing(skeleton: Skeleton, grid: FoliageGrid, envelope: Envelope, height: float, even: bool) -> Floats:
    """Weigh each joint's edge (n,) by the leaves it bears for its length; 0 on thick wood, if any is thin.

    Leaves follow the layers of foliage that the photo shows, shared out among the branches before that place; where
    ``even`` (a conifer), each height bears as much as another. ``height`` is the tree's, metres.

    Source: Beer and Lambert's law, by which gaps in a canopy tell its leaf area (Monsi and Saeki 1953).
    """
    middles = (skeleton.points + skeleton.points[skeleton.parents]) / 2
    weight = thin_edges(skeleton) * (1 - SHELL * np.minimum(envelope.reach(middles), 1.0) ** 2)
    wood = weight * edge_lengths(skeleton)
    cells, sigma = grid.flat_cells(middles[:, 0], middles[:, 1]), BREADTH * height / grid.cell_m
    density = np.bincount(cells, wood, grid.inside.size).astype(np.float64).reshape(grid.inside.shape)
    wanted = _layers(grid, sigma)
    wanted = wanted / _radii(grid, envelope)[:, None] if even else wanted
    share = _blurred(wanted, sigma).ravel()[cells] / np.maximum(_blurred(density, sigma).ravel()[cells], 1e-12)
    mean = (share * wood).sum() / max(wood.sum(), 1e-12)
    return np.asarray(weight * np.minimum(share / max(mean, 1e-12), MOST))


def _layers(grid: FoliageGrid, sigma: float) -> Floats:
    """Layers of leaves over each cell (rows, columns), from the share of gaps around it; wood is no gap."""
    inside = (grid.front > -np.inf).astype(np.float64)
    return np.asarray(-np.log(1 - OPAQUE * np.clip(_blurred(inside, sigma), 0, 1)) * inside)


def _radii(grid: FoliageGrid, envelope: Envelope) -> Floats:
    """Radius of the crown at each row of the grid (rows,), px."""
    rows = np.floor(grid.corner_px[1] + (np.arange(grid.inside.shape[0]) + 0.5) * grid.step_px).astype(np.int64)
    radius = envelope.radius_px[np.clip(rows, 0, len(envelope.radius_px) - 1)]
    return np.asarray(np.maximum(radius, 0.1 * envelope.radius_px.max()))


def _blurred(image: Floats, sigma: float) -> Floats:
    """Average over a Gaussian, reckoned on fewer cells; what is beyond the border counts as empty."""
    rows, columns = image.shape
    step = max(1.0, sigma / 3)
    size = (max(1, round(columns / step)), max(1, round(rows / step)))
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    soft = cv2.GaussianBlur(small, (0, 0), sigma / step, borderType=cv2.BORDER_CONSTANT)
    return np.asarray(cv2.resize(soft, (columns, rows), interpolation=cv2.INTER_LINEAR))
