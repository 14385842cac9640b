"""Covers the foliage that many views show of one crown, by cards where the crown is measured to be.

Source: Tan et al. 2007, section 6: leaves lie where the photos show them, and the sparse parts of the tree are filled.
Ours are chosen greedily, as for maximum coverage (Nemhauser, Wolsey and Fisher 1978): a place in the crown is worth the
more, the more views show foliage there that nothing covers yet, as in space carving (Kutulakos and Seitz 2000).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import in_picture
from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.leaf.arrangement import Seats, pose_over, seats_along, thin_edges
from treestroke.core.leaf.coverage import Depths, fit_and_gain
from treestroke.core.leaf.gaps import GapParams
from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.leaf.leaf_crown import SIDES, LeafCrown
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

PLACES = 120_000
"""Most places in the crown that are weighed."""
MOST_DRAWS = 12
"""How many times as many points are tried for them at most: the crown fills as little of its box."""
SIZES = (*(1.0,) * 3, *(0.8,) * 3, *(0.6,) * 2, *(0.45,) * 2, *(0.34,) * 2, *(0.26,) * 2, 0.2, 0.2)
"""Sizes of the cards, round by round, the large ones first."""
SEATS = 8000
"""Places on thin branches that cards may hang from."""
BARK_POINTS = 40_000
"""Points on the bark by which it is told where wood would be seen before the leaves."""
NEAR = 0.02
"""Distance from a branch, as a share of the tree's height, at which a place is half as likely to bear a leaf."""
LEAST_DENSE = 0.2
"""Weight of places where no leaf was measured, over that of a mean density: no measurement is all right."""
BEFORE_WOOD = 0.5
"""Worth of hiding wood where a view shows leaves, over that of covering what is open."""
OUTSIDE_COST, OF_SIZE = 0.2, 1.0
"""Cost of what a card covers beside the foliage, over the worth of foliage that it covers: of the smallest cards, and
more by this for the largest, since smaller ones cover the fringe after them."""
FITTING = 0.25
"""Share of such a card's opaque dots that must lie in the foliage of each view that sees it."""
WITHIN = 0.5
"""Side of the window in which a place's surroundings are looked at, over a card's side."""
CANDIDATES = 2.0
"""Cards that are tried for each that is set."""
AT_ONCE = 0.5
"""Share of what is open that the cards of one round would cover, if each covered something else."""
LEAST_WORTH = 0.08
"""Least share of a card's dots, all views together, that newly hides foliage."""


@runtime_checkable
class _Dense(Protocol):
    """A crown of which it was measured how densely leaves stand in it."""

    def density_at(self, points_world: Floats) -> Floats:
        """Look up the density (n,) of leaves at points (n, 3), metres."""


@dataclass(frozen=True, eq=False)
class _Places:
    """Places in the crown, and where the views show them.

    Attributes
    ----------
    points
        (m, 3) metres, world.
    prior
        (m,) how likely each bears a leaf, whatever is open.
    seats
        Where a card at each place hangs from.
    cells, depths
        (views, m) cell of each view's grid, flat, and depth in it, metres.
    """

    points: Floats
    prior: Floats
    seats: Seats
    cells: NDArray[np.int32]
    depths: Depths


@dataclass(frozen=True, eq=False)
class _Sight:
    """One view while it is covered.

    Attributes
    ----------
    grid
        Its foliage.
    nearest, wood
        (cells,) depth of the nearest card, and of the bark, metres, flat as the grid; infinite where there is none.
    """

    grid: FoliageGrid
    nearest: Depths
    wood: Depths

    def open(self) -> NDArray[np.float32]:
        """How much each cell (rows, columns) is worth covering."""
        free = np.isinf(self.nearest)
        worth = np.where(free, 1.0, BEFORE_WOOD * (self.nearest > self.wood)).astype(np.float32)
        return worth.reshape(self.grid.inside.shape) * self.grid.inside

    def beside(self) -> NDArray[np.float32]:
        """Cells (rows, columns) beside the tree that nothing covers: 1, else 0."""
        free = np.isinf(self.nearest).reshape(self.grid.inside.shape)
        return (free & np.isposinf(self.grid.leaves_from)).astype(np.float32)


def cover_views(
    leaves: Leaves, skeleton: Skeleton, crown: LeafCrown, params: GapParams, rng: np.random.Generator
) -> list[Leaves]:
    """Set cards where the views of a crown show foliage that nothing covers, in smaller and smaller sizes.

    Every card lies in the crown and, in each view that sees it, in the foliage or behind the wood.
    """
    places = _places(skeleton, crown, rng)
    if places is None:
        return []
    sights = _sights(leaves, skeleton, crown, rng)
    at_first = sum(float(sight.open().sum()) for sight in sights)
    wanted, patches = (1 - params.share) * at_first, list[Leaves]()
    for scale in SIZES:
        left, still = params.most - sum(map(len, patches)), sum(float(sight.open().sum()) for sight in sights)
        if left <= 0 or still <= wanted:
            break
        cost = OUTSIDE_COST + OF_SIZE * scale
        worth = places.prior * _worth(places, sights, scale * crown.side * sum(SIDES) / 2, cost)
        count = min(left, _count(worth, places, still, scale, crown))
        patch = _patch(places, _drawn(worth, round(CANDIDATES * count), rng), scale, crown, rng)
        patches.append(patch.select(_best(patch, sights, crown, count, cost)))
        for sight in sights:
            crown.hide(sight.nearest, patches[-1], sight.grid)
    return patches


