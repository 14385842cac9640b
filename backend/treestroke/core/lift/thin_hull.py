"""The hull of thin things: the small cubes that every shot shows as the tree."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from treestroke.core.capture import Shot
from treestroke.core.side_by_side import side_by_side
from treestroke.core.types import Floats, Indices, Mask, Opacity

START_CELLS = 24
"""Cells along the side of the box in which the hull is looked for first: as wide as the way to the nearest camera."""
MISSES = 1
"""Shots that may contradict a cell: one bad matte does not cut a limb off."""
FEWEST, SHARE_OF_SHOTS = 3, 0.35
"""Shots that must show a cell, and their share of all: fewer agree by chance, amid leaves."""
UNDER_GROUND = 0.005
"""How far below the root cells are kept, as a share of the height."""
SLACK_PX = 0.7
"""How far a cell's middle may lie beside a matte at the finest side: half a pixel each of the matte and the camera."""

HOLE_PX, THICK_PX = 9, 17
"""Width of holes that are filled, px, and of the parts in which they are: trunks, not tangles of twigs."""
AROUND = 0.08
"""Side of the square about a point that tells what is by chance, as a share of the height."""
MOST_CHANCE = 0.6
"""Greatest chance: on a trunk all places near are wood, and yet it is there."""
AT_ONCE = 20_000
"""Points that are looked up at once: so many, with what is found of them, fit into a processor's cache."""
HALF_DIAGONAL = 3**0.5 / 2
"""Radius of the ball around a cube, relative to its side."""
CHILDREN = np.indices((2, 2, 2)).reshape(3, -1).T
"""Places of the eight cubes in a cube that is halved."""


@dataclass(frozen=True, eq=False)
class ShownArea:
    """What a shot shows of something, for looking it up at points.

    Attributes
    ----------
    shot
        The shot.
    shown
        (h, w) where it is seen.
    within_px
        (h, w) signed distance of each pixel from the outline of what is shown or may be hidden there, px: positive
        within, negative beside it.
    away_px
        (h, w) distance of each pixel from the nearest one that is shown, px.
    inside_px
        (h, w) distance of each pixel that is shown from the nearest one that is not, px.
    tree
        (h, w) where the shot shows the tree at all.
    """

    shot: Shot
    shown: Mask
    within_px: Opacity
    away_px: Opacity
    inside_px: Opacity
    tree: Mask

    def look_up(self, points_world: Floats) -> tuple[Floats, Floats]:
        """Return how far points (n, 3), metres, lie within what may be shown, and away from what is: metres (n,).

        Outside the picture everything may be and nothing is: both are infinite.
        """
        seen, at = _pixels(self.shot, points_world)
        pixel = self.shot.camera.pixel_size(points_world)
        return np.where(seen, self.within_px[at] * pixel, np.inf), np.where(seen, self.away_px[at] * pixel, np.inf)

    def widest(self, points_world: Floats) -> tuple[Floats, Floats]:
        """Return how far the pixels next to points' (n, 3), metres, lie within at most: px (n,).

        Within what may be shown, then within what is shown; outside the picture both are 0.
        """
        seen, at = _pixels(self.shot, points_world)
        beside = np.ones((3, 3), dtype=np.uint8)
        both = (np.where(seen, cv2.dilate(away, beside)[at], 0.0) for away in (self.within_px, self.inside_px))
        return next(both), next(both)

    def chance(self, points_world: Floats, reach_px: float, around_px: float) -> Floats:
        """Return how likely a point of the crown near each of points (n, 3), metres, is within reach of what is shown.

        It is the share (n,) of the tree's pixels, in a square about each point, that lie within ``reach_px`` of it.
        """
        size = (max(int(around_px), 1),) * 2
        near = (self.away_px <= reach_px).astype(np.float32)
        share = cv2.blur(near, size) / np.maximum(cv2.blur(np.maximum(near, self.tree), size), 1e-6)
        seen, at = _pixels(self.shot, points_world)
        return np.where(seen, np.minimum(share[at], MOST_CHANCE), 0.0)


