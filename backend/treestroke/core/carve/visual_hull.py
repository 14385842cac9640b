"""Visual hull: what all the mattes of a tree leave of space, as cubes in metres."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from scipy import ndimage

from treestroke.core.capture import Shot, TreeMatte
from treestroke.core.errors import StrokesError
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.geometry.clumped_crown import Cells
from treestroke.core.side_by_side import side_by_side
from treestroke.core.types import Floats, Indices, Mask

CELLS_HIGH = 192
"""Cells that the box around the tree is high: at 1280 px a cell is 3 to 4 px wide."""
FINEST_PX = 2.0
"""Least side of a cell, px as seen from the cameras: finer ones would not be told apart."""
COARSEST = 24
"""Cells of the first box from the root to the cameras."""
SPLITS = 3
"""How often cells are split in two along each side."""
TOP_LAYERS, TOP_SPLITS = 8, 4
"""Layers of cells under the highest ones that are split while the top is looked for, and how often they are."""
CORNER, FACE = 0.87, 0.5
"""Radius, in sides, of the ball around a cell and in it: coarse cells are asked for as a whole, the finest closely."""
LEAST_OPACITY = 0.35
"""Share of a pixel that the tree has to cover: thin twigs cover no pixel by half."""
SPECK_PX = 4
"""A matte's pieces of fewer pixels are taken for noise."""
SOFT_PX = 1.5
"""Distance beyond a matte over which a cell comes to be contradicted: cameras are right to about a pixel."""
CONTRADICTED = 1.25
"""Sum of the shots' contradictions that empties a cell: a single shot does not."""
SHOWN_SHARE, SHOWN_LEAST = 0.34, 3
"""Share of the shots, and at least how many, that have to show a cell within their pictures."""
WELL_WITHIN = 0.5
"""Share of the cameras' distance within which trees stand."""
MOST_LOST, MOST_ASTRAY = 0.12, 0.5
"""A matte is bad that takes the last cells from this share of the others' blocks, or this share of whose own blocks
have no cell at all."""
MUCH_TREE = 0.25
"""Share of a block that the tree covers from which it needs a cell."""


@dataclass(frozen=True, eq=False)
class MatteDistance:
    """How far a shot's pixels are from the tree in its matte.

    Attributes
    ----------
    camera
        The shot's camera.
    beside_px
        (h, w) distance to the nearest pixel that shows the tree, px; 0 where the shot does not tell.
    """

    camera: PerspectiveCamera
    beside_px: Floats

    def look(self, points_world: Floats, radius_m: float) -> tuple[Mask, Floats]:
        """Tell which balls about points (n, 3), metres, fall into the picture (n,), and how much it denies each (n,).

        A ball is denied by 0 where it meets the matte, by 1 where it is `SOFT_PX` away from it.
        """
        pixels = self.camera.pixels_from_world(points_world)
        column, row = np.floor(np.clip(pixels, -1.0, 1e6)).astype(np.int32).T
        height, width = self.beside_px.shape
        shown = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        beside = self.beside_px[np.where(shown, row, 0), np.where(shown, column, 0)]
        radius_px = radius_m / np.maximum(self.camera.pixel_size(points_world), 1e-9)
        return shown, np.where(shown, np.clip((beside - radius_px) / SOFT_PX, 0.0, 1.0), 0.0)


