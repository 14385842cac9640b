"""From the strokes of a sketch to branch lines that grow from one another.

Source: the moving circle of the two-sketches paper, section 4.2.3, on strokes rather than on pixels: a stroke that
begins within reach of a line that is already linked grows from it. Ours takes the nearest first, puts the bud on the
parent's line rather than at one of its points, and splits a stroke that runs across its parent.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import cv2
import numpy as np

from treestroke.core.errors import StrokesError
from treestroke.core.geometry.polyline import arc_lengths, place_at, places_along, resample
from treestroke.core.stroke_rules import NO_TRUNK, TOUCH_SHARE, check_count, clamped
from treestroke.core.strokes import Stroke, StrokeWarning
from treestroke.core.trace.branch_lines import BranchLine, check_length, tree_height
from treestroke.core.types import Floats, Indices

TOLERANCE = 0.0003
"""Greatest distance of a dropped point from the simplified line, as a share of the tree's height."""
TOUCHING = 0.25
"""Distance, as a share of the reach, within which an end touches a line; a touching first end is taken for the bud."""
RUNS_ALONG = 0.0015
"""Distance, as a share of the tree's height, within which a stroke still runs along its parent's line."""
OVERSHOOT = 0.006
"""Length, as a share of the tree's height, by which a stroke may begin beyond its parent."""
BLOCK = 32
"""Places along a stroke that are compared at a time: most strokes leave their parent soon."""
TOUCHES, NEAR, APART = 0, 2, 4
"""Ranks of a stroke's end by its distance from the lines, plus 1 for the last end; the least is linked first."""


def link_strokes(
    branches: Sequence[Stroke], canvas: tuple[int, int]
) -> tuple[list[BranchLine], float, tuple[StrokeWarning, ...]]:
    """Link branch strokes, the trunk's first, to lines; return them, the tree's height, px, and warnings of repairs.

    Source: two-sketches paper, section 4.2.3.

    Raises
    ------
    StrokesError
        There is no stroke, one of them is unusable (as `mend_strokes` says), or together they do not form a tree.
    """
    check_count(1 + len(branches))
    if not branches:
        raise StrokesError.at(("branches",), NO_TRUNK, "trunk_missing")
    strokes = [clamped(stroke, ("branches", i), canvas, 2, "canvas") for i, stroke in enumerate(branches)]
    strokes[0], warnings = _upright(strokes[0])
    height = tree_height(strokes[0].points[0], np.concatenate([stroke.points for stroke in strokes]), canvas)
    check_length(sum(float(arc_lengths(stroke.points)[-1]) for stroke in strokes), height)
    simple = [replace(stroke, points=_simplify(stroke.points, TOLERANCE * height)) for stroke in strokes]
    linking = _Linking(simple, height, TOUCH_SHARE * max(canvas))
    linking.link_all()
    return linking.lines, height, (*warnings, *linking.warnings)


def _upright(trunk: Stroke) -> tuple[Stroke, tuple[StrokeWarning, ...]]:
    """Turn the trunk so that it begins at its lower end."""
    if trunk.points[-1, 1] <= trunk.points[0, 1]:
        return trunk, ()
    detail = "the trunk was drawn downward; its lower end was taken for the root"
    return replace(trunk, points=trunk.points[::-1]), (StrokeWarning("stroke_turned", "branches/0", detail),)


def _simplify(points: Floats, tolerance: float) -> Floats:
    """Drop the points (n, 2) that lie within a tolerance, px, of the line that remains; its ends stay."""
    edges = np.diff(points, axis=0)
    # OpenCV measures distances to the infinite line through a piece's ends, so no piece may turn back.
    back = np.flatnonzero((edges[1:] * edges[:-1]).sum(axis=1) <= 0) + 1
    kept = [_approximated(piece, tolerance)[:-1] for piece in _pieces(points, back)]
    line = np.vstack([*kept, points[-1:]])
    line = line[np.append(True, np.abs(np.diff(line, axis=0)).max(axis=1) > 0)]
    return line if len(line) > 1 else points