def shown_area(shot: Shot, tree: Mask, shown: Mask, hidden: Mask) -> ShownArea:
    """Prepare what a shot shows (h, w) of a tree: the part ``shown``, which the rest, or what is hidden, may cover."""
    shown = _healed(shown)
    may_show = tree | hidden | shown
    within = _inner(may_show)
    return ShownArea(
        shot,
        shown,
        within_px=within - _inner(~may_show),
        away_px=_inner(~shown),
        inside_px=_inner(shown),
        tree=tree,
    )


def _inner(mask: Mask) -> Opacity:
    """Return the distance (h, w) of each pixel of a mask from the nearest one that is none of it, px."""
    return np.asarray(cv2.distanceTransform(mask.astype(np.uint8), cv2.DIST_L2, 5), dtype=np.float32)


def _healed(mask: Mask) -> Mask:
    """Fill holes (h, w) in thick parts of a mask: bark has spots that look like leaves, or like what is behind."""
    hole, part = (cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size)) for size in (HOLE_PX, THICK_PX))
    filled = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_CLOSE, hole)
    return np.asarray(mask | (cv2.morphologyEx(filled, cv2.MORPH_OPEN, part) > 0))


def _pixels(shot: Shot, points_world: Floats) -> tuple[Mask, tuple[Indices, Indices]]:
    """Tell which points (n, 3), metres, fall into a shot's picture (n,), and the row and column of each."""
    column, row = np.floor(shot.camera.pixels_from_world(points_world)).astype(np.int64).T
    height, width = shot.camera.height, shot.camera.width
    seen = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    return seen, (np.clip(row, 0, height - 1), np.clip(column, 0, width - 1))


@dataclass(frozen=True, eq=False)
class ThinHull:
    """Cubes of one size on a grid.

    Attributes
    ----------
    cells
        (n, 3) place of each on the grid, ascending.
    side
        Side of a cube, metres; the middle of the cube at cell c is (c + 0.5) side.
    evidence
        (n,) by how many standard deviations more shots show each than would by chance.
    radius
        (n,) how far each cube's middle lies within what the shots show, metres: near the radius of the wood on its
        centre line, 0 at its outline.
    """

    cells: Indices
    side: float
    evidence: Floats
    radius: Floats

    def __len__(self) -> int:
        return len(self.cells)

    @property
    def middles(self) -> Floats:
        """(n, 3) the cubes' middles, metres."""
        return np.asarray((self.cells + 0.5) * self.side)