@dataclass(frozen=True, eq=False)
class VisualHull:
    """The space that no more than about one matte denies to the tree.

    Attributes
    ----------
    cells
        The hull as cubes, metres.
    mattes
        The mattes that made it, bad ones left out.
    good
        (shots,) which shots' mattes those are.
    """

    cells: Cells
    mattes: tuple[MatteDistance, ...]
    good: Mask

    @property
    def height(self) -> float:
        """Height of its highest cell above the root, metres."""
        return float(self.cells.corner[1] + self.cells.side * (np.flatnonzero(self.cells.filled.any((0, 2)))[-1] + 1))

    def inside(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie in its cells: flags (n,)."""
        return self.cells.hold(points_world)

    def share_outside(self, points_world: Floats, radius_m: float = 0.0) -> Floats:
        """Measure the share (n,) of the shots around points (n, 3), metres, that show none of the tree within a radius.

        Points that no shot has in its picture are outside: 1.
        """
        shown, denied = _votes(self.mattes, points_world, radius_m)
        return np.asarray(np.where(shown > 0, denied / np.maximum(shown, 1), 1.0))


def visual_hull(shots: Sequence[Shot], mattes: Sequence[TreeMatte]) -> VisualHull:
    """Carve the visual hull of mattes, gaps in them included, from coarse cells to fine ones.

    A cell stays that at most one shot denies: a limb hidden in one matte stays. The matte that denies much of what the
    others leave is left out as a whole. Thin limbs are kept by asking for distances to the matte instead of its pixels.

    Raises
    ------
    StrokesError
        The mattes leave no space to the tree.
    ValueError
        Fewer than three shots, or not one matte for each.

    Notes
    -----
    Laurentini 1994; Szeliski 1993, "Rapid octree construction from image sequences".
    """
    place, side, distances, good = _first_cells(shots, mattes)
    ring = COARSEST * side
    low, high = side * place.min(axis=0), side * (place.max(axis=0) + 1)
    pixel = float(np.median([shot.camera.pixel_size(np.zeros((1, 3))) for shot in shots]))
    side = max(high[1] / CELLS_HIGH, FINEST_PX * pixel) * 2**SPLITS
    first = np.floor(low / side).astype(np.int64)
    place = np.indices(np.ceil(high / side).astype(np.int64) - first).reshape(3, -1).T + first
    for _ in range(SPLITS):
        place, side = _split(_one_piece(_left(place, side, distances), ring / side)), side / 2
    return VisualHull(_cells(_left(place, side, distances, FACE), side), tuple(distances), good)


def hull_top(shots: Sequence[Shot], mattes: Sequence[TreeMatte]) -> float:
    """Return how high, in the shots' unit, the `visual_hull` of mattes reaches above the root, without its other cells.

    Raises
    ------
    StrokesError, ValueError
        As `visual_hull` does.
    """
    place, side, distances, _ = _first_cells(shots, mattes)
    for _ in range(TOP_SPLITS):
        highest = place[place[:, 1] > place[:, 1].max() - TOP_LAYERS]
        place, side = _left(_split(highest), side / 2, distances), side / 2
    return side * float(_left(place, side, distances, FACE)[:, 1].max() + 1)


def _first_cells(
    shots: Sequence[Shot], mattes: Sequence[TreeMatte]
) -> tuple[Indices, float, list[MatteDistance], Mask]:
    """Return the coarse cells (n, 3) that mattes leave, their side, the good mattes, and which these are (shots,)."""
    if len(shots) != len(mattes) or len(shots) < SHOWN_LEAST:
        raise ValueError(f"a hull needs three shots or more and a matte for each, got {len(shots)} and {len(mattes)}")
    distances = side_by_side(lambda index: _distance(shots[index].camera, mattes[index]), range(len(shots)))
    centres = np.array([shot.camera.centre for shot in shots])
    ring = float(np.median(np.hypot(centres[:, 0], centres[:, 2])))
    side = ring / COARSEST
    box = np.indices((2 * COARSEST,) * 3).reshape(3, -1).T - COARSEST
    place = _one_piece(_left(box, side, distances), COARSEST)
    good = _trusted(place, side, distances)
    distances = [distance for distance, trusted in zip(distances, good, strict=True) if trusted]
    return _one_piece(_left(place, side, distances), COARSEST), side, distances, good


def _distance(camera: PerspectiveCamera, matte: TreeMatte) -> MatteDistance:
    """Measure how far pixels are from a matte without its specks."""
    _, labels, stats, _ = cv2.connectedComponentsWithStats(
        (matte.opacity >= LEAST_OPACITY).astype(np.uint8), connectivity=8
    )
    kept = stats[:, cv2.CC_STAT_AREA] >= SPECK_PX
    kept[0] = False
    told = kept[labels] | matte.hidden
    # Beside the nearest covered pixel's middle the tree reaches half a pixel further.
    beside = cv2.distanceTransform((~told).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE) - 0.5
    return MatteDistance(camera, np.maximum(beside, 0.0))


def _votes(mattes: Sequence[MatteDistance], points: Floats, radius_m: float) -> tuple[Floats, Floats]:
    """Count for points (n, 3), metres, the shots that have them in their pictures (n,) and sum their denials (n,)."""
    shown, denied = np.zeros((2, len(points)))
    for within, denial in side_by_side(lambda matte: matte.look(points, radius_m), mattes):
        shown += within
        denied += denial
    return shown, denied


def _left(place: Indices, side: float, mattes: Sequence[MatteDistance], radius: float = CORNER) -> Indices:
    """Return those of cells (n, 3), counted from the root, that the mattes leave; a ``radius`` of 1 is a side."""
    shown, denied = _votes(mattes, _middles(place, side), side * radius)
    left = place[(denied < CONTRADICTED) & (shown >= max(SHOWN_LEAST, SHOWN_SHARE * len(mattes)))]
    if len(left) == 0:
        fault = "photos do not agree on where the tree stands; draw its crown in one or two further ones"
        raise StrokesError.at(("views",), fault, "no_tree")
    return left


def _middles(place: Indices, side: float) -> Floats:
    """Middles (n, 3), metres, of cells (n, 3), counted from the root."""
    return np.asarray(side * (place + 0.5), dtype=np.float64)


def _trusted(place: Indices, side: float, mattes: Sequence[MatteDistance]) -> Mask:
    """Tell which mattes (shots,) agree with the others about the cells (n, 3) that they leave together.

    A bad one denies cells without which other mattes' pixels have none left, or shows much where no cell is left.
    """
    middles = _middles(place, side)
    denials = np.array([matte.look(middles, side * CORNER)[1] for matte in mattes])
    lost, astray = np.zeros((2, len(mattes)))
    for view, matte in enumerate(mattes):
        tree, block_of = _blocks(matte, middles, side)
        explained = tree & (np.bincount(block_of, minlength=len(tree)) > 0)
        astray[view] = 1 - explained.sum() / max(int(tree.sum()), 1)
        for other in range(len(mattes)):
            left = np.bincount(block_of[denials[other] < 1], minlength=len(tree)) > 0
            share = 1 - (explained & left).sum() / max(int(explained.sum()), 1)
            lost[other] += share * (other != view) / (len(mattes) - 1)
    return np.asarray((lost <= MOST_LOST) & (astray <= MOST_ASTRAY))


def _blocks(matte: MatteDistance, middles: Floats, side: float) -> tuple[Mask, Indices]:
    """Divide a picture into blocks as wide as a cell: which hold much tree (blocks,), and which sees each cell (n,).

    The last block stands for all outside the picture.
    """
    size = max(int(side / float(np.median(matte.camera.pixel_size(middles)))), 1)
    height, width = matte.beside_px.shape
    high, wide = -(-height // size), -(-width // size)
    padded = np.pad(matte.beside_px <= 0, [(0, high * size - height), (0, wide * size - width)])
    tree = padded.reshape(high, size, wide, size).mean(axis=(1, 3)) >= MUCH_TREE
    column, row = np.floor(matte.camera.pixels_from_world(middles) / size).astype(np.int64).T
    within = (column >= 0) & (column < wide) & (row >= 0) & (row < high)
    return np.append(tree.ravel(), False), np.where(within, row * wide + column, high * wide)


def _one_piece(place: Indices, ring: float) -> Indices:
    """Return the cells of (n, 3) in the one piece that has most of them well within the ``ring``, in cells.

    Gaps of two cells are bridged. Elsewhere mattes leave cells by chance, above all close to cameras, where few look.
    """
    corner = place.min(axis=0) - 1
    filled = np.zeros(place.max(axis=0) - corner + 2, dtype=np.bool_)
    filled[tuple((place - corner).T)] = True
    labels, _ = ndimage.label(ndimage.binary_dilation(filled, np.ones((3, 3, 3))), np.ones((3, 3, 3)))
    label = labels[tuple((place - corner).T)]
    near = np.hypot(place[:, 0], place[:, 2]) < WELL_WITHIN * ring
    return np.asarray(place[label == np.bincount(label, near).argmax()])


def _split(place: Indices) -> Indices:
    """Split cells (n, 3) into eight each."""
    parts = np.indices((2, 2, 2)).reshape(3, -1).T
    return np.asarray((2 * place[:, None] + parts).reshape(-1, 3))


def _cells(place: Indices, side: float) -> Cells:
    """Make a grid of cells (n, 3), counted from the root."""
    corner = place.min(axis=0)
    filled = np.zeros(place.max(axis=0) - corner + 1, dtype=np.bool_)
    filled[tuple((place - corner).T)] = True
    return Cells(filled, side * corner, side)
