"""The crown from the front and from the left."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.camera import Camera
from treestroke.core.types import Floats, Mask


def from_left(points_world: Floats) -> Floats:
    """Turn the world (n, 3) so that its left side faces the viewer: +X comes to point at +Z of old, +Z at -X."""
    return np.asarray(points_world[:, [2, 1, 0]] * np.array([1.0, 1.0, -1.0]))


@dataclass(frozen=True, eq=False)
class View:
    """A mask (h, w) of the crown in the picture of a camera."""

    mask: Mask
    camera: Camera

    def shows(self, points: Floats) -> Mask:
        """Tell which points (n, 3), metres, seen along -Z, fall on the mask; none does outside the picture."""
        column, row = np.floor(self.camera.pixels_from_world(points)).astype(np.int64).T
        height, width = self.mask.shape
        seen = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        return np.asarray(seen & self.mask[np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)])


@dataclass(frozen=True, eq=False)
class CrownViews:
    """The crown from the front, and from the left where that is known."""

    front: View
    side: View | None = None

    def inside(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie in the crown as both views show it."""
        inside = self.front.shows(points_world)
        return inside if self.side is None else inside & self.side.shows(from_left(points_world))