def thin_hull(areas: Sequence[ShownArea], share: float) -> ThinHull:
    """Find the cubes that all shots but `MISSES` show, of a side that is a ``share`` of the height of what is shown.

    The root is the origin. An octree is refined where a cell may hold something that is shown, so that the cost follows
    what is there. Source: the visual hull, Laurentini 1994; octrees, Szeliski 1993.
    """
    side = min(float(np.linalg.norm(area.shot.camera.centre)) for area in areas) / START_CELLS
    coarse = np.indices((START_CELLS, START_CELLS + 1, START_CELLS)).reshape(3, -1).T
    coarse = coarse - np.array([START_CELLS // 2, 1, START_CELLS // 2])
    coarse = coarse[_agreed(areas, (coarse + 0.5) * side, side * HALF_DIAGONAL)]
    if len(coarse) == 0:
        return ThinHull(coarse, side, np.zeros(0), np.zeros(0))
    height = (coarse[:, 1].max() + 1) * side
    halvings = max(int(np.round(np.log2(side / (share * height)))), 1)
    cells = _regridded(coarse, side, share * height * 2**halvings)
    for depth in range(halvings, 0, -1):
        side = share * height * 2**depth
        cells = cells[_agreed(areas, (cells + 0.5) * side, side * HALF_DIAGONAL)]
        cells = (2 * cells[:, None] + CHILDREN).reshape(-1, 3)
    cells = cells[(cells[:, 1] + 0.5) * side / 2 > -UNDER_GROUND * height]
    cells = cells[_agreed(areas, (cells + 0.5) * side / 2, side / 4)]
    if len(cells) == 0:
        return ThinHull(cells, side / 2, np.zeros(0), np.zeros(0))
    radius = _radius(areas, (cells + 0.5) * side / 2)
    return ThinHull(cells, side / 2, _evidence(areas, (cells + 0.5) * side / 2, side / 4, AROUND * height), radius)


def _agreed(areas: Sequence[ShownArea], points: Floats, ball: float) -> Mask:
    """Tell which points (n, 3) enough shots show within a ball, metres, and too few contradict: (n,)."""
    parts = np.array_split(points, max(len(points) // AT_ONCE, 1))
    return np.concatenate(side_by_side(lambda part: _agreed_of(areas, part, ball), parts))


def _agreed_of(areas: Sequence[ShownArea], points: Floats, ball: float) -> Mask:
    """Do the same for fewer points (n, 3)."""
    misses, told = np.zeros((2, len(points)), dtype=np.int64)
    left, needed = np.arange(len(points)), fewest(areas)
    for number, area in enumerate(areas, start=1):
        within, away = area.look_up(points[left])
        reach = ball + SLACK_PX * area.shot.camera.pixel_size(points[left])
        misses[left] += within < -reach
        told[left] += away <= reach
        left = left[(misses[left] <= MISSES) & (told[left] + len(areas) - number >= needed)]
    return np.asarray(np.isin(np.arange(len(points)), left))


def _radius(areas: Sequence[ShownArea], points: Floats) -> Floats:
    """Measure how far points (n, 3), metres, lie within what may be shown: (n,), metres.

    It is the second least of the shots' distances, so that one bad matte does not tell.
    """
    least, second = np.full((2, len(points)), np.inf)
    looked_up = side_by_side(lambda area: area.look_up(points)[0], areas)
    for area, within in zip(areas, looked_up, strict=True):
        within = within - 0.5 * area.shot.camera.pixel_size(points)
        second = np.minimum(second, np.maximum(least, within))
        least = np.minimum(least, within)
    return np.maximum(np.where(np.isinf(second), 0.0, second), 0.0)


def _evidence(areas: Sequence[ShownArea], points: Floats, ball: float, around: float) -> Floats:
    """Compare how many shots show points (n, 3), metres, with how many would by chance: (n,), standard deviations.

    Amid leaves, wood is seen here and there in each shot; a place that is not wood falls onto it as often as a place
    nearby does (``around``, metres).
    """

    def counted(area: ShownArea) -> tuple[Mask, Floats]:
        pixel = area.shot.camera.pixel_size(points)
        reach_px = ball / float(np.median(pixel)) + SLACK_PX
        chance = area.chance(points, reach_px, around / float(np.median(pixel)))
        return np.asarray(area.look_up(points)[1] <= reach_px * pixel), chance

    told, expected, variance = np.zeros((3, len(points)))
    for shown, chance in side_by_side(counted, areas):
        told += shown
        expected += chance
        variance += chance * (1 - chance)
    return np.asarray((told - expected) / np.sqrt(variance + 0.5))


def most_evidence(shots: int) -> float:
    """Return the evidence of a cell that all of so many shots show amid wood."""
    return float(shots * (1 - MOST_CHANCE) / np.sqrt(shots * MOST_CHANCE * (1 - MOST_CHANCE) + 0.5))


def fewest(areas: Sequence[ShownArea]) -> int:
    """Return how many shots must show a cell."""
    return max(FEWEST, int(np.ceil(SHARE_OF_SHOTS * len(areas))))


def _regridded(cells: Indices, side: float, new_side: float) -> Indices:
    """List the cells (m, 3) of a grid of another side that touch cells (n, 3), ascending."""
    span = int(np.ceil(side / new_side)) + 1
    offsets = np.indices((span, span, span)).reshape(3, -1).T
    first = np.floor(cells * (side / new_side)).astype(np.int64)
    return np.unique((first[:, None] + offsets).reshape(-1, 3), axis=0)
