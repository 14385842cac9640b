"""Adds cards where cards leave gaps in the foliage, or wood stands before them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.leaf.arrangement import Seats, pose_over, seats_along
from treestroke.core.leaf.coverage import Depths, newly_hidden
from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.leaf.leaf_crown import SIDES, Fit, LeafCrown
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.leaf.shown_limbs import LeafPlace
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices

SIZES = (1.0, 0.8, 0.6, 0.5, 0.4, 0.4, 0.3, 0.3, 0.3, 0.25, 0.25, 0.25, 0.2, 0.2, 0.2, 0.2, 0.2)
"""Sizes of the cards, round by round, the large ones first."""
TARGET = 0.985
"""Share of the foliage's cells at which covering stops."""
SEATS = 8000
"""Places on all branches, thick ones too, that such cards may hang from."""
FITTING = 0.55
"""Share of such a card's opaque dots that must lie in the foliage, which is all fringe where leaves are thin."""
WORTH = 4.0
"""How many times as much open foliage such a card hides as background (2 costs 2 % of the silhouette's precision for
1 % of its recall; 7 crowns)."""
WOOD_SIZES = (1.0, 0.6)
"""Sizes of the cards that hang before wood, round by round (4 to 7 % of a crown's front was bark where the photo shows
leaves; the overlap of leaves alone rises by 0.025; 3 crowns)."""
BEFORE = 0.3
"""How far such a card's middle stands before the bark, in halves of its side."""
FOR_IMAGINED = 0.3
"""Share of such cards that are kept for the imagined sides."""
STRICT_ROUNDS = 2
"""Rounds in which cards over a photo's gaps keep out of the imagined sides' gaps; later the photo is worth more (at 6,
thin crowns lose 1 % of their front)."""
NEAR, REACH = 0.045, 0.08
"""How far such a card usually and at most stands off its branch in the picture, as shares of the tree's height."""
FAR_SHARE = 0.02
"""Share of the cards that may stand further off than NEAR: an end of the crown that growth did not reach."""
THICKNESS = 0.012
"""Standard deviation of such cards' depth about that of their branch, as a share of the tree's height."""
DEPTHS = (-0.015, 0.015, -0.03, 0.03, -0.045, 0.045)
"""Depths beside that of their branch, as shares of the tree's height, to which such cards are moved for foliage."""


@dataclass(frozen=True)
class GapParams:
    """How far gaps are covered.

    Attributes
    ----------
    share
        Share, 0 to 1, of what can be covered that is covered.
    most
        Most cards that are added.
    """

    share: float
    most: int


@dataclass(frozen=True, eq=False)
class _Gaps:
    """What covers the gaps of one view.

    Attributes
    ----------
    grid, place
        The view's foliage, and where cards may hang.
    seats, radii
        Places on all branches, and the branches' radii there (n,), metres.
    far
        How many cards may stand far from their seat, in each round.
    imagined
        Whether no picture shows the view: it does not say where wood is hidden.
    """

    grid: FoliageGrid
    place: LeafPlace
    seats: Seats
    radii: Floats
    far: int
    imagined: bool

    @property
    def crown(self) -> LeafCrown:
        """The crown."""
        return self.place.crown


@dataclass(frozen=True)
class _Size:
    """Size of the cards of a round, and whether they keep out of the gaps of the imagined sides."""

    scale: float
    in_imagined: bool


def cover_gaps(
    leaves: Leaves, skeleton: Skeleton, place: LeafPlace, params: GapParams, rng: np.random.Generator
) -> list[Leaves]:
    """Set cards before the wood that each view would show, and over what is open then, in smaller and smaller sizes.

    Places too far from any branch stay open.
    """
    crown, seats = place.crown, seats_along(skeleton, np.ones(len(skeleton), dtype=np.bool_), SEATS, rng)
    if len(seats) == 0:
        return []
    far, patches = int(FAR_SHARE * len(leaves) / len(SIZES)), [leaves]
    in_front = replace(params, most=int(params.most * (1 - FOR_IMAGINED * (len(crown.imagined_sides) > 0))))
    for grid in (*crown.grids, *crown.imagined_sides):
        gaps = _Gaps(grid, place, seats, skeleton.radii[seats.joints], far, grid in crown.imagined_sides)
        bounds, nearest = params if gaps.imagined else in_front, _nearest_cards(patches, gaps)
        if not gaps.imagined:
            patches += _cover_wood(nearest, patches, gaps, bounds, rng)
        patches += _cover_view(nearest, patches, gaps, bounds, rng)
    return patches[1:]


