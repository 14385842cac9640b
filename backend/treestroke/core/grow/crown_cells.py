"""The crown as a grid of cells, each with the length of wood in it."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.types import Floats, Indices, Mask

CELLS = 1500
"""Number of cells that lie in the crown, about: each is then as wide as a small branch is long."""
_COARSE = 24
"""Cells along the longest side of the crown's box, for a first estimate of its volume."""


@dataclass(frozen=True, eq=False)
class CrownCells:
    """A box of cubes around the crown.

    Attributes
    ----------
    volume
        The crown.
    corner
        (3,) the box's least X, Y and Z, metres.
    side
        Side of a cell, metres.
    shape
        Cells along X, Y and Z.
    count
        Cells whose middle is inside.
    wood
        (cells,) length of the branches in each cell, metres, flat; changed by `add_wood`.
    """

    volume: CrownVolume
    corner: Floats
    side: float
    shape: tuple[int, int, int]
    count: int
    wood: Floats

    @property
    def cubic_metres(self) -> float:
        """Volume of the cells inside."""
        return self.count * self.side**3

    @property
    def size(self) -> float:
        """Side, metres, of a cube of the crown's volume."""
        return float(self.cubic_metres ** (1 / 3))

    def inside(self, points: Floats, reach: Floats | float = 1.0) -> Mask:
        """Tell which points (n, 3), metres, are in the crown as the views show it, within a ``reach`` (n,) >= 1."""
        return np.asarray(self.volume.shown(points) & (self.volume.reach(points) <= np.maximum(reach, 1.0)))

    def add_wood(self, points: Floats, lengths: Floats) -> None:
        """Add pieces of branches: their lengths (n,), metres, at points (n, 3), metres."""
        self.wood[:] += np.bincount(self._cells(points), lengths, minlength=len(self.wood))

    def around(self) -> Floats:
        """Return the mean wood, metres, of each cell and its 26 neighbours: (cells,), flat."""
        return _blurred(self.wood.reshape(self.shape)).ravel()

    def at(self, points: Floats, values: Floats) -> Floats:
        """Look up values (cells,), flat, at points (n, 3), metres: (n,); beyond the box those of its border."""
        return np.asarray(values[self._cells(points)])

    def _cells(self, points: Floats) -> Indices:
        place = np.clip(((points - self.corner) / self.side).astype(np.int64), 0, np.array(self.shape) - 1)
        return np.asarray((place[:, 0] * self.shape[1] + place[:, 1]) * self.shape[2] + place[:, 2])


def crown_cells(volume: CrownVolume) -> CrownCells:
    """Lay about `CELLS` cells over a crown; none of them is inside where the crown is empty."""
    coarse = _cells_over(volume, max(float(np.ptp(volume.bounds, axis=0).max()) / _COARSE, 1e-6))
    if coarse.count == 0:
        return coarse
    return _cells_over(volume, (coarse.cubic_metres / CELLS) ** (1 / 3))


def _cells_over(volume: CrownVolume, side: float) -> CrownCells:
    """Lay cells of a side, metres, over the volume's box."""
    low, high = volume.bounds
    across, up, deep = (np.maximum(np.ceil((high - low) / side), 1)).astype(int).tolist()
    corner = (low + high - side * np.array([across, up, deep])) / 2
    middles = corner + side * (np.indices((across, up, deep)).reshape(3, -1).T + 0.5)
    count = int(volume.inside(middles).sum())
    return CrownCells(volume, corner, side, (across, up, deep), count, np.zeros(len(middles)))


def _blurred(values: Floats) -> Floats:
    """Average cubes of 3 x 3 x 3 cells; beyond the box values are 0."""
    for axis in range(3):
        wide = np.moveaxis(np.pad(values, [(int(axis == padded),) * 2 for padded in range(3)]), axis, 0)
        values = np.moveaxis(wide[:-2] + wide[1:-1] + wide[2:], 0, axis)
    return np.asarray(values / 27)
