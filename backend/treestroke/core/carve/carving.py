"""What the mattes of a capture leave of space: the hull, and how densely it is filled."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from treestroke.core.capture import PointCloud, Shot, TreeMatte, evenly
from treestroke.core.carve.tomography import (
    DensityField,
    HullGrid,
    SightLines,
    Singles,
    densities,
    grid_of,
    leafiness,
    lines_of,
    lines_to,
    together,
)
from treestroke.core.carve.visual_hull import VisualHull, visual_hull
from treestroke.core.progress import Report
from treestroke.core.side_by_side import side_by_side

JOINED = 2
"""Sides of the hull's cells that make one of the cells whose density is measured."""
MOST_SHOTS = 24
"""Shots, evenly spread, that tell how densely cells are filled: their lines of sight take most of the memory."""
MOST_LINES = 6000
"""Points of each shot that tell of open lines of sight."""


@dataclass(frozen=True, eq=False)
class Carving:
    """A tree's hull and what fills it.

    Attributes
    ----------
    hull
        The hull.
    grid
        Its cells, `JOINED` to n larger ones.
    lines
        The mattes' lines of sight through these.
    density
        (n,) leaves and wood in them: how many a line of one metre meets in the mean.
    leafy
        (n,) share of the covered lines through each that end on leaves, not on wood.
    """

    hull: VisualHull
    grid: HullGrid
    lines: SightLines
    density: Singles
    leafy: Singles

    @property
    def field(self) -> DensityField:
        """Densities of leaves and wood, to be asked for along lines of sight."""
        padded = np.full(self.grid.share.shape, -1.0, dtype=np.float32)
        padded[tuple(self.grid.places.T)] = self.density
        return DensityField(np.pad(padded, 1, constant_values=-1.0), self.grid.corner, self.grid.side)


def carved(shots: Sequence[Shot], mattes: Sequence[TreeMatte], report: Report) -> Carving:
    """Carve the hull of a tree's mattes, and measure how densely its cells are filled.

    Raises
    ------
    StrokesError
        The mattes leave no space to the tree.
    ValueError
        Fewer than three shots, or not one matte for each.
    """
    report("hull", 0.0)
    hull = visual_hull(shots, mattes)
    report("hull", 1.0)
    report("density", 0.0)
    grid = grid_of(hull.cells, JOINED)
    good = np.flatnonzero(hull.good).tolist()
    good = [good[place] for place in evenly(len(good), MOST_SHOTS)]
    lines = together(side_by_side(lambda index: lines_of(grid, shots[index].camera, mattes[index]), good))
    carving = Carving(hull, grid, lines, densities(grid, lines), leafiness(lines))
    report("density", 1.0)
    return carving


def with_points(carving: Carving, shots: Sequence[Shot], cloud: PointCloud) -> Carving:
    """Measure the densities again, now that points are known: lines of sight are open up to the points that shots see.

    Source: Kutulakos and Seitz 2000, section 3 (what is seen carves what is before it); here one wrong point does not.
    """
    parts = [carving.lines]
    for index, shot in enumerate(shots):
        seen = np.flatnonzero(cloud.seen[:, index])
        seen = seen[:: max(-(-len(seen) // MOST_LINES), 1)]
        if len(seen):
            parts.append(lines_to(carving.grid, shot.camera, cloud.points[seen]))
    return replace(carving, density=densities(carving.grid, together(parts)))
