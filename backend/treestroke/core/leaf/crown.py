"""The crown that cards are placed in."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.envelope import Envelope
from treestroke.core.leaf.arrangement import Poses, Seats
from treestroke.core.leaf.colouring import DARKEST, Colouring, colouring_of, shades
from treestroke.core.leaf.coverage import Outlines, cover, outlines_of, share_inside
from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.paint.atlas import Atlas, tile_alphas, tile_labs
from treestroke.core.paint.cut_outs import SOLID_ALPHA
from treestroke.core.types import Floats

SIDES = (0.015, 0.03)
"""Smallest and largest side of a card of size 1, as shares of the crown's width."""
FLICKER = 0.05
"""Standard deviation of a card's brightness, so that neighbours stand out from each other."""
FITTING = 0.92
"""Share of a card's opaque dots that must lie in the foliage. Higher loses more of the foliage at its outline than it
gains beside it (5 photos: 0.96 costs 1 to 3 % of silhouette IoU)."""
FLAT = 0.02
"""Depth, as a share of the tree's height, at which a card may lie outside the crown's solid, whose rows are
smoothed."""


@dataclass(frozen=True, eq=False)
class Crown:
    """The photo's foliage, its solid, its colours and the atlas's tiles, with sizes in metres.

    Attributes
    ----------
    grid, envelope, colouring, outlines
        Where foliage is, how deep it may reach, which tile goes where, and the tiles' opaque dots.
    middle
        (3,) the point that cards face away from, world.
    height
        The tree's height above its root.
    side
        The crown's width times the size factor.
    card_area
        Mean opaque area of a card, square metres.
    """

    grid: FoliageGrid
    envelope: Envelope
    colouring: Colouring
    outlines: Outlines
    middle: Floats
    height: float
    side: float
    card_area: float

    def half_sizes(self, count: int, rng: np.random.Generator) -> Floats:
        """Draw half sides of cards (count,), metres."""
        return self.side * rng.uniform(*SIDES, count) / 2

    def coloured(self, poses: Poses, seats: Seats, rng: np.random.Generator) -> Leaves:
        """Give cards their tiles and their light."""
        tiles, flips = self.colouring.tiles(poses.centres, rng), rng.random(len(seats)) < 0.5
        light = shades(poses.centres, poses.lift, self.envelope) + rng.normal(0, FLICKER, len(seats))
        light = np.clip(light, DARKEST, 1.0)
        return Leaves(poses.centres, poses.rights, poses.ups, tiles, flips, light, seats.joints)

    def dressed(self, poses: Poses, seats: Seats, rng: np.random.Generator) -> tuple[Leaves, NDArray[np.bool_]]:
        """Colour the cards that stay inside the foliage and the crown, and tell which of them do (n,)."""
        leaves = self.coloured(poses, seats, rng)
        kept = self._fitting(leaves)
        return leaves.select(kept), kept

    def hide(self, covered: NDArray[np.bool_], leaves: Leaves) -> None:
        """Mark in covered, flat as the grid's cells, what cards hide."""
        cover(covered, leaves, self.outlines, self.grid)

    def _fitting(self, leaves: Leaves) -> NDArray[np.bool_]:
        """Which cards (m,) lie in the foliage as the photo shows it, or behind its wood, and in the crown's solid."""
        cells = self.grid.flat_cells(leaves.centres[:, 0], leaves.centres[:, 1])
        behind = self.grid.front.ravel()[cells] > leaves.centres[:, 2]
        shown = behind & (share_inside(leaves, self.outlines, self.grid) >= FITTING)
        return np.asarray(shown & self._in_solid(leaves.centres))

    def _in_solid(self, centres: Floats) -> NDArray[np.bool_]:
        """Which places (m, 3) lie in the crown's solid; of a crown that two sides show, in both of them.

        A limb may be drawn to the edge of both sides at once, where no ellipse reaches, and bears leaves there.
        """
        if self.envelope.depth is not None:
            return self.envelope.shown_from_side(centres)
        flat = np.abs(centres[:, 2]) <= FLAT * self.height
        return np.asarray(flat | (self.envelope.reach(centres) <= 1.0))


def crown_of(grid: FoliageGrid, envelope: Envelope, atlas: Atlas, size: float, rng: np.random.Generator) -> Crown:
    """Gather what placing needs; the tree's height is that of the foliage's top above the root."""
    camera, alphas = envelope.camera, tile_alphas(atlas)
    scale = camera.metres_per_pixel
    rows = np.flatnonzero(grid.inside.any(axis=1))
    rows_px = grid.corner_px[1] + np.array([rows[0], 0.6 * rows[-1] + 0.4 * rows[0], rows[-1] + 1]) * grid.step_px
    top, centre, bottom = ((camera.root_px[1] - rows_px) * scale).tolist()
    middle_px = envelope.middle_px[int(np.clip(rows_px[1], 0, camera.height - 1))]
    middle = np.array([(middle_px - camera.root_px[0]) * scale, centre, 0.0])
    middle[2] = envelope.middles(middle[None])[0, 2]
    columns = np.flatnonzero(grid.inside.any(axis=0))
    side = size * float(columns[-1] - columns[0] + 1) * grid.cell_m
    area = float((alphas >= SOLID_ALPHA).mean()) * (side * sum(SIDES) / 2) ** 2
    colouring = colouring_of(grid, envelope, tile_labs(atlas), atlas.recolour, rng)
    return Crown(grid, envelope, colouring, outlines_of(alphas), middle, max(top, top - bottom), side, area)
