"""What the mattes of a capture leave of space: the hull, and how densely it is filled."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from treestroke.core.capture import Shot, TreeMatte
from treestroke.core.carve.tomography import DensityField, Filling, HullGrid, filling, grid_of
from treestroke.core.carve.visual_hull import VisualHull, visual_hull
from treestroke.core.progress import Report

JOINED = 2
"""Sides of the hull's cells that make one of the cells whose density is measured."""


@dataclass(frozen=True, eq=False)
class Carving:
    """A tree's hull and what fills it.

    Attributes
    ----------
    hull
        The hull.
    grid
        Its cells, `JOINED` to larger ones.
    filling
        What fills these.
    """

    hull: VisualHull
    grid: HullGrid
    filling: Filling

    @property
    def field(self) -> DensityField:
        """Densities of leaves and wood, to be asked for along lines of sight."""
        padded = np.full(self.grid.share.shape, -1.0, dtype=np.float32)
        padded[tuple(self.grid.places.T)] = self.filling.density
        return DensityField(np.pad(padded, 1, constant_values=-1.0), self.grid.corner, self.grid.side)


def carved(shots: Sequence[Shot], mattes: Sequence[TreeMatte], report: Report) -> Carving:
    """Carve the hull of a tree's mattes, and measure how densely its cells are filled.

    Raises
    ------
    ValueError
        Fewer than three shots, not one matte for each, or no space is left.
    """
    report("hull", 0.0)
    hull = visual_hull(shots, mattes)
    report("hull", 1.0)
    report("density", 0.0)
    grid = grid_of(hull.cells, JOINED)
    good = np.flatnonzero(hull.good).tolist()
    filled = filling(grid, [(shots[index].camera, mattes[index]) for index in good])
    report("density", 1.0)
    return Carving(hull, grid, filled)
