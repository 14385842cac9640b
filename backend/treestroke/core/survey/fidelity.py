"""How well a tree from two sketches matches them, and how far it leaves their planes."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

COVERED, TRUE = 2.0, 4.0
"""Distance, units, within which a stroke counts as covered, and a projected limb as true to a stroke."""
PLANE = 20.0
"""Distance, units, from the stem's planes within which a limb counts as lying in them."""
_MARGIN = 16
"""Pixels left free around all that is drawn, for the width of brushes."""
_SHIFT = 4
"""Bits of a unit that lines are placed to."""
_SAMPLE = 1.0
"""Units between places at which lengths are sampled."""


@dataclass(frozen=True)
class Fidelity:
    """Shares from 0 to 1.

    Attributes
    ----------
    front_covered, side_covered
        Of the pixels of each sketch's strokes, those within 2 units of the projected tree.
    front_true, side_true
        Of the projected tree's length, what is within 4 units of that sketch's strokes.
    paired
        Of the length of the front's branches above the stem, what stands for a pair of branches.
    in_planes
        Of the length of the tree's branches without the stem, what is within 20 units of one of the two planes of
        view through the stem at that height.
    """

    front_covered: float
    side_covered: float
    front_true: float
    side_true: float
    paired: float
    in_planes: float


def fidelity(front: Branched, side: Branched, tree: Branched, paired: Mask) -> Fidelity:
    """Compare a tree (3D, sketch units) with its two sketches (2D, sketch units: a height of 1000).

    ``paired`` (n,) tells which of the tree's joints stand for a pair of branches. Strokes and the projected tree are
    drawn one unit wide, or as wide as the brush where radii are known.
    """
    front_covered, front_true = _agreement(front.skeleton, tree.skeleton, 0)
    side_covered, side_true = _agreement(side.skeleton, tree.skeleton, 2)
    return Fidelity(front_covered, side_covered, front_true, side_true, _paired(front, tree, paired), _in_planes(tree))


def _agreement(sketch: Skeleton, tree: Skeleton, axis: int) -> tuple[float, float]:
    """Return the share of a sketch that the projected tree covers, and the share of the tree that is true to it."""
    seen = Skeleton(tree.points[:, [axis, 1]], tree.radii, tree.parents)
    frame = _frame(sketch.points, seen.points)
    strokes, limbs = _drawn(sketch, frame), _drawn(seen, frame)
    covered = _share(_distance(limbs)[strokes > 0] <= COVERED, None)
    places, lengths, _ = _samples(seen)
    true = _share(_at(_distance(strokes), places, frame) <= TRUE, lengths)
    return covered, true


def _paired(front: Branched, tree: Branched, paired: Mask) -> float:
    """Return the share of the front's branches, without the stem, that paired pieces of the tree cover."""
    seen = Skeleton(tree.skeleton.points[:, :2], tree.skeleton.radii, tree.skeleton.parents)
    frame = _frame(front.skeleton.points, seen.points)
    drawn = _drawn(Skeleton(seen.points, np.zeros(len(seen)), seen.parents), frame, paired)
    places, lengths, joints = _samples(front.skeleton)
    branches = front.branch[joints] > 0
    return _share(_at(_distance(drawn), places[branches], frame) <= COVERED, lengths[branches])


def _in_planes(tree: Branched) -> float:
    """Return the share of the branches' length in the two planes through the stem."""
    places, lengths, joints = _samples(tree.skeleton)
    stem = tree.skeleton.points[tree.branch == 0]
    heights, first = np.unique(np.maximum.accumulate(stem[:, 1]), return_index=True)
    near = np.zeros(len(places), dtype=bool)
    for axis in (0, 2):
        near |= np.abs(places[:, axis] - np.interp(places[:, 1], heights, stem[first, axis])) < PLANE
    branches = tree.branch[joints] > 0
    return _share(near[branches], lengths[branches])


def _share(held: Mask, weights: Floats | None) -> float:
    """Return the share of the weights (n,) where ``held`` (n,) is true; 1 without weight."""
    weights = np.ones(len(held)) if weights is None else weights
    total = float(weights.sum())
    return float(weights[held].sum()) / total if total > 0 else 1.0


def _samples(skeleton: Skeleton) -> tuple[Floats, Floats, Indices]:
    """Return places (m, d) along all edges, the length (m,) that each stands for, and the joint (m,) of its edge."""
    lengths = edge_lengths(skeleton)
    counts = np.ceil(lengths / _SAMPLE).astype(np.int64)
    joints = np.repeat(np.arange(len(skeleton)), counts)
    share = (np.arange(len(joints)) - (np.cumsum(counts) - counts)[joints] + 0.5) / counts[joints]
    start = skeleton.points[np.maximum(skeleton.parents, 0)[joints]]
    places = start + share[:, None] * (skeleton.points[joints] - start)
    return places, lengths[joints] / counts[joints], joints


def _frame(*points: Floats) -> tuple[Floats, tuple[int, int]]:
    """Return the least corner and the size (rows, columns) of a picture of all points, one pixel a unit."""
    low = np.floor(np.min([each.min(axis=0) for each in points], axis=0)) - _MARGIN
    high = np.ceil(np.max([each.max(axis=0) for each in points], axis=0)) + _MARGIN
    columns, rows = (high - low).astype(int).tolist()
    return low, (rows, columns)


def _drawn(skeleton: Skeleton, frame: tuple[Floats, tuple[int, int]], chosen: Mask | None = None) -> NDArray[np.uint8]:
    """Draw the edges, or only those to the chosen joints (n,), as wide as they are."""
    picture = np.zeros(frame[1], dtype=np.uint8)
    places = np.round((skeleton.points - frame[0]) * (1 << _SHIFT)).astype(int).tolist()
    widths = np.maximum(np.round(2 * skeleton.radii), 1).astype(int).tolist()
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0 and (chosen is None or chosen[joint]):
            cv2.line(picture, places[parent], places[joint], 255, widths[joint], cv2.LINE_8, _SHIFT)
    return picture


def _distance(picture: NDArray[np.uint8]) -> Floats:
    """Measure how far each pixel is from the nearest one that is drawn."""
    if not picture.any():
        return np.full(picture.shape, np.inf)
    return np.asarray(cv2.distanceTransform(255 - picture, cv2.DIST_L2, cv2.DIST_MASK_PRECISE), dtype=np.float64)


def _at(distance: Floats, places: Floats, frame: tuple[Floats, tuple[int, int]]) -> Floats:
    """Read a picture at places (m, 2)."""
    column, row = np.round(places - frame[0]).astype(np.int64).T
    return np.asarray(distance[row, column])
