"""The twigs of a bare crown that stand too densely to be told apart one by one.

A line thinned from what many twigs cover winds between them, and is as thick as all of them. So where wood is seen
beyond what was traced, twigs are drawn as they grow: from what bears them outward, nearly straight, along wood.
"""

import cv2
import numpy as np

from treestroke.core.geometry.vectors import unit
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

CELLS_PX = (24, 12, 7, 5)
"""Sides of the cells in which one twig each is drawn, px, from the longest twigs to the shortest."""
MOST = 2500
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


def fine_twigs(wood: Mask, traced: Skeleton) -> Skeleton:
    """Return a skeleton (2D, px) with twigs where it leaves wood (h, w) uncovered; its own joints come first.

    Twigs have two joints each and are nowhere thicker than what bears them.
    """
    tree, before = traced, len(traced)
    for cell_px in CELLS_PX:
        room = MOST - (len(tree) - before) // 2
        tips, radii = _tips(wood & ~_drawn(tree, wood.shape), cell_px)
        if not len(tips) or room <= 0:
            break
        bearers, is_borne = _bearers(tips, tree, wood)
        clearest = np.flatnonzero(is_borne)[np.argsort(-radii[is_borne], kind="stable")[:room]]
        tree = _with_twigs(tree, bearers[clearest], tips[clearest], radii[clearest])
    return tree


def _drawn(tree: Skeleton, shape: tuple[int, ...]) -> Mask:
    """Draw a skeleton (2D, px) as a mask (h, w)."""
    drawn = np.zeros(shape, dtype=np.uint8)
    ends, breadths = np.rint(tree.points * 16).astype(np.int64).tolist(), (2 * tree.radii + 1.5).astype(int).tolist()
    for joint, parent in enumerate(tree.parents.tolist()):
        if parent >= 0:
            cv2.line(drawn, ends[parent], ends[joint], 1, breadths[joint], cv2.LINE_8, 4)
    return drawn > 0


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
    squares, square_of = np.unique(tips // side_px, axis=0, return_inverse=True)
    for number, square in enumerate(squares):
        here = square_of.ravel() == number
        near = np.flatnonzero((np.abs(tree.points / side_px - square - 0.5) < 1.0).all(axis=1))
        if len(near):
            cost = _costs(tips[here], tree.points[near], headings[near], wood)
            bearers[here], is_borne[here] = near[cost.argmin(axis=1)], np.isfinite(cost.min(axis=1))
    return bearers, is_borne


def _costs(tips: Floats, points: Floats, headings: Floats, wood: Mask) -> Floats:
    """Return what twigs from points (m, 2) of limbs with headings (m, 2) to tips (n, 2), px, cost: (n, m)."""
    way = tips[:, None] - points
    length = np.hypot(way[..., 0], way[..., 1])
    forward = (way * headings).sum(axis=2) / np.maximum(length, 1e-9)
    cost = length * (1.0 + ASIDE * (1.0 - forward))
    cost[(length < LENGTH_PX[0]) | (length > LENGTH_PX[1]) | (forward < FORWARD)] = np.inf
    least = np.argsort(cost, axis=1)[:, :TRIED]
    rows = np.arange(len(tips))[:, None]
    on_wood = sample_nearest(wood, points[least] + _ALONG * way[rows, least], False).mean(axis=0)
    tried = np.full(cost.shape, np.inf)
    tried[rows, least] = np.where(
        on_wood < ON_WOOD, np.inf, cost[rows, least] + STRAY * length[rows, least] * (1.0 - on_wood)
    )
    return tried


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
