"""How much of the sky's light reaches the places of a crown through its foliage."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.types import Floats, Mask

CELLS_ALONG = 40
"""Cells along the longest side of a crown's box."""
PENETRATION = 0.2
"""Way through foliage on which light falls to 1/e, over the crown's mean depth: ten layers of leaves lie behind each
other in it, turned in all directions (Beer and Lambert's law with half of their area in the way)."""
SLANT = 1
"""Cells aside for each cell upward, of the slanting ways to the sky: 45 degrees."""


@dataclass(frozen=True, eq=False)
class Daylight:
    """The light in the cells of a grid about a crown.

    Attributes
    ----------
    light
        (x, y, z) share of the sky's light that reaches it, 0 to 1.
    corner, side
        (3,) least corner of the grid and the side of a cell, metres.
    """

    light: Floats
    corner: Floats
    side: float

    def at(self, points: Floats) -> Floats:
        """Share (n,) of the sky's light that reaches places (n, 3), metres."""
        place = np.floor((points - self.corner) / self.side).astype(np.int64)
        x, y, z = np.clip(place, 0, np.array(self.light.shape) - 1).T
        return np.asarray(self.light[x, y, z])


def daylight(volume: CrownVolume) -> Daylight:
    """Let the light of an even sky fall through a crown, from above and slanting from four sides.

    Source: Beer and Lambert's law in canopies (Monsi and Saeki 1953).
    """
    low, high = volume.bounds
    side = max(float((high - low).max()) / CELLS_ALONG, 1e-6)
    shape = np.maximum(np.ceil((high - low) / side).astype(np.int64), 1)
    middles = low + (np.indices(shape).reshape(3, -1).T + 0.5) * side
    filled = volume.inside(middles).reshape(shape)
    reach = max(PENETRATION * volume.cubic_metres / max(volume.front_area, 1e-12), 1e-9)
    ways = list(_ways_to_sky(filled, float(np.exp(-side / reach))))
    return Daylight(np.mean(ways, axis=0), low, side)


def _ways_to_sky(filled: Mask, passing: float) -> Iterator[Floats]:
    """Yield the share (x, y, z) of light that comes to each cell along each way; one cell lets ``passing`` through."""
    for right, front in ((0, 0), (SLANT, 0), (-SLANT, 0), (0, SLANT), (0, -SLANT)):
        through = np.where(filled, passing ** np.sqrt(1.0 + right**2 + front**2), 1.0)
        light = np.empty(filled.shape)
        above = np.ones((filled.shape[0] + 2 * SLANT, filled.shape[2] + 2 * SLANT))
        inner = above[SLANT:-SLANT, SLANT:-SLANT]
        for level in range(filled.shape[1])[::-1]:
            came = above[
                SLANT + right : SLANT + right + filled.shape[0], SLANT + front : SLANT + front + filled.shape[2]
            ]
            light[:, level] = came * np.sqrt(through[:, level])  # half of the cell itself lies before its middle
            inner[:] = came * through[:, level]
        yield light
