"""From the lines of a sketch to branches that grow from one another.

Source: the moving circle of the two-sketch paper, section 4.2.3, on strokes rather than on pixels: what begins within
reach of a line that is already linked grows from it. Ours takes the nearest first, puts the bud on the bearer's line
rather than at one of its points, and splits a line that runs across its bearer.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import cv2
import numpy as np

from treestroke.core.errors import StrokesError
from treestroke.core.geometry.polyline import arc_lengths, place_at, places_along, resample
from treestroke.core.stroke_rules import TOUCH_SHARE, check_count, clamped
from treestroke.core.strokes import Stroke, StrokeWarning
from treestroke.core.trace.lines import Line, check_length, tree_height
from treestroke.core.types import Floats, Indices

TOLERANCE = 0.0003
"""Of the tree's height: as far as the line through the points that are kept runs from those that are left out."""
TOUCHING = 0.25
"""Of the reach: an end this near touches, and a line's first end is then believed to be its bud."""
RUNS_ALONG = 0.0015
"""Of the tree's height: a stroke that begins this near to its bearer's line runs along it until it leaves it."""
OVERSHOOT = 0.006
"""Of the tree's height: as much as a stroke may begin beyond its bearer."""
BLOCK = 32
"""Places along a stroke that are looked at together: most leave their bearer soon."""
TOUCHES, NEAR, APART = 0, 2, 4
"""How an end of a stroke meets what is linked: the less the sooner the stroke is linked. One more: its last end."""


def link_strokes(
    branches: Sequence[Stroke], canvas: tuple[int, int]
) -> tuple[list[Line], float, tuple[StrokeWarning, ...]]:
    """Link branch strokes, the trunk's first, to lines; give the tree's height, px, and what was mended, too.

    Raises
    ------
    StrokesError
        There is no stroke, one of them is unusable (as `mend_strokes` says), or together they are no tree.
    """
    check_count(1 + len(branches))
    if not branches:
        what = "there is none; draw one stroke from the tree's root up its trunk"
        raise StrokesError.at(("branches",), what, "trunk_missing")
    strokes = [clamped(one, ("branches", i), canvas, 2, "canvas") for i, one in enumerate(branches)]
    strokes[0], warnings = _upright(strokes[0])
    height = tree_height(strokes[0].points[0], np.concatenate([one.points for one in strokes]), canvas)
    check_length(sum(float(arc_lengths(one.points)[-1]) for one in strokes), height)
    plain = [replace(one, points=_plain(one.points, TOLERANCE * height)) for one in strokes]
    linking = _Linking(plain, height, TOUCH_SHARE * max(canvas))
    linking.link_all()
    return linking.lines, height, (*warnings, *linking.warnings)


def _upright(trunk: Stroke) -> tuple[Stroke, tuple[StrokeWarning, ...]]:
    """Let the trunk begin at its lower end."""
    if trunk.points[-1, 1] <= trunk.points[0, 1]:
        return trunk, ()
    detail = "the trunk was drawn downward; its lower end was taken for the root"
    return replace(trunk, points=trunk.points[::-1]), (StrokeWarning("stroke_turned", "branches/0", detail),)


def _plain(points: Floats, tolerance: float) -> Floats:
    """Leave out the points (n, 2) that the line does not need; its ends stay."""
    ways = np.diff(points, axis=0)
    # OpenCV measures to the straight line through a piece's ends, on which a piece that turns back runs beyond them.
    back = np.flatnonzero((ways[1:] * ways[:-1]).sum(axis=1) <= 0) + 1
    kept = [_approximated(piece, tolerance)[:-1] for piece in _pieces(points, back)]
    line = np.vstack([*kept, points[-1:]])
    line = line[np.append(True, np.abs(np.diff(line, axis=0)).max(axis=1) > 0)]
    return line if len(line) > 1 else points


def _pieces(points: Floats, at: Indices) -> list[Floats]:
    """Split a line where it turns back; a piece begins where the one before it ends."""
    ends = [0, *at.tolist(), len(points) - 1]
    return [points[start : stop + 1] for start, stop in pairwise(ends)]


def _approximated(piece: Floats, tolerance: float) -> Floats:
    thinned = cv2.approxPolyDP(piece.astype(np.float32)[:, None], tolerance, closed=False)[:, 0].astype(np.float64)
    return np.vstack([piece[:1], thinned[1:-1], piece[-1:]])


