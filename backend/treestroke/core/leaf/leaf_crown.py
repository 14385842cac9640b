"""The crown that cards are placed in."""

from dataclasses import dataclass, replace

import numpy as np

from treestroke.core.appearance import Appearance
from treestroke.core.geometry.camera import in_picture
from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.leaf.arrangement import Poses, Seats
from treestroke.core.leaf.colouring import Colouring, colouring_of
from treestroke.core.leaf.coverage import SURE_SHARE, Depths, Outlines, cover, outlines_of, share_hidden, share_inside
from treestroke.core.leaf.grid import CELLS_ACROSS, CELLS_OF_MANY, FoliageGrid, foliage_grid, side_grid
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.paint.atlas import Atlas, tile_alphas, tile_labs
from treestroke.core.paint.cut_outs import SOLID_ALPHA
from treestroke.core.types import Floats, Mask

SIDES = (0.015, 0.03)
"""Smallest and largest side of a card of size 1, as shares of the foliage's breadth."""
FLICKER = 0.02
"""Standard deviation of a card's brightness, so that neighbours stand out from each other. At 0.05 details of a card's
size were stronger than in the photo (13 photos)."""
FULL_LIGHT = 0.95
"""Brightness of a card that is as bright as the photo at its place: the rest is room for brighter ones."""
LEAST_LIGHT = 0.55
"""Least brightness of a card: a darker place gets a darker tile."""
FITTING = 0.92
"""Share of a card's opaque dots that must lie in the foliage. Higher loses more of the foliage at its outline than it
gains beside it (5 photos: 0.96 costs 1 to 3 % of silhouette IoU)."""
FITTING_IMAGINED = 0.8
"""The same for the imagined sides, which are less sure."""
LEAST_SIZE, MOST_SIZE = 0.3, 3.0
"""Bounds of the factor on a card's side, which is 1.5 to 3 % of the foliage's breadth."""
HIDDEN = 0.9
"""Share of a card's opaque dots behind nearer cards from which on it is not seen."""
AROUND = 3
"""Number of views from which on they tell together where leaves are."""
SURE_OF_MANY = 0.4
"""`SURE_SHARE` where many views bound the crown: what is drawn of a card, neither more nor less."""
MIDDLE = 0.6
"""How far down from the foliage's top, as a share of its height, the point is that cards face away from."""


@dataclass(frozen=True)
class Fit:
    """How well cards must fit.

    Attributes
    ----------
    share
        Share of their opaque dots that must lie in the foliage.
    in_imagined
        Whether they must fit the imagined sides too.
    """

    share: float = FITTING
    in_imagined: bool = True


USUAL_FIT = Fit()


@dataclass(frozen=True, eq=False)
class LeafCrown:
    """The views' foliage, the crown's volume, the colours and the atlas's tiles, with sizes in metres.

    Attributes
    ----------
    grids
        The foliage of each view, one at least.
    imagined_sides
        The foliage as it is imagined from sides that no view shows.
    volume, colouring, outlines
        Where the crown is, which tile goes where, and the tiles' opaque dots.
    middle
        (3,) the point that cards face away from, world.
    height
        The tree's height above its root.
    side
        The foliage's breadth times the size factor.
    card_area
        Mean opaque area of a card, square metres.
    """

    grids: tuple[FoliageGrid, ...]
    imagined_sides: tuple[FoliageGrid, ...]
    volume: CrownVolume
    colouring: Colouring
    outlines: Outlines
    middle: Floats
    height: float
    side: float
    card_area: float

    @property
    def seen_around(self) -> bool:
        """Whether so many views show it that they tell where its leaves are."""
        return len(self.grids) >= AROUND

    @property
    def foliage_area(self) -> float:
        """Area of the foliage in a view, square metres; of several views the mean."""
        return float(np.mean([grid.inside.sum() * grid.cell_m**2 for grid in self.grids]))

    def half_sizes(self, count: int, rng: np.random.Generator) -> Floats:
        """Draw half sides of cards (count,), metres."""
        return self.side * rng.uniform(*SIDES, count) / 2

    def coloured(self, poses: Poses, seats: Seats, rng: np.random.Generator) -> Leaves:
        """Return cards with their tiles and their light as the pictures show their places."""
        (tiles, brightness), flips = self.colouring.seen(poses.centres, rng), rng.random(len(seats)) < 0.5
        light = _light(brightness, rng)
        return Leaves(poses.centres, poses.rights, poses.ups, tiles, flips, light, seats.joints)

    def recoloured(self, leaves: Leaves, rng: np.random.Generator) -> Leaves:
        """Give cards that no view shows the colours of unseen places; of many views, the others those of the best."""
        hidden, sides = np.ones((len(self.grids), len(leaves)), dtype=np.bool_), []
        for number, grid in enumerate(self.grids):
            nearest = np.full(grid.inside.size, np.inf, dtype=np.float32)
            self.hide(nearest, leaves, grid)
            hidden[number] = share_hidden(nearest, leaves, self.outlines, grid) >= HIDDEN
            sides.append(self.colouring.side(grid, nearest, leaves.centres[~hidden[number]]))
        unseen, tiles, shades = hidden.all(axis=0), leaves.tiles.copy(), leaves.shades.copy()
        tiles[unseen], brightness = self.colouring.unseen(leaves.centres[unseen], sides, rng)
        shades[unseen] = _light(brightness, rng)
        if self.seen_around:
            shown = ~hidden[:, ~unseen]
            tiles[~unseen], brightness = self.colouring.seen(leaves.centres[~unseen], rng, shown)
            shades[~unseen] = _light(brightness, rng)
        return replace(leaves, tiles=tiles, shades=shades)

    def dressed(
        self, poses: Poses, seats: Seats, rng: np.random.Generator, fit: Fit = USUAL_FIT
    ) -> tuple[Leaves, Mask]:
        """Colour the cards that stay inside the foliage and the crown, and tell which of the poses do: flags (n,)."""
        leaves = self.coloured(poses, seats, rng)
        kept = self._fitting(leaves, fit)
        return leaves.select(kept), kept

    def hide(self, nearest: Depths, leaves: Leaves, grid: FoliageGrid) -> None:
        """Lower the depth of the ``nearest`` card (cells,), metres, flat as a view's grid, to that of these cards."""
        cover(nearest, leaves, self.outlines, grid)

    def _fitting(self, leaves: Leaves, fit: Fit) -> Mask:
        """Which cards (m,) lie in the foliage, or behind the wood, of each view that sees them.

        Where depth is seen they lie in the volume; else leaves about its surface may reach out of it.
        """
        fits, excluded = np.zeros((2, len(leaves)), dtype=np.bool_)
        shares = [(grid, fit.share) for grid in self.grids]
        shares += [(side, min(fit.share, FITTING_IMAGINED)) for side in self.imagined_sides if fit.in_imagined]
        for grid, share in shares:
            behind = grid.deeper(grid.cells_of(leaves.centres), grid.camera.depth(leaves.centres))
            shown = behind & (share_inside(leaves, self.outlines, grid) >= share)
            fits |= shown
            excluded |= ~shown & in_picture(grid.camera, leaves.centres)
        in_volume = self.volume.admits(leaves.centres) | (not self.volume.depth_seen)
        return np.asarray(fits & ~excluded & in_volume)


