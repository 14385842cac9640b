"""From a graph of centre lines to the branches of one tree."""

import heapq
from dataclasses import dataclass

import numpy as np

from treestroke.core.errors import StrokesError
from treestroke.core.geometry.polyline import arc_lengths, place_at
from treestroke.core.trace.centre_lines import STRAIGHT_RAD, Arc, Graph, heading, turn
from treestroke.core.types import Floats
from treestroke.limits import MAX_STROKES

SMALL_LOOP = 4.0
"""Of the ink's half width: a loop of this length, and `SMALL_LOOP_PX`, is a hole in the ink."""
SMALL_LOOP_PX = 12.0
THINNER = 1.5
"""Radians of turning that a doubling of the radius weighs."""
SHORT, SHORT_RAD = 0.25, 0.6
"""What reaches less far than this share of the furthest weighs as so many radians of turning."""


@dataclass(frozen=True, eq=False)
class Path:
    """One branch: points (n, 2) px and half widths (n,) from the node where it goes out to its tip.

    Attributes
    ----------
    bearer
        The path that it grows from, an earlier one; -1 for the stem.
    forks
        Places (k, 2), px, of the nodes on it where others go out, or it meets them, its own first one among them.
    cut
        Whether its tip is where a loop was cut.
    """

    points: Floats
    radii: Floats
    bearer: int
    forks: Floats
    cut: bool


def paths_of(graph: Graph, root: int) -> tuple[list[Path], list[Floats]]:
    """Split a connected graph into branches from a root on; give also the places (2,), px, where loops were cut.

    Raises
    ------
    StrokesError
        It has too many loops.
    """
    if len(graph.arcs) - len(graph.at) >= MAX_STROKES:
        what = f"its lines close more than {MAX_STROKES} loops; draw branches that do not meet again"
        raise StrokesError(f"the picture is no tree: {what}", code="too_many_strokes")
    _part_crossings(graph, root)
    cuts = _cut_loops(graph, root)
    return _branches(graph, root, {node for node, _ in cuts}), [place for _, place in cuts]


def _part_crossings(graph: Graph, root: int) -> None:
    """Let lines that cross pass each other, save where one of them hangs on the crossing alone."""
    parted: dict[int, int] = {}
    spare = max(graph.at) + 1
    for node in sorted(graph.at):
        pair = _crossing(graph, node) if node != root else None
        if pair is not None:
            for number in pair:
                graph.move(number, node, spare)
            parted[spare] = node
            spare += 1
    while parted:
        reached = _distances(graph, root)[0]
        hanging = [
            (min(reached.get(one, np.inf), reached.get(other, np.inf)), one, other)
            for one, other in parted.items()
            if (one in reached) != (other in reached)
        ]
        if not hanging:
            break
        _, one, other = min(hanging)
        for number in list(graph.at[one]):
            graph.move(number, one, other)
        del graph.at[one], parted[one]


def _crossing(graph: Graph, node: int) -> tuple[int, int] | None:
    """Find two arcs at a node of four that go straight on, as the other two do."""
    numbers = graph.at[node]
    if len(set(numbers)) != 4:
        return None
    ways = [heading(graph.arcs[number], node) for number in numbers]
    turns = {
        split: max(turn(ways[0], ways[split]), turn(*(ways[i] for i in (1, 2, 3) if i != split))) for split in (1, 2, 3)
    }
    best = min(turns, key=lambda split: turns[split])
    return (numbers[0], numbers[best]) if turns[best] < STRAIGHT_RAD else None


def _distances(graph: Graph, root: int) -> tuple[dict[int, float], dict[int, int]]:
    """Measure the way from the root to each node it leads to, px; give the arc by which each is reached, too."""
    lengths = {number: arc.length for number, arc in graph.arcs.items()}
    way: dict[int, float] = {}
    by: dict[int, int] = {}
    waiting = [(0.0, root, -1)]
    while waiting:
        far, node, number = heapq.heappop(waiting)
        if node in way:
            continue
        way[node], by[node] = far, number
        for other in graph.at[node]:
            heapq.heappush(waiting, (far + lengths[other], graph.arcs[other].other(node), other))
    return way, by


def _cut_loops(graph: Graph, root: int) -> list[tuple[int, Floats]]:
    """Cut each loop open; give the nodes that came of it, each the end of a line, and their places (2,), px.

    A loop is cut where a line ends at another one, near where the way round is longest; else just there.
    """
    cuts: list[tuple[int, Floats]] = []
    while True:
        way, by = _distances(graph, root)
        closing = min(set(graph.arcs) - set(by.values()), default=-1)
        if closing < 0:
            return cuts
        arc = graph.arcs[closing]
        loop = _loop(graph, closing, way, by)
        length = sum(graph.arcs[number].length for number in loop)
        if length < SMALL_LOOP * float(arc.radii.max()) + SMALL_LOOP_PX:
            graph.drop(closing)
            continue
        cuts += _cut(graph, closing, loop, way, length)


def _loop(graph: Graph, closing: int, way: dict[int, float], by: dict[int, int]) -> list[int]:
    """List the arcs of the loop that an arc closes."""
    one, other = graph.arcs[closing].ends
    loop = [closing]
    while one != other:
        if (way[one], one) < (way[other], other):
            one, other = other, one
        loop.append(by[one])
        one = graph.arcs[by[one]].other(one)
    return loop