def _nearest_cards(patches: Sequence[Leaves], gaps: _Gaps) -> Depths:
    """Depth (cells,), metres, of the nearest card in each cell of a view; infinite where there is none."""
    nearest = np.full(gaps.grid.inside.size, np.inf, dtype=np.float32)
    for patch in patches:
        gaps.crown.hide(nearest, patch, gaps.grid)
    return nearest


def _cover_wood(
    nearest: Depths, patches: Sequence[Leaves], gaps: _Gaps, params: GapParams, rng: np.random.Generator
) -> list[Leaves]:
    """Set cards before the wood that a view would show where its picture shows foliage, a share of it by density."""
    grid, crown, added = gaps.grid, gaps.crown, list[Leaves]()
    cells, wood = grid.cells_of(gaps.seats.points), grid.camera.depth(gaps.seats.points) - gaps.radii
    hidden = grid.inside.ravel()[cells] & (rng.random(len(cells)) < params.share)
    for scale in WOOD_SIZES:
        shown = np.flatnonzero(hidden & (wood < nearest[cells]))[: max(0, _left([*patches, *added], params))]
        seats, half_sizes = gaps.seats.at(shown), scale * crown.half_sizes(len(shown), rng)
        toward = grid.camera.toward_viewer(seats.points)
        centres = seats.points + (gaps.radii[shown] + BEFORE * half_sizes)[:, None] * toward
        outward = unit(centres - crown.middle, UP) + toward
        added.append(crown.dressed(pose_over(seats, centres, half_sizes, outward, rng), seats, rng)[0])
        crown.hide(nearest, added[-1], grid)
    return added


def _cover_view(
    nearest: Depths, patches: Sequence[Leaves], gaps: _Gaps, params: GapParams, rng: np.random.Generator
) -> list[Leaves]:
    """Set cards over what all ``patches`` leave open in one view, and bring its ``nearest`` cards up to date."""
    added, seat_of = list[Leaves](), _seats_of_cells(gaps)
    foliage_cells = open_cells = np.flatnonzero(gaps.grid.inside)
    for number, scale in enumerate(SIZES):
        open_cells = open_cells[np.isinf(nearest[open_cells])]
        left = _left([*patches, *added], params)
        surplus = len(open_cells) - (1 - TARGET * params.share) * len(foliage_cells)
        if surplus <= 0 or left <= 0:
            break
        size = _Size(scale, gaps.imagined or number < STRICT_ROUNDS)
        count = min(_count(surplus, scale, gaps), left, len(open_cells))
        chosen = rng.choice(open_cells, count, replace=False)
        patch = _patch(gaps.seats.at(seat_of[chosen]), chosen, size, gaps, rng)
        foliage, background = newly_hidden(nearest, patch, gaps.crown.outlines, gaps.grid)
        added.append(patch.select((foliage > 0) & (foliage >= WORTH * background)))
        gaps.crown.hide(nearest, added[-1], gaps.grid)
    return added


def _left(patches: Sequence[Leaves], params: GapParams) -> int:
    """Count the cards that may be added yet; the first of the ``patches`` does not count as added."""
    return params.most - sum(map(len, patches[1:]))


def _count(cells: float, scale: float, gaps: _Gaps) -> int:
    """Estimate how many cards of a size cover this many cells, if half of them cover nothing new."""
    card_cells = 0.3 * (scale * gaps.crown.side * sum(SIDES) / 2 / gaps.grid.cell_m) ** 2
    return int(np.ceil(1.5 * cells / max(card_cells, 1.0)))


