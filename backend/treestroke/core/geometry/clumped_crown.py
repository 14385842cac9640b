"""A crown volume in which foliage stands in clumps, as its front shows it, with an assumed depth."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.outline_volume import TwoOutlines
from treestroke.core.types import Floats, Mask


@dataclass(frozen=True, eq=False)
class Cells:
    """A grid of cubes.

    Attributes
    ----------
    filled
        (x, y, z) whether a cell is filled.
    corner
        (3,) least x, y and z of the grid.
    side
        Side of a cell, in the unit of its corner.
    """

    filled: Mask
    corner: Floats
    side: float

    def hold(self, points: Floats) -> Mask:
        """Tell which points (n, 3) lie in filled cells: flags (n,)."""
        # Axis by axis: numpy is slow along short rows.
        place = np.floor((np.ascontiguousarray(points.T) - self.corner[:, None]) / self.side).astype(np.int64)
        size = np.array(self.filled.shape)[:, None]
        within = ((place >= 0) & (place < size)).all(axis=0)
        x, y, z = np.clip(place, 0, size - 1)
        return np.asarray(within & self.filled[x, y, z])


@dataclass(frozen=True, eq=False)
class ClumpedCrown(TwoOutlines):
    """A crown whose foliage stands in clumps; its depth, a second outline, is assumed.

    Attributes
    ----------
    clumps
        Where foliage stands, in the front camera's picture space, px.
    """

    clumps: Cells

    @property
    def depth_seen(self) -> bool:
        """Whether a picture shows how deep the crown is: here it is assumed."""
        return False

    @property
    def shape(self) -> str:
        """What the sections are, in words that follow "the solid"."""
        return "whose level sections are ellipses as wide as the crown's front and about as deep"

    def inside(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie in clumps and in all silhouettes: flags (n,)."""
        return np.asarray(self.shown(points_world) & self.admits(points_world))

    def admits(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie in clumps: flags (n,)."""
        return self.clumps.hold(self.camera.picture_space_from_world(points_world))