def _cut(graph: Graph, closing: int, loop: list[int], way: dict[int, float], length: float) -> list[tuple[int, Floats]]:
    """Cut one loop open."""
    spare = max(graph.at) + 1
    arc = graph.arcs[closing]
    furthest = (way[arc.ends[0]] + way[arc.ends[1]] + arc.length) / 2
    ends = [(number, node) for number in loop for node in set(graph.arcs[number].ends) if _ends_at(graph, number, node)]
    if ends:
        number, node = min(
            ends, key=lambda end: (_unlike_a_tip(graph, *end) + 2 * (furthest - way[end[1]]) / length, end)
        )
        place = graph.place(node)
        graph.move(number, node, spare)
        return [(spare, place)]
    middle = float(np.clip(furthest - way[arc.ends[0]], 0.0, arc.length))
    graph.drop(closing)
    halves = _halves(arc, middle, spare)
    for half in halves:
        graph.add(half)
    return [(half.ends[1], place_at(arc.points, middle)) for half in halves]


def _ends_at(graph: Graph, number: int, node: int) -> bool:
    """Tell whether an arc ends at a line that goes straight on through a node."""
    others = [other for other in graph.at[node] if other != number]
    if len(others) != 2 or len(set(others)) != 2:
        return False
    own, *ways = (heading(graph.arcs[one], node) for one in (number, *others))
    return turn(*ways) < min(turn(own, way) for way in ways)


def _unlike_a_tip(graph: Graph, number: int, node: int) -> float:
    """Weigh how an arc leaves a node: branches rise from where they begin, and are thinner where they end."""
    arc = graph.arcs[number].away_from(node)
    arcs = arc_lengths(arc.points)
    clear = np.minimum(1.5 * np.array([arc.radii[0], arc.radii[-1]]), arcs[-1] / 2)
    here, there = np.interp([clear[0], arcs[-1] - clear[1]], arcs, arc.radii)
    return -float(heading(arc, node)[1]) + float(np.log2(max(here, 1.0) / max(there, 1.0)))


def _halves(arc: Arc, middle: float, spare: int) -> list[Arc]:
    """Cut an arc in two, of which each ends at a node of its own."""
    found = []
    for end, length in ((0, middle), (1, arc.length - middle)):
        half = arc.away_from(arc.ends[end]) if end == 0 else Arc(arc.ends[::-1], arc.points[::-1], arc.radii[::-1])
        count = int(np.searchsorted(arc_lengths(half.points), length + 1e-9, side="right"))
        if count >= 2:
            found.append(Arc((half.ends[0], spare + end), half.points[:count], half.radii[:count]))
    return found


def _branches(graph: Graph, root: int, cut: set[int]) -> list[Path]:
    """Follow branches from the root: each goes on where direction and radius do, what else leaves is a new one."""
    beyond = _reaches(graph, root)
    first = max(graph.at[root], key=lambda number: (beyond[number], -number))
    waiting: list[tuple[int, int, int]] = [(root, first, -1)]
    waiting += [(root, number, 0) for number in graph.at[root] if number != first]
    paths: list[Path] = []
    while waiting:
        node, number, bearer = waiting.pop(0)
        pieces, forks = [graph.arcs[number].away_from(node)], [graph.place(node)]
        while True:
            node, coming = pieces[-1].ends[1], number
            leaving = [other for other in graph.at[node] if other != coming]
            if not leaving:
                break
            number = min(leaving, key=lambda one: (_unlike(graph, node, coming, one, beyond, leaving), one))
            waiting += [(node, other, len(paths)) for other in leaving if other != number]
            if len(leaving) > 1:
                forks.append(graph.place(node))
            pieces.append(graph.arcs[number].away_from(node))
        if node in cut:
            forks.append(pieces[-1].points[-1])
        points = np.vstack([pieces[0].points[:1], *(piece.points[1:] for piece in pieces)])
        radii = np.concatenate([pieces[0].radii[:1], *(piece.radii[1:] for piece in pieces)])
        paths.append(Path(points, radii, bearer, np.array(forks), node in cut))
    return paths


def _reaches(graph: Graph, root: int) -> dict[int, float]:
    """Measure how far each arc of a tree leads outward at most, px."""
    way, by = _distances(graph, root)
    beyond = {number: graph.arcs[number].length for number in graph.arcs}
    for node in sorted(way, key=lambda one: (-way[one], -one)):
        onward = [beyond[number] for number in graph.at[node] if number != by[node]]
        if by[node] >= 0:
            beyond[by[node]] += max(onward, default=0.0)
    return beyond


def _unlike(graph: Graph, node: int, coming: int, leaving: int, beyond: dict[int, float], others: list[int]) -> float:
    """Weigh how unlike an arc that leaves a node is to the one that comes, rad."""
    arc, before = graph.arcs[leaving], graph.arcs[coming]
    bent = turn(heading(before, node), heading(arc, node))
    wide = float(np.log2(max(np.median(arc.radii), 0.5) / max(np.median(before.radii), 0.5)))
    short = beyond[leaving] < SHORT * max(beyond[other] for other in others)
    return bent + THINNER * abs(wide) + SHORT_RAD * short
