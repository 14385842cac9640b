"""From a graph of centre lines to the branches of one tree: loops are cut, lines that cross are separated."""

import heapq
from dataclasses import dataclass

import numpy as np

from treestroke.core.errors import StrokesError
from treestroke.core.geometry.polyline import arc_lengths, place_at
from treestroke.core.trace.centre_lines import STRAIGHT_RAD, Arc, Graph, heading, turn
from treestroke.core.types import Floats
from treestroke.limits import MAX_STROKES

SMALL_LOOP = 4.0
"""A loop shorter than this many half widths of the ink, plus `SMALL_LOOP_PX`, is a hole in the ink."""
SMALL_LOOP_PX = 12.0
WIDTH_RAD = 1.5
"""Cost of continuing with twice or half the radius, as an angle of turning, radians."""
SHORT, SHORT_RAD = 0.25, 0.6
"""A continuation that reaches less than this share of the furthest costs as much as this angle of turning, radians."""


@dataclass(frozen=True, eq=False)
class BranchPath:
    """One branch: points (n, 2) px and half widths (n,) from the node where it goes out to its tip.

    Attributes
    ----------
    parent
        Index of the path that it grows from, an earlier one; -1 for the stem.
    forks
        (k, 2) px, places of the nodes where it meets other branches, its first point among them.
    cut
        Whether its tip is where a loop was cut.
    """

    points: Floats
    radii: Floats
    parent: int
    forks: Floats
    cut: bool


def split_into_branches(graph: Graph, root: int) -> tuple[list[BranchPath], list[Floats]]:
    """Split a connected graph into branches from a root on; return also the places (2,), px, where loops were cut.

    Raises
    ------
    StrokesError
        The graph has too many loops.
    """
    if len(graph.arcs) - len(graph.at) >= MAX_STROKES:
        problem = f"its lines close more than {MAX_STROKES} loops; draw branches that do not meet again"
        raise StrokesError(f"the picture does not show a tree: {problem}", code="too_many_strokes")
    _separate_crossings(graph, root)
    cuts = _cut_loops(graph, root)
    return _branches(graph, root, {node for node, _ in cuts}), [place for _, place in cuts]


def _separate_crossings(graph: Graph, root: int) -> None:
    """Separate lines that cross, except where one of them is connected by the crossing alone."""
    separated: dict[int, int] = {}
    spare = max(graph.at) + 1
    for node in sorted(graph.at):
        pair = _crossing(graph, node) if node != root else None
        if pair is not None:
            for number in pair:
                graph.move(number, node, spare)
            separated[spare] = node
            spare += 1
    while separated:
        distance = _distances(graph, root)[0]
        disconnecting = [
            (min(distance.get(new, np.inf), distance.get(node, np.inf)), new, node)
            for new, node in separated.items()
            if (new in distance) != (node in distance)
        ]
        if not disconnecting:
            break
        _, new, node = min(disconnecting)
        for number in list(graph.at[new]):
            graph.move(number, new, node)
        del graph.at[new], separated[new]


def _crossing(graph: Graph, node: int) -> tuple[int, int] | None:
    """Return two of a node's four arcs that continue each other, as the other two do; None where they do not."""
    numbers = graph.at[node]
    if len(set(numbers)) != 4:
        return None
    directions = [heading(graph.arcs[number], node) for number in numbers]
    turns = {
        split: max(turn(directions[0], directions[split]), turn(*(directions[i] for i in (1, 2, 3) if i != split)))
        for split in (1, 2, 3)
    }
    best = min(turns, key=lambda split: turns[split])
    return (numbers[0], numbers[best]) if turns[best] < STRAIGHT_RAD else None


def _distances(graph: Graph, root: int) -> tuple[dict[int, float], dict[int, int]]:
    """Return the length, px, of the shortest path from the root to each node (Dijkstra 1959), and its last arc.

    scipy.sparse.csgraph would merge parallel arcs, and its import takes longer than the search in a sketch's graph.
    """
    lengths = {number: arc.length for number, arc in graph.arcs.items()}
    distance: dict[int, float] = {}
    last_arc: dict[int, int] = {}
    waiting = [(0.0, root, -1)]
    while waiting:
        far, node, number = heapq.heappop(waiting)
        if node in distance:
            continue
        distance[node], last_arc[node] = far, number
        for other in graph.at[node]:
            heapq.heappush(waiting, (far + lengths[other], graph.arcs[other].other(node), other))
    return distance, last_arc


def _cut_loops(graph: Graph, root: int) -> list[tuple[int, Floats]]:
    """Cut each loop open; return the new nodes, each the end of a line, and their places (2,), px.

    A loop is cut where a line ends at another one, preferably far from the root along the loop; else at the point
    furthest from the root.
    """
    cuts: list[tuple[int, Floats]] = []
    while True:
        distance, last_arc = _distances(graph, root)
        closing = min(set(graph.arcs) - set(last_arc.values()), default=-1)
        if closing < 0:
            return cuts
        arc = graph.arcs[closing]
        loop = _loop(graph, closing, distance, last_arc)
        length = sum(graph.arcs[number].length for number in loop)
        if length < SMALL_LOOP * float(arc.radii.max()) + SMALL_LOOP_PX:
            graph.drop(closing)
            continue
        cuts += _cut(graph, closing, loop, distance, length)