class _Linking:
    """Strokes, px, of a tree of one height, linked one after the other.

    ``rank``, ``gap``, ``bearer``, ``place`` and ``end`` (n,) tell of each stroke how it best meets what is linked: at
    which place of which line, over what gap, px, and with which end, 0 or 1.
    """

    def __init__(self, strokes: list[Stroke], height: float, reach: float) -> None:
        self.strokes, self.height, self.reach = strokes, height, reach
        self.ends = np.stack([stroke.points[[0, -1]] for stroke in strokes])
        self.lines: list[Line] = []
        self.names: list[int] = []
        self.warnings: list[StrokeWarning] = []
        count = len(strokes)
        self.rank, self.gap = np.full(count, APART), np.full(count, np.inf)
        self.bearer, self.end = np.zeros((2, count), dtype=np.int64)
        self.place = np.zeros(count)
        self.waiting = np.arange(1, count)

    def link_all(self) -> None:
        """Link every stroke, the nearest to what is linked first."""
        trunk = self.strokes[0]
        self._add(Line(trunk.points, _radii(trunk, len(trunk.points)), -1, 0.0), 0)
        while len(self.waiting):
            self.waiting = self.waiting[np.lexsort((self.waiting, self.gap[self.waiting], self.rank[self.waiting]))]
            index = int(self.waiting[0])
            if self.rank[index] == APART and self._split_one():
                continue
            self.waiting = self.waiting[1:]
            self._grow(index)

    def _add(self, line: Line, name: int) -> None:
        """Take a line in and see which ends of the others are nearest to it."""
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
        one = np.arange(len(waiting)), end
        better = (ranks[one] < self.rank[waiting]) | (
            (ranks[one] == self.rank[waiting]) & (gaps[one] < self.gap[waiting])
        )
        which, one = waiting[better], (one[0][better], end[better])
        self.rank[which], self.gap[which], self.place[which] = ranks[one], gaps[one], places[one]
        self.bearer[which], self.end[which] = len(self.lines) - 1, one[1]

    def _grow(self, index: int) -> None:
        """Let a stroke grow from its bearer by its nearer end."""
        stroke, bearer = self.strokes[index], int(self.bearer[index])
        if self.rank[index] == APART:
            where = f"branches/{self.names[bearer]}"
            detail = f"it starts {self.gap[index]:.0f} px from every other branch and was joined to {where}"
            self.warnings.append(StrokeWarning("branch_joined", f"branches/{index}", detail))
        points = stroke.points[::-1] if self.end[index] else stroke.points
        self._bear(replace(stroke, points=points), index, bearer, float(self.place[index]))

    def _bear(self, stroke: Stroke, index: int, bearer: int, place: float) -> None:
        points, bearer, place = self._leaving(stroke.points, bearer, place)
        if len(points) == 0:
            return
        bud = place_at(self.lines[bearer].points, place)
        near = float(np.linalg.norm(points[0] - bud)) <= RUNS_ALONG * self.height
        points = np.vstack([bud, points[1:] if near else points])
        if len(points) > 1:
            self._add(Line(points, _radii(stroke, len(points)), bearer, place), index)

    def _leaving(self, points: Floats, bearer: int, place: float) -> tuple[Floats, int, float]:
        """Cut off where a stroke (n, 2) still runs along a line, or beyond its bearer: what is left, and its bud."""
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
                cut, bearer, place = float(some[on[-1]]), int(lines[on[-1]]), float(places[on[-1]])
            if last < len(some):
                break
        if cut >= arcs[-1]:
            return points[:0], bearer, place
        rest = points[arcs > cut]
        return (np.vstack([place_at(points, cut), rest]) if cut > 0 else points), bearer, place

    def _nearest(self, points: Floats) -> tuple[Indices, Floats, Floats]:
        """Find the line nearest to each point (m, 2), the place along it, and the gap (m,)."""
        end_to_end = np.concatenate([line.points for line in self.lines])
        firsts = np.cumsum([0, *(len(line.points) for line in self.lines)])
        begins = arc_lengths(end_to_end)
        bridges = firsts[1:-1] - 1
        places, gaps = places_along(end_to_end, points, bridges)
        line = np.searchsorted(begins[firsts[1:] - 1], places - 1e-9)
        line = np.minimum(line, len(self.lines) - 1)
        return line, np.maximum(places - begins[firsts[line]], 0.0), gaps

    def _split_one(self) -> bool:
        """Let the first stroke that runs across what is linked, though its ends are apart, grow to both sides of it."""
        for index in self.waiting.tolist():
            stroke = self.strokes[index]
            length = float(arc_lengths(stroke.points)[-1])
            dense = resample(stroke.points, max(0.25 * self.reach, length / 500))
            lines, places, gaps = self._nearest(dense)
            middle = int(gaps.argmin())
            if gaps[middle] <= TOUCHING * self.reach:
                self.waiting = self.waiting[self.waiting != index]
                self._bear_both(index, int(lines[middle]), length * middle / (len(dense) - 1), float(places[middle]))
                return True
        return False

    def _bear_both(self, index: int, bearer: int, at: float, place: float) -> None:
        """Let a stroke grow from its bearer both ways, from a length along it on."""
        stroke = self.strokes[index]
        arcs, here = arc_lengths(stroke.points), place_at(stroke.points, at)
        for half in (stroke.points[arcs < at][::-1], stroke.points[arcs > at]):
            if len(half):
                self._bear(replace(stroke, points=np.vstack([here, half])), index, bearer, place)


def _radii(stroke: Stroke, count: int) -> Floats:
    return np.full(count, 0.0 if stroke.width is None else stroke.width / 2)
