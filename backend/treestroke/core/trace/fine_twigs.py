"""The twigs of a bare crown that stand too densely to be told apart one by one.

A line thinned from what many twigs cover winds between them, and is as thick as all of them. So where wood is seen
beyond what was traced, twigs are drawn as they grow: from what bears them outward, nearly straight, along wood.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.vectors import unit
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask, Opacity

LAYERS = ((0.3, 24), (0.3, 12), (0.3, 7), (0.3, 5), (0.12, 14), (0.12, 9))
"""Shares of a pixel from which on wood there is drawn, and sides of the cells in which one twig each is, px: from the
longest twigs to the shortest, and then those that are finer than a pixel."""
SOLID = 0.5
"""Share of a pixel from which on a twig is as thick as what is seen of it."""
MOST = 3000
"""Greatest number of twigs: where there are more, those are left out that show least."""
TRIED = 8
"""Number of joints along the ways from which wood is looked for, the cheapest first."""
LENGTH_PX = (3.0, 60.0)
"""Least and greatest length of a twig, px."""
ON_WOOD = 0.7
"""Least share of a twig along which wood is seen."""
FORWARD = 0.2
"""Least cosine of a twig's angle to what bears it."""
STRAY, ASIDE = 3.0, 1.0
"""What a twig costs more, relative to its length: wholly beside wood, and at a right angle to what bears it."""
SLENDER, TAPER = 0.12, 0.6
"""Greatest radius of a twig, as a share of its length, and radius at its tip, as a share of that at its start."""
ARCH = 0.12
"""How far a twig's middle goes on in the direction of what bears it, as a share of its length."""
_ALONG = np.linspace(0.0, 1.0, 9)[1:-1, None, None, None]
"""Places along a twig where wood is looked for."""


def fine_twigs(share: Opacity, traced: Skeleton) -> Skeleton:
    """Return a skeleton (2D, px) with twigs where it leaves wood uncovered; its own joints come first.

    ``share`` (h, w) is that of each pixel that wood covers. Twigs have two joints each and are nowhere thicker than
    what bears them; where wood covers little of each pixel, they are so thin that they cover as little.
    """
    tree, first, covered = traced, 0, np.zeros(share.shape, dtype=np.uint8)
    for seen, cell_px in LAYERS:
        wood, room = share > seen, MOST - (len(tree) - len(traced)) // 2
        if not room:
            break
        _draw(tree, first, covered)
        tips, radii = _tips(wood & (covered == 0), cell_px)
        radii = radii * np.minimum(1.0, sample_nearest(share, tips, 0.0) / SOLID)
        bearers, is_borne = _bearers(tips, tree, wood)
        clearest = np.flatnonzero(is_borne)[np.argsort(-radii[is_borne], kind="stable")[:room]]
        first, tree = len(tree), _with_twigs(tree, bearers[clearest], tips[clearest], radii[clearest])
    return tree


def _draw(tree: Skeleton, first: int, covered: NDArray[np.uint8]) -> None:
    """Draw the joints of a skeleton (2D, px) from ``first`` on into a mask (h, w)."""
    joints = first + np.flatnonzero(tree.parents[first:] >= 0)
    starts, ends = (np.rint(16 * tree.points[of]).astype(np.int64).tolist() for of in (tree.parents[joints], joints))
    breadths = (2 * tree.radii[joints] + 1.5).astype(np.int64).tolist()
    for start, end, breadth in zip(starts, ends, breadths, strict=True):
        cv2.line(covered, start, end, 1, breadth, cv2.LINE_8, 4)