def _seats_of_cells(gaps: _Gaps) -> Indices:
    """Find the seat of each cell, flat: the nearest in the picture amid foliage, or of all where that is not near."""
    every, leafy = np.arange(len(gaps.seats)), np.flatnonzero(gaps.crown.volume.admits(gaps.seats.points))
    nearest, _ = _nearest_seats(every, gaps)
    if len(leafy) == 0:
        return nearest
    amid, away = _nearest_seats(leafy, gaps)
    return np.where(away * gaps.grid.cell_m > NEAR * gaps.crown.height, nearest, amid)


def _nearest_seats(index: Indices, gaps: _Gaps) -> tuple[Indices, NDArray[np.float32]]:
    """Find which of some seats (n,) is nearest in the picture to each cell, flat, to within a cell, and how far."""
    cells = gaps.grid.cells_of(gaps.seats.points[index])
    free = np.ones(gaps.grid.inside.size, dtype=np.uint8)
    free[cells] = 0
    away, labels = cv2.distanceTransformWithLabels(
        free.reshape(gaps.grid.inside.shape), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    seat_of = np.zeros(int(labels.max()) + 1, dtype=np.int64)
    seat_of[labels.ravel()[cells]] = index
    return np.asarray(seat_of[labels.ravel()]), np.asarray(away.ravel(), dtype=np.float32)


def _patch(seats: Seats, cells: Indices, size: _Size, gaps: _Gaps, rng: np.random.Generator) -> Leaves:
    """Set cards of one size over cells (m,), each hung from its seat (m,); those that do not fit are left out."""
    crown = gaps.crown
    centres, kept = _centres(cells, seats, gaps, rng)
    seats, half_sizes = seats.at(kept), size.scale * crown.half_sizes(len(centres), rng)
    outward = _seen_from(gaps.grid, centres, unit(centres - crown.middle, UP))
    poses = pose_over(seats, centres, half_sizes, outward, rng)
    return gaps.place.dressed(poses, seats, rng, Fit(FITTING, size.in_imagined))[0]


def _centres(cells: Indices, seats: Seats, gaps: _Gaps, rng: np.random.Generator) -> tuple[Floats, Indices]:
    """Place centres (n, 3), metres, over cells (m,), about as deep in the view as their seats (m,): centres, and which.

    Cells out of reach are left out, and so are all but ``far`` of those that are not near.
    """
    camera, height = gaps.grid.camera, gaps.crown.height
    points_px, depth = gaps.grid.pixels_of(cells, rng.random((len(cells), 2))), camera.depth(seats.points)
    way = camera.world_from_pixels(points_px, depth) - seats.points
    distance = np.sqrt((way**2).sum(axis=1))
    beyond = distance > NEAR * height
    kept = np.flatnonzero((distance <= REACH * height) & (~beyond | (np.cumsum(beyond) <= gaps.far)))
    depth = depth[kept] - rng.normal(0, THICKNESS * height, len(kept))
    return _amid_foliage(points_px[kept], depth, gaps), kept


def _amid_foliage(points_px: Floats, depth: Floats, gaps: _Gaps) -> Floats:
    """Place points (n, 2), px, in the world (n, 3), metres: as near to these depths (n,), metres, as there is foliage.

    They stay at their depth where there is none near.
    """
    camera, crown = gaps.grid.camera, gaps.crown
    placed = camera.world_from_pixels(points_px, depth)
    for away in DEPTHS:
        bare = np.flatnonzero(~crown.volume.admits(placed))
        moved = camera.world_from_pixels(points_px[bare], depth[bare] + away * crown.height)
        leafy = crown.volume.admits(moved)
        placed[bare[leafy]] = moved[leafy]
    return placed


def _seen_from(grid: FoliageGrid, centres: Floats, outward: Floats) -> Floats:
    """Turn directions (n, 3) out of the crown toward or away from the viewer of a view, as they point already."""
    toward = grid.camera.toward_viewer(centres)
    away = (outward * toward).sum(axis=1, keepdims=True) < 0
    return np.asarray(outward + np.where(away, -1.0, 1.0) * toward)