def _loop(graph: Graph, closing: int, distance: dict[int, float], last_arc: dict[int, int]) -> list[int]:
    """List the arcs of the loop that an arc closes."""
    far, near = graph.arcs[closing].ends
    loop = [closing]
    while far != near:
        if (distance[far], far) < (distance[near], near):
            far, near = near, far
        loop.append(last_arc[far])
        far = graph.arcs[last_arc[far]].other(far)
    return loop


def _cut(
    graph: Graph, closing: int, loop: list[int], distance: dict[int, float], length: float
) -> list[tuple[int, Floats]]:
    """Cut one loop of a length, px, open; return the new nodes and their places (2,), px."""
    spare = max(graph.at) + 1
    arc = graph.arcs[closing]
    furthest = (distance[arc.ends[0]] + distance[arc.ends[1]] + arc.length) / 2
    ends = [(number, node) for number in loop for node in set(graph.arcs[number].ends) if _ends_at(graph, number, node)]
    if ends:
        number, node = min(
            ends, key=lambda end: (_tip_cost(graph, *end) + 2 * (furthest - distance[end[1]]) / length, end)
        )
        place = graph.place(node)
        graph.move(number, node, spare)
        return [(spare, place)]
    middle = float(np.clip(furthest - distance[arc.ends[0]], 0.0, arc.length))
    graph.drop(closing)
    halves = _halves(arc, middle, spare)
    for half in halves:
        graph.add(half)
    return [(half.ends[1], place_at(arc.points, middle)) for half in halves]


def _ends_at(graph: Graph, number: int, node: int) -> bool:
    """Return whether an arc ends at a line that continues through a node."""
    others = [other for other in graph.at[node] if other != number]
    if len(others) != 2 or len(set(others)) != 2:
        return False
    direction, *line = (heading(graph.arcs[arc], node) for arc in (number, *others))
    return turn(*line) < min(turn(direction, other) for other in line)


def _tip_cost(graph: Graph, number: int, node: int) -> float:
    """Return how unlike a tip an arc's end at a node is: branches rise toward their tips and are thinner there."""
    arc = graph.arcs[number].away_from(node)
    arcs = arc_lengths(arc.points)
    clear = np.minimum(1.5 * np.array([arc.radii[0], arc.radii[-1]]), arcs[-1] / 2)
    here, there = np.interp([clear[0], arcs[-1] - clear[1]], arcs, arc.radii)
    return -float(heading(arc, node)[1]) + float(np.log2(max(here, 1.0) / max(there, 1.0)))


def _halves(arc: Arc, middle: float, spare: int) -> list[Arc]:
    """Cut an arc in two at a length, px, along it; each half ends at a new node."""
    found = []
    for end, length in ((0, middle), (1, arc.length - middle)):
        half = arc if end == 0 else arc.reversed()
        count = int(np.searchsorted(arc_lengths(half.points), length + 1e-9, side="right"))
        if count >= 2:
            found.append(Arc((half.ends[0], spare + end), half.points[:count], half.radii[:count]))
    return found


def _branches(graph: Graph, root: int, cut: set[int]) -> list[BranchPath]:
    """Follow branches from the root: each continues with the most similar arc, all others at a fork begin new ones."""
    reaches = _reaches(graph, root)
    first = max(graph.at[root], key=lambda number: (reaches[number], -number))
    waiting: list[tuple[int, int, int]] = [(root, first, -1)]
    waiting += [(root, number, 0) for number in graph.at[root] if number != first]
    paths: list[BranchPath] = []
    while waiting:
        node, number, parent = waiting.pop(0)
        pieces, forks = [graph.arcs[number].away_from(node)], [graph.place(node)]
        while True:
            node, coming = pieces[-1].ends[1], number
            leaving = [other for other in graph.at[node] if other != coming]
            if not leaving:
                break
            number = _continuation(graph, node, coming, leaving, reaches)
            waiting += [(node, other, len(paths)) for other in leaving if other != number]
            if len(leaving) > 1:
                forks.append(graph.place(node))
            pieces.append(graph.arcs[number].away_from(node))
        if node in cut:
            forks.append(pieces[-1].points[-1])
        points = np.vstack([pieces[0].points[:1], *(piece.points[1:] for piece in pieces)])
        radii = np.concatenate([pieces[0].radii[:1], *(piece.radii[1:] for piece in pieces)])
        paths.append(BranchPath(points, radii, parent, np.array(forks), node in cut))
    return paths


def _reaches(graph: Graph, root: int) -> dict[int, float]:
    """Return the greatest length, px, that each arc of a tree leads outward, itself included."""
    distance, last_arc = _distances(graph, root)
    reaches = {number: graph.arcs[number].length for number in graph.arcs}
    for node in sorted(distance, key=lambda node: (-distance[node], -node)):
        onward = [reaches[number] for number in graph.at[node] if number != last_arc[node]]
        if last_arc[node] >= 0:
            reaches[last_arc[node]] += max(onward, default=0.0)
    return reaches


def _continuation(graph: Graph, node: int, coming: int, leaving: list[int], reaches: dict[int, float]) -> int:
    """Return which of the arcs that leave a node continues the one that comes: by direction, radius and reach."""
    before, furthest = graph.arcs[coming], max(reaches[number] for number in leaving)
    direction, radius = heading(before, node), max(np.median(before.radii), 0.5)

    def cost(number: int) -> tuple[float, int]:
        arc = graph.arcs[number]
        bent = turn(direction, heading(arc, node))
        wider = float(np.log2(max(np.median(arc.radii), 0.5) / radius))
        return bent + WIDTH_RAD * abs(wider) + SHORT_RAD * (reaches[number] < SHORT * furthest), number

    return min(leaving, key=cost)