def _light(brightness: Floats, rng: np.random.Generator) -> Floats:
    """Brightness (n,) of cards that are to be so bright (n,) over their tiles' own."""
    return np.clip(FULL_LIGHT * (brightness + rng.normal(0, FLICKER, len(brightness))), LEAST_LIGHT, 1.0)


def leaf_crown(
    appearance: Appearance, volume: CrownVolume, atlas: Atlas, size: float, rng: np.random.Generator
) -> LeafCrown:
    """Gather what placing cards in a crown needs; ``size`` is a factor on their sides.

    The first view's foliage sets the sizes: the tree's height is that of its top above the root.

    Raises
    ------
    ValueError
        A view shows no foliage, or the factor is out of bounds.
    """
    if not LEAST_SIZE <= size <= MOST_SIZE:
        raise ValueError(f"size must be {LEAST_SIZE} to {MOST_SIZE}, got {size}")
    alphas, inner = tile_alphas(atlas), volume.bounds.mean(axis=0)
    across = CELLS_ACROSS if len(appearance.views) < AROUND else CELLS_OF_MANY
    grids = tuple(foliage_grid(view, inner, across) for view in appearance.views)
    imagined = tuple(side_grid(side, grids[0]) for side in appearance.imagined_sides if side.mask.any())
    top, centre, bottom = _heights(grids[0], inner)
    side = size * grids[0].breadth_m
    middle = volume.axis(np.array([centre]))[0]
    middle[1] = centre
    return LeafCrown(
        grids=grids,
        imagined_sides=imagined,
        volume=volume,
        colouring=colouring_of(grids, volume, tile_labs(atlas), atlas.recolour, rng),
        outlines=outlines_of(alphas, atlas.fold, SURE_SHARE if len(grids) < AROUND else SURE_OF_MANY),
        middle=middle,
        height=max(top, top - bottom),
        side=side,
        card_area=float((alphas >= SOLID_ALPHA).mean()) * (side * sum(SIDES) / 2) ** 2,
    )


def _heights(grid: FoliageGrid, inner: Floats) -> tuple[float, float, float]:
    """Heights, metres, of the foliage's top, the point at `MIDDLE` and its bottom, at the depth of ``inner`` (3,)."""
    rows = np.flatnonzero(grid.inside.any(axis=1))
    shown = np.array([rows[0], MIDDLE * rows[-1] + (1 - MIDDLE) * rows[0], rows[-1] + 1])
    places = np.stack([np.full(3, 0.5 * grid.inside.shape[1]), shown], axis=1)
    points_px = np.array(grid.corner_px) + places * grid.step_px
    depth = float(grid.camera.depth(inner[None])[0])
    top, centre, bottom = grid.camera.world_from_pixels(points_px, depth)[:, 1].tolist()
    return top, centre, bottom