def _tips(left: Mask, cell_px: int) -> tuple[Floats, Floats]:
    """Return the points (n, 2) deepest in wood (h, w) that is left, and how deep (n,), px, one in each cell.

    Cells that hold less of it than a line across them are left out.
    """
    rows, columns = np.nonzero(left)
    cell = (rows // cell_px) * (left.shape[1] // cell_px + 1) + columns // cell_px
    inward = cv2.distanceTransform(left.astype(np.uint8), cv2.DIST_L2, 5)[rows, columns].astype(np.float64)
    order = np.lexsort([-inward, cell])
    _, first, count = np.unique(cell[order], return_index=True, return_counts=True)
    deepest = order[first[count >= cell_px]]
    return np.stack([columns[deepest], rows[deepest]], axis=1).astype(np.float64) + 0.5, inward[deepest]


def _headings(tree: Skeleton) -> Floats:
    """Return the unit direction (n, 2) in which a skeleton's limbs go on at each joint; 0 at a root."""
    return unit(tree.points - tree.points[np.maximum(tree.parents, 0)])


def _bearers(tips: Floats, tree: Skeleton, wood: Mask) -> tuple[Indices, Mask]:
    """Return the joint (n,) that bears a twig to each tip (n, 2), px, at the least cost, and whether one may (n,)."""
    bearers, is_borne, headings = np.zeros(len(tips), dtype=np.int64), np.zeros(len(tips), dtype=bool), _headings(tree)
    side_px = LENGTH_PX[1]
    x, y = tree.points.T.copy() / side_px - 0.5
    squares, square_of = np.unique(tips // side_px, axis=0, return_inverse=True)
    for number, (column, row) in enumerate(squares.tolist()):
        here = np.flatnonzero(square_of.ravel() == number)
        near = np.flatnonzero((np.abs(x - column) < 1.0) & (np.abs(y - row) < 1.0))
        if len(near):
            best, cost = _cheapest(tips[here], tree.points[near], headings[near], wood)
            bearers[here], is_borne[here] = near[best], np.isfinite(cost)
    return bearers, is_borne


def _cheapest(tips: Floats, points: Floats, headings: Floats, wood: Mask) -> tuple[Indices, Floats]:
    """Return from which points (m, 2) of limbs with such headings (m, 2) twigs to tips (n, 2), px, cost least: (n,).

    Return the costs (n,), too; they are infinite where no twig may be.
    """
    way_x, way_y = tips[:, :1] - points[:, 0], tips[:, 1:] - points[:, 1]
    length = np.hypot(way_x, way_y)
    forward = (way_x * headings[:, 0] + way_y * headings[:, 1]) / np.maximum(length, 1e-9)
    cost = length * (1.0 + ASIDE * (1.0 - forward))
    cost[(length < LENGTH_PX[0]) | (length > LENGTH_PX[1]) | (forward < FORWARD)] = np.inf
    tried = np.argpartition(cost, min(TRIED, len(points)) - 1, axis=1)[:, :TRIED]
    rows = np.arange(len(tips))[:, None]
    on_wood = sample_nearest(wood, tips[:, None] + _ALONG * (points[tried] - tips[:, None]), False).mean(axis=0)
    cost = cost[rows, tried] + STRAY * length[rows, tried] * (1.0 - on_wood)
    cost[on_wood < ON_WOOD] = np.inf
    best = cost.argmin(axis=1)
    return tried[rows[:, 0], best], cost[rows[:, 0], best]


def _with_twigs(tree: Skeleton, bearers: Indices, tips: Floats, radii: Floats) -> Skeleton:
    """Add twigs of at most such radii (m,) that lead from joints (m,), indices, to tips (m, 2), px."""
    way = tips - tree.points[bearers]
    length = np.hypot(*way.T)
    middles = tree.points[bearers] + 0.5 * way + ARCH * (length[:, None] * _headings(tree)[bearers] - way)
    radii = np.minimum(np.minimum(radii, SLENDER * length), tree.radii[bearers])
    first = len(tree) + 2 * np.arange(len(bearers))
    return Skeleton(
        np.vstack([tree.points, np.stack([middles, tips], axis=1).reshape(-1, 2)]),
        np.concatenate([tree.radii, np.stack([radii, TAPER * radii], axis=1).ravel()]),
        np.concatenate([tree.parents, np.stack([bearers, first], axis=1).ravel()]),
    )