def _places(skeleton: Skeleton, crown: LeafCrown, rng: np.random.Generator) -> _Places | None:
    """Draw places in the crown that no view excludes; None where there are none, or nothing to hang cards from."""
    from scipy.spatial import KDTree  # imported here: it takes half a second, and trees from one photo need none

    seats = seats_along(skeleton, thin_edges(skeleton).astype(np.float64), SEATS, rng)
    points = _points_within(crown, rng)
    if len(seats) == 0 or len(points) == 0:
        return None
    cells = np.empty((len(crown.grids), len(points)), dtype=np.int32)
    depths = np.empty(cells.shape, dtype=np.float32)
    free = np.ones(len(points), dtype=np.bool_)
    for number, grid in enumerate(crown.grids):
        cells[number], depths[number] = grid.cells_of(points), grid.camera.depth(points)
        free &= grid.deeper(cells[number], depths[number]) | ~in_picture(grid.camera, points)
    points, kept = points[free], np.flatnonzero(free)
    if len(points) == 0:
        return None
    away, nearest = KDTree(seats.points).query(points)
    prior = 1 / (1 + (away / (NEAR * crown.height)) ** 2)
    if isinstance(crown.volume, _Dense):
        density = crown.volume.density_at(points)
        prior *= np.maximum(density / max(float(density.mean()), 1e-12), LEAST_DENSE)
    return _Places(points, prior, seats.at(nearest), cells[:, kept], depths[:, kept])


def _points_within(crown: LeafCrown, rng: np.random.Generator) -> Floats:
    """Draw points (m, 3), metres, evenly in the crown."""
    low, high = crown.volume.bounds
    found, count = list[Floats](), 0
    for _ in range(MOST_DRAWS):
        points = rng.uniform(low, high, (PLACES, 3))
        found.append(points[crown.volume.admits(points)])
        count += len(found[-1])
        if count >= PLACES:
            break
    return np.concatenate(found)[:PLACES]


def _sights(leaves: Leaves, skeleton: Skeleton, crown: LeafCrown, rng: np.random.Generator) -> list[_Sight]:
    """Return the views, covered by the leaves so far and by the bark."""
    seats = seats_along(skeleton, np.maximum(skeleton.radii, 1e-9), BARK_POINTS, rng)
    around = unit(np.cross(seats.directions, rng.normal(size=seats.points.shape)), UP)
    bark = seats.points + skeleton.radii[seats.joints][:, None] * around
    sights = []
    for grid in crown.grids:
        nearest, wood = np.full((2, grid.inside.size), np.inf, dtype=np.float32)
        crown.hide(nearest, leaves, grid)
        np.minimum.at(wood, grid.cells_of(bark), grid.camera.depth(bark).astype(np.float32))
        sights.append(_Sight(grid, nearest, wood))
    return sights


def _worth(places: _Places, sights: Sequence[_Sight], side: float, cost: float) -> Floats:
    """Worth (m,) of a card with this side, metres, at each place: what it would cover, less what beside the foliage."""
    worth = np.zeros(len(places.points), dtype=np.float32)
    for sight, cells, depths in zip(sights, places.cells, places.depths, strict=True):
        window = (max(1, round(WITHIN * side / sight.grid.cell_m)),) * 2
        gain = cv2.blur(sight.open(), window).ravel().take(cells)
        worth += gain * (depths < sight.wood.take(cells))
        worth -= np.float32(cost) * cv2.blur(sight.beside(), window).ravel().take(cells)
    return np.maximum(worth, 0.0).astype(np.float64)


def _count(worth: Floats, places: _Places, still: float, scale: float, crown: LeafCrown) -> int:
    """Estimate how many cards of a size cover a share of the cells that are ``still`` open."""
    cells = scale**2 * crown.card_area / float(np.mean([grid.cell_m for grid in crown.grids])) ** 2
    chance = worth.sum()
    if chance <= 0:
        return 0
    usual = float((worth * (worth / places.prior)).sum() / chance)
    return int(np.ceil(AT_ONCE * still / max(usual * cells, 1e-9)))


def _drawn(worth: Floats, count: int, rng: np.random.Generator) -> Indices:
    """Draw up to ``count`` places by their worth (m,), none twice (Efraimidis and Spirakis 2006)."""
    index = np.flatnonzero(worth > 0)
    keys = np.log(rng.random(len(index))) / worth[index] ** 2
    if len(index) <= count:
        return index
    return np.sort(index[np.argpartition(keys, -count)[-count:]]) if count > 0 else index[:0]


def _patch(places: _Places, chosen: Indices, scale: float, crown: LeafCrown, rng: np.random.Generator) -> Leaves:
    """Set cards of one size at the chosen places (k,)."""
    seats, centres = places.seats.at(chosen), places.points[chosen]
    half_sizes = scale * crown.half_sizes(len(chosen), rng)
    poses = pose_over(seats, centres, half_sizes, unit(centres - crown.middle, UP), rng)
    return crown.coloured(poses, seats, rng)


def _best(leaves: Leaves, sights: Sequence[_Sight], crown: LeafCrown, count: int, cost: float) -> Mask:
    """Choose up to ``count`` cards (k,) that fit all views that see them and cover most foliage and least beside it."""
    covered, beside, fits = np.zeros(len(leaves)), np.zeros(len(leaves)), np.ones(len(leaves), dtype=np.bool_)
    for sight in sights:
        inside, foliage, background = fit_and_gain(sight.nearest, leaves, crown.outlines, sight.grid)
        fits &= (inside >= FITTING) | ~in_picture(sight.grid.camera, leaves.centres)
        covered += foliage
        beside += background
    gain = np.where(fits & (covered >= LEAST_WORTH), covered - cost * beside, 0.0)
    best = np.argsort(-gain, kind="stable")[:count]
    kept = np.zeros(len(leaves), dtype=np.bool_)
    kept[best] = gain[best] > 0
    return kept
