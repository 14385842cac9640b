"""A crown volume that was measured from all sides: cells with the density of what fills them."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from treestroke.core.geometry.clumped_crown import Cells
from treestroke.core.geometry.polyline import smoothed
from treestroke.core.types import Floats, Indices, Mask

AZIMUTHS = 32
"""Directions about the axis, evenly around, in which the surface's distance is held."""
SMOOTHED_SHARE = 0.02
"""Standard deviation, as a share of the crown's height, over which its axis and surface are smoothed."""
SMOOTHED_AZIMUTHS = 1.0
"""Standard deviation, in directions, over which its surface is smoothed."""
FAR_OUT = 1e9
"""Reach of points above and below the crown."""


@dataclass(frozen=True, eq=False)
class MeasuredCrown:
    """A crown as cells that several photos leave filled.

    All grids are of the same cells.

    Attributes
    ----------
    cells
        Where leaves stand, or twigs of a bare tree, metres.
    density
        (x, y, z) leaves in each cell: the mean number of them that a line of one metre meets; 0 where it is not filled.
    around
        (x, y, z) cells in which leaves may stand: filled ones and those near them that no photo excludes.
    hull
        (x, y, z) cells that no photo excludes from the tree.
    guessed
        (x, y, z) cells on sides that no photo was taken from.
    """

    cells: Cells
    density: NDArray[np.float32]
    around: Mask
    hull: Mask
    guessed: Mask

    def __post_init__(self) -> None:
        if any(grid.shape != self.cells.filled.shape for grid in (self.density, self.around, self.hull, self.guessed)):
            raise ValueError("the grids of a measured crown need the shape of its cells")
        if not self.cells.filled.any():
            raise ValueError("an empty crown has no volume")

    @cached_property
    def bounds(self) -> Floats:
        """(2, 3) least and greatest corner of the box around the filled cells, metres."""
        low, high = self._places.min(axis=0), self._places.max(axis=0) + 1
        return np.asarray(self.cells.corner + self.cells.side * np.stack([low, high]))

    def scaled(self, factor: float) -> "MeasuredCrown":
        """Return the same crown at another scale: all lengths, from the origin, times ``factor``."""
        cells = Cells(self.cells.filled, factor * self.cells.corner, factor * self.cells.side)
        return replace(self, cells=cells, density=(self.density / factor).astype(np.float32))

    @property
    def widest(self) -> float:
        """Half the width of the widest section, metres."""
        return float(self._half_widths.max())

    @property
    def front_area(self) -> float:
        """Area of the filled cells from the front, square metres."""
        return float(np.count_nonzero(self.cells.filled.any(axis=2)) * self.cells.side**2)

    @property
    def cubic_metres(self) -> float:
        """Volume of the filled cells."""
        return float(np.count_nonzero(self.cells.filled) * self.cells.side**3)

    @property
    def depth_seen(self) -> bool:
        """Whether a picture shows how deep the crown is: here they do."""
        return True

    @property
    def shape(self) -> str:
        """What the volume is, in words that follow "the solid"."""
        return f"of the cells, {100 * self.cells.side:.0f} cm wide, that the photos leave to leaves and twigs"

    @property
    def middles(self) -> Floats:
        """(n, 3) middles of the filled cells, metres."""
        return np.asarray(self.cells.corner + self.cells.side * (self._places + 0.5))

    @property
    def densities(self) -> Floats:
        """(n,) densities of the filled cells, in the order of `middles`."""
        return np.asarray(self.density[self.cells.filled], dtype=np.float64)

    def inside(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie in filled cells: flags (n,)."""
        return self.cells.hold(points_world)

    def shown(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie in the hull of all photos' mattes: flags (n,)."""
        return self._hold(self.hull, points_world)

    def admits(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie in filled cells or near them in the hull: flags (n,)."""
        return self._hold(self.around, points_world)

    def density_at(self, points_world: Floats) -> Floats:
        """Look up the density (n,), leaves met per metre, at points (n, 3), metres; 0 outside."""
        place = np.floor((points_world - self.cells.corner) / self.cells.side).astype(np.int64)
        size = np.array(self.cells.filled.shape)
        within = ((place >= 0) & (place < size)).all(axis=1)
        x, y, z = np.clip(place, 0, size - 1).T
        return np.asarray(np.where(within, self.density[x, y, z], 0.0), dtype=np.float64)

    def guessed_at(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie on a side that no photo was taken from: flags (n,)."""
        return self._hold(self.guessed, points_world)

    def reach(self, points_world: Floats) -> Floats:
        """Measure how far out points (n, 3), metres, lie: (n,), 0 on the axis, 1 on the surface; large above and below.

        The surface is the outermost filled cells about the axis, smoothed.
        """
        outward = points_world - self.axis(points_world[:, 1])
        turn = np.arctan2(outward[:, 0], outward[:, 2]) * AZIMUTHS / (2 * np.pi) % AZIMUTHS
        level = np.clip(self._levels(points_world[:, 1]), 0, len(self._surface) - 1)
        # One more direction on each side, so that the table goes round.
        table = np.pad(self._surface, ((0, 0), (1, 1)), mode="wrap")
        distance = ndimage.map_coordinates(table, np.stack([level, turn + 0.5]), order=1, mode="nearest")
        reach = np.hypot(outward[:, 0], outward[:, 2]) / np.maximum(distance, 1e-9)
        low, high = self.bounds[:, 1]
        return np.where((points_world[:, 1] >= low) & (points_world[:, 1] <= high), reach, FAR_OUT)

    def axis(self, heights_m: Floats) -> Floats:
        """Return the centres (n, 3), metres, of the sections at heights (n,), metres: the means of their density."""
        levels = np.arange(len(self._centres))
        x, z = (np.interp(self._levels(heights_m), levels, column) for column in self._centres.T)
        return np.stack([x, heights_m, z], axis=1)

    def half_width(self, heights_m: Floats) -> Floats:
        """Measure half the sections' width (n,), metres, at heights (n,), metres; 0 above and below the crown."""
        levels = np.arange(len(self._half_widths))
        low, high = self.bounds[:, 1]
        width = np.interp(self._levels(heights_m), levels, self._half_widths)
        return np.where((heights_m >= low) & (heights_m <= high), width, 0.0)

    def half_depth(self, points_world: Floats) -> Floats:
        """Measure half the depth (n,), metres, of the filled cells at the X and Y of points (n, 3), metres."""
        place = np.floor((points_world[:, :2] - self.cells.corner[:2]) / self.cells.side).astype(np.int64)
        size = np.array(self._depths.shape)
        within = ((place >= 0) & (place < size)).all(axis=1)
        x, y = np.clip(place, 0, size - 1).T
        return np.asarray(np.where(within, self._depths[x, y], 0.0))

    def _hold(self, grid: Mask, points_world: Floats) -> Mask:
        return Cells(grid, self.cells.corner, self.cells.side).hold(points_world)

    def _levels(self, heights_m: Floats) -> Floats:
        """Level (n,) of heights (n,), metres, counted from the crown's lowest: whole in the middles of cells."""
        return np.asarray((heights_m - self.bounds[0, 1]) / self.cells.side - 0.5)

    @cached_property
    def _places(self) -> Indices:
        """(n, 3) places of the filled cells in the grid."""
        return np.argwhere(self.cells.filled)

    @cached_property
    def _level_of(self) -> Indices:
        """(n,) level of each filled cell, 0 the lowest."""
        return np.asarray(self._places[:, 1] - self._places[:, 1].min())

    @property
    def _sigma(self) -> float:
        return SMOOTHED_SHARE * (int(self._level_of.max()) + 1)

    @cached_property
    def _centres(self) -> Floats:
        """(levels, 2) X and Z of the sections' centres, metres."""
        middles, weight = self.middles, self.densities + 1e-6
        count = int(self._level_of.max()) + 1
        mass = np.bincount(self._level_of, weight, count)
        held = np.flatnonzero(mass > 0)
        centres = [
            np.interp(np.arange(count), held, np.bincount(self._level_of, weight * at, count)[held] / mass[held])
            for at in middles[:, ::2].T
        ]
        return smoothed(np.stack(centres, axis=1), self._sigma)

    @cached_property
    def _half_widths(self) -> Floats:
        """(levels,) half the sections' width, metres."""
        count = int(self._level_of.max()) + 1
        low, high = np.full(count, np.inf), np.full(count, -np.inf)
        np.minimum.at(low, self._level_of, self.middles[:, 0])
        np.maximum.at(high, self._level_of, self.middles[:, 0])
        held = np.flatnonzero(high >= low)
        widths = np.interp(np.arange(count), held, (high - low)[held] + self.cells.side)
        return smoothed(widths, self._sigma) / 2

    @cached_property
    def _surface(self) -> Floats:
        """(levels, azimuths) distance of the outermost filled cells from the axis, metres; never less than a cell."""
        middles = self.middles
        outward = middles - self.axis(middles[:, 1])
        turn = np.floor(np.arctan2(outward[:, 0], outward[:, 2]) * AZIMUTHS / (2 * np.pi)).astype(np.int64) % AZIMUTHS
        surface = np.zeros((int(self._level_of.max()) + 1, AZIMUTHS))
        np.maximum.at(surface, (self._level_of, turn), np.hypot(outward[:, 0], outward[:, 2]) + self.cells.side / 2)
        smooth = ndimage.gaussian_filter(surface, (self._sigma, SMOOTHED_AZIMUTHS), mode=("nearest", "wrap"))
        return np.asarray(np.maximum(smooth, self.cells.side))

    @cached_property
    def _depths(self) -> Floats:
        """(x, y) half the distance from the front of the nearest to the back of the furthest filled cell, metres."""
        filled = self.cells.filled
        first, last = filled.argmax(axis=2), filled.shape[2] - filled[:, :, ::-1].argmax(axis=2)
        return np.where(filled.any(axis=2), (last - first) * self.cells.side / 2, 0.0)