def _pieces(points: Floats, at: Indices) -> list[Floats]:
    """Split a line (n, 2) at point indices; a piece begins with the last point of the one before it."""
    ends = [0, *at.tolist(), len(points) - 1]
    return [points[start : stop + 1] for start, stop in pairwise(ends)]


def _approximated(piece: Floats, tolerance: float) -> Floats:
    """Return a piece (n, 2) simplified by the algorithm of Douglas and Peucker, with its own ends."""
    inner = cv2.approxPolyDP(piece.astype(np.float32)[:, None], tolerance, closed=False)[:, 0].astype(np.float64)
    return np.vstack([piece[:1], inner[1:-1], piece[-1:]])


class _Linking:
    """The strokes of a tree, px, while they are linked one after the other.

    The arrays (n,) hold, for each stroke, its best connection to the lines so far: ``parent`` line, ``place`` along it
    and ``gap`` to it, px, the ``end`` of the stroke, 0 or 1, and the ``rank``.
    """

    def __init__(self, strokes: list[Stroke], height: float, reach: float) -> None:
        self.strokes, self.height, self.reach = strokes, height, reach
        self.ends = np.stack([stroke.points[[0, -1]] for stroke in strokes])
        self.lines: list[BranchLine] = []
        self.names: list[int] = []
        self.warnings: list[StrokeWarning] = []
        count = len(strokes)
        self.rank, self.gap = np.full(count, APART), np.full(count, np.inf)
        self.parent, self.end = np.zeros((2, count), dtype=np.int64)
        self.place = np.zeros(count)
        self.waiting = np.arange(1, count)

    def link_all(self) -> None:
        """Link every stroke, the one nearest to the lines so far first."""
        trunk = self.strokes[0]
        self._add(BranchLine(trunk.points, _radii(trunk, len(trunk.points)), -1, 0.0), 0)
        while len(self.waiting):
            self.waiting = self.waiting[np.lexsort((self.waiting, self.gap[self.waiting], self.rank[self.waiting]))]
            index = int(self.waiting[0])
            if self.rank[index] == APART and self._split_crossing():
                continue
            self.waiting = self.waiting[1:]
            self._connect(index)

    def _add(self, line: BranchLine, name: int) -> None:
        """Add a line and update the connections of the waiting strokes."""
        self.lines.append(line)
        self.names.append(name)
        waiting = self.waiting
        places, gaps = places_along(line.points, self.ends[waiting].reshape(-1, 2))
        gaps = np.maximum(gaps - np.interp(places, arc_lengths(line.points), line.radii), 0.0)
        places, gaps = places.reshape(-1, 2), gaps.reshape(-1, 2)
        ranks = np.where(gaps <= TOUCHING * self.reach, TOUCHES, NEAR)
        ranks[:, 1] += 1
        ranks[gaps > self.reach] = APART
        end = np.where(ranks[:, 0] == ranks[:, 1], gaps.argmin(axis=1), ranks.argmin(axis=1))
        rows = np.arange(len(waiting))
        rank, gap, place = ranks[rows, end], gaps[rows, end], places[rows, end]
        better = (rank < self.rank[waiting]) | ((rank == self.rank[waiting]) & (gap < self.gap[waiting]))
        improved = waiting[better]
        self.rank[improved], self.gap[improved], self.place[improved] = rank[better], gap[better], place[better]
        self.parent[improved], self.end[improved] = len(self.lines) - 1, end[better]

    def _connect(self, index: int) -> None:
        """Connect a stroke with its parent by its nearer end."""
        stroke, parent = self.strokes[index], int(self.parent[index])
        if self.rank[index] == APART:
            where = f"branches/{self.names[parent]}"
            detail = f"it starts {self.gap[index]:.0f} px from every other branch and was joined to {where}"
            self.warnings.append(StrokeWarning("branch_joined", f"branches/{index}", detail))
        points = stroke.points[::-1] if self.end[index] else stroke.points
        self._add_from(replace(stroke, points=points), index, parent, float(self.place[index]))

    def _add_from(self, stroke: Stroke, index: int, parent: int, place: float) -> None:
        """Add a stroke's line from a place, px, along a parent."""
        points, parent, place = self._leaving(stroke.points, parent, place)
        if len(points) == 0:
            return
        bud = place_at(self.lines[parent].points, place)
        near = float(np.linalg.norm(points[0] - bud)) <= RUNS_ALONG * self.height
        points = np.vstack([bud, points[1:] if near else points])
        if len(points) > 1:
            self._add(BranchLine(points, _radii(stroke, len(points)), parent, place), index)

    def _leaving(self, points: Floats, parent: int, place: float) -> tuple[Floats, int, float]:
        """Cut off the part of a stroke (n, 2) along a line or beyond its parent; return the rest and its bud."""
        near = RUNS_ALONG * self.height
        arcs = arc_lengths(points)
        at = np.append(np.arange(0.0, arcs[-1], near), arcs[-1])
        cut = 0.0
        for start in range(0, len(at), BLOCK):
            some = at[start : start + BLOCK]
            lines, places, gaps = self._nearest(place_at(points, some))
            off = (gaps > near) & (some > OVERSHOOT * self.height)
            last = int(off.argmax()) if off.any() else len(some)
            on = np.flatnonzero(gaps[:last] <= near)
            if len(on):
                cut, parent, place = float(some[on[-1]]), int(lines[on[-1]]), float(places[on[-1]])
            if last < len(some):
                break
        if cut >= arcs[-1]:
            return points[:0], parent, place
        rest = points[arcs > cut]
        return (np.vstack([place_at(points, cut), rest]) if cut > 0 else points), parent, place

    def _nearest(self, points: Floats) -> tuple[Indices, Floats, Floats]:
        """Return the line (m,) nearest to each point (m, 2), and the place along it and the gap to it (m,), px."""
        end_to_end = np.concatenate([line.points for line in self.lines])
        firsts = np.cumsum([0, *(len(line.points) for line in self.lines)])
        begins = arc_lengths(end_to_end)
        bridges = firsts[1:-1] - 1
        places, gaps = places_along(end_to_end, points, bridges)
        line = np.searchsorted(begins[firsts[1:] - 1], places - 1e-9)
        line = np.minimum(line, len(self.lines) - 1)
        return line, np.maximum(places - begins[firsts[line]], 0.0), gaps

    def _split_crossing(self) -> bool:
        """Split the first stroke that runs across a line, though its ends are apart; return whether there was one."""
        for index in self.waiting.tolist():
            stroke = self.strokes[index]
            length = float(arc_lengths(stroke.points)[-1])
            dense = resample(stroke.points, max(0.25 * self.reach, length / 500))
            lines, places, gaps = self._nearest(dense)
            middle = int(gaps.argmin())
            if gaps[middle] <= TOUCHING * self.reach:
                self.waiting = self.waiting[self.waiting != index]
                self._add_both(index, int(lines[middle]), length * middle / (len(dense) - 1), float(places[middle]))
                return True
        return False

    def _add_both(self, index: int, parent: int, at: float, place: float) -> None:
        """Add both halves of a stroke, cut at a length along it, as lines of its parent."""
        stroke = self.strokes[index]
        arcs, here = arc_lengths(stroke.points), place_at(stroke.points, at)
        for half in (stroke.points[arcs < at][::-1], stroke.points[arcs > at]):
            if len(half):
                self._add_from(replace(stroke, points=np.vstack([here, half])), index, parent, place)


def _radii(stroke: Stroke, count: int) -> Floats:
    """Return a stroke's radius, px, for each of its points (n,); 0 where unknown."""
    return np.full(count, 0.0 if stroke.width is None else stroke.width / 2)
