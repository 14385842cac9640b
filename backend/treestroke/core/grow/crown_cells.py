"""The crown in cells that know how much wood is in them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.envelope import Envelope
from treestroke.core.geometry.views import CrownViews
from treestroke.core.types import Floats, Indices

CELLS = 1500
"""About so many cells lie in the crown: each is as wide as a small branch is long."""
_COARSE = 24
"""Cells along the longest side of the crown's box, to take its volume by."""


@dataclass(frozen=True, eq=False)
class CrownCells:
    """A box of cubes around the crown.

    Attributes
    ----------
    views, envelope
        What bounds the crown: a place is inside where both views show it and the solid holds it.
    corner
        (3,) the box's least X, Y and Z, metres.
    side
        Of a cell, metres.
    shape
        Cells along X, Y and Z.
    count
        Cells whose middle is inside.
    wood
        Metres of branches in each cell, flat; changed by `lay`.
    """

    views: CrownViews
    envelope: Envelope
    corner: Floats
    side: float
    shape: tuple[int, int, int]
    count: int
    wood: Floats

    @property
    def volume(self) -> float:
        """The crown's, cubic metres."""
        return self.count * self.side**3

    @property
    def size(self) -> float:
        """Side, metres, of a cube as large as the crown."""
        return float(self.volume ** (1 / 3))

    def inside(self, points: Floats, reach: Floats | float = 1.0) -> NDArray[np.bool_]:
        """Tell which points (n, 3) lie in both views, and in the solid or no further out than ``reach`` (n,)."""
        return np.asarray(self.views.inside(points) & (self.envelope.reach(points) <= np.maximum(reach, 1.0)))

    def lay(self, points: Floats, lengths: Floats) -> None:
        """Add branches: pieces of so many metres (n,) about points (n, 3)."""
        self.wood[:] += np.bincount(self._cells(points), lengths, minlength=len(self.wood))

    def around(self) -> Floats:
        """Mean wood of each cell and its 26 neighbours, flat, metres."""
        return _blurred(self.wood.reshape(self.shape)).ravel()

    def at(self, points: Floats, values: Floats) -> Floats:
        """Look up flat values in the cells of points (n, 3); points outside the box take its border's."""
        return np.asarray(values[self._cells(points)])

    def _cells(self, points: Floats) -> Indices:
        place = np.clip(((points - self.corner) / self.side).astype(np.int64), 0, np.array(self.shape) - 1)
        return np.asarray((place[:, 0] * self.shape[1] + place[:, 1]) * self.shape[2] + place[:, 2])


def crown_cells(views: CrownViews, envelope: Envelope) -> CrownCells:
    """Lay cells over the part of the solid that both views show; none of them is inside where there is no such part."""
    low, high = _box(envelope)
    coarse = _laid(views, envelope, low, high, max(float((high - low).max()) / _COARSE, 1e-6))
    if coarse.count == 0:
        return coarse
    return _laid(views, envelope, low, high, (coarse.volume / CELLS) ** (1 / 3))


def _box(envelope: Envelope) -> tuple[Floats, Floats]:
    """Find the least and greatest corner of the solid."""
    rows, scale = np.flatnonzero(envelope.radius_px > 0), envelope.camera.metres_per_pixel
    if len(rows) == 0:
        return np.zeros(3), np.zeros(3)
    middle = (envelope.middle_px[rows] - envelope.camera.root_px[0]) * scale
    radius, deep, away = envelope.radius_px[rows] * scale, envelope.radius_px[rows] * scale, np.zeros(len(rows))
    if envelope.depth is not None:
        deep, away = envelope.depth.radius_px[rows] * scale, envelope.depth.middle_px[rows] * scale
    top, bottom = (envelope.camera.root_px[1] - np.array([rows[0], rows[-1] + 1])) * scale
    low = np.array([(middle - radius).min(), bottom, (away - deep).min()])
    return low, np.array([(middle + radius).max(), top, (away + deep).max()])


def _laid(views: CrownViews, envelope: Envelope, low: Floats, high: Floats, side: float) -> CrownCells:
    across, up, deep = (np.maximum(np.ceil((high - low) / side), 1)).astype(int).tolist()
    corner = (low + high - side * np.array([across, up, deep])) / 2
    middles = corner + side * (np.indices((across, up, deep)).reshape(3, -1).T + 0.5)
    count = int((views.inside(middles) & (envelope.reach(middles) <= 1)).sum())
    return CrownCells(views, envelope, corner, side, (across, up, deep), count, np.zeros(len(middles)))


def _blurred(values: Floats) -> Floats:
    """Average cubes of 3 x 3 x 3 cells; outside the box nothing is."""
    for axis in range(3):
        wide = np.moveaxis(np.pad(values, [(int(axis == one),) * 2 for one in range(3)]), axis, 0)
        values = np.moveaxis(wide[:-2] + wide[1:-1] + wide[2:], 0, axis)
    return np.asarray(values / 27)
