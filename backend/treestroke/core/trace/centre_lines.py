"""From ink to the graph of its centre lines.

The two-sketches paper (section 4) follows single-pixel strokes by their 8 and 16 neighbours, and finds the centres of
brush strokes by comparing horizontal and vertical runs, which misses nearly horizontal strokes. Ours is one method for
both: thinning, which prefers no direction, and the distance transform for the radii. (Guo and Hall 1989; the thinning
of Zhang and Suen 1984 shortens slanted lines of some widths by hundreds of pixels.)
"""

from collections import defaultdict
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import arc_lengths, place_at
from treestroke.core.types import Floats, Indices, Mask

SPUR, SPUR_PX = 1.5, 1.5
"""An end arc shorter than this many half widths of the ink at its fork, plus px, is a spur of an uneven edge."""
CORNER, CORNER_LENGTH, CORNER_PX = 0.25, 4.0, 3.0
"""An end arc leads into a corner of the ink if its half width falls at least so steeply beyond its fork's circle and it
is no longer than so many half widths; ink of a smaller half width, px, has no corners."""
CLOSE, CLOSE_PX = 2.0, 2.5
"""Two forks of crossing lines are nearer to each other than this many half widths of the ink, plus px; any two forks
within those px alone are one."""
STRAIGHT_RAD = np.radians(35.0)
"""Greatest turn of a line that goes on through a crossing, radians."""
LOOK_PX = 8.0
"""Length over which a line's direction at a fork is measured, px."""
_AROUND = ((-1, 0), (0, -1), (0, 1), (1, 0), (-1, -1), (-1, 1), (1, -1), (1, 1))
"""The 8 neighbours (row, column), first those that share a side."""
_BESIDE = {4: (0, 1), 5: (0, 2), 6: (3, 1), 7: (3, 2)}
"""For each diagonal neighbour the two that share a side with it."""


@dataclass(frozen=True, eq=False)
class Arc:
    """A piece of centre line between two nodes: points (n, 2), n >= 2, and half widths (n,) of the ink there, px."""

    ends: tuple[int, int]
    points: Floats
    radii: Floats

    @property
    def length(self) -> float:
        """Length, px."""
        return float(arc_lengths(self.points)[-1])

    def away_from(self, node: int) -> "Arc":
        """Return the arc in the direction that begins at one of its nodes."""
        return self if self.ends[0] == node else self.reversed()

    def reversed(self) -> "Arc":
        """Return the arc in the opposite direction."""
        return Arc(self.ends[::-1], self.points[::-1], self.radii[::-1])

    def other(self, node: int) -> int:
        """Return the node at its other end."""
        return self.ends[1] if self.ends[0] == node else self.ends[0]


class Graph:
    """A multigraph: nodes and the arcs between them, by number."""

    def __init__(self, arcs: list[Arc]) -> None:
        self.arcs = dict(enumerate(arcs))
        self.at: dict[int, list[int]] = defaultdict(list)
        """The arcs at each node; one that leads back to it is listed twice."""
        self._next = len(arcs)
        for number, arc in self.arcs.items():
            for node in arc.ends:
                self.at[node].append(number)

    def place(self, node: int) -> Floats:
        """Return a node's place (2,), px."""
        return np.asarray(self.arcs[self.at[node][0]].away_from(node).points[0])

    def radius(self, node: int) -> float:
        """Return the ink's half width at a node, px."""
        return float(self.arcs[self.at[node][0]].away_from(node).radii[0])

    def add(self, arc: Arc) -> int:
        """Add an arc and return its number."""
        number = self._next
        self._next += 1
        self.arcs[number] = arc
        for node in arc.ends:
            self.at[node].append(number)
        return number

    def drop(self, number: int) -> None:
        """Remove an arc, and nodes that are left without one."""
        for node in self.arcs.pop(number).ends:
            self.at[node].remove(number)
            if not self.at[node]:
                del self.at[node]

    def move(self, number: int, node: int, to: int) -> None:
        """Reconnect an arc from a node to another one, which gets the same place."""
        arc = self.arcs[number]
        ends = (to if arc.ends[0] == node else arc.ends[0], to if arc.ends[1] == node else arc.ends[1])
        for end in arc.ends:
            if end == node:
                self.at[node].remove(number)
                self.at[to].append(number)
        self.arcs[number] = replace(arc, ends=ends)


def thin(ink: Mask) -> Mask:
    """Return ink, a mask (h, w), thinned to lines one pixel wide (Guo and Hall 1989)."""
    rows, columns = np.flatnonzero(ink.any(axis=1)), np.flatnonzero(ink.any(axis=0))
    lines = np.zeros_like(ink)
    if not len(rows):
        return lines
    box = slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1)
    framed = cv2.copyMakeBorder(ink[box].astype(np.uint8) * 255, 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    lines[box] = cv2.ximgproc.thinning(framed, thinningType=cv2.ximgproc.THINNING_GUOHALL)[1:-1, 1:-1] > 0
    return lines


def build_graph(lines: Mask, half_widths: NDArray[np.float32]) -> Graph:
    """Build the graph of lines (h, w) one pixel wide; half widths (h, w), px, are those of the ink."""
    pixels = np.argwhere(lines)
    around = neighbours(pixels, lines.shape)
    radii = np.asarray(half_widths[tuple(pixels.T)], dtype=np.float64)
    points = pixels[:, ::-1].astype(np.float64) + 0.5
    return Graph([Arc((c[0], c[-1]), points[c], radii[c]) for c in _chains(around, pixels)])


def drop_spurs(graph: Graph) -> Graph:
    """Drop the arcs that thinning makes of the uneven edge or the blunt end of a brush stroke."""
    while True:
        spurs = [number for number, arc in graph.arcs.items() if _is_spur(graph, arc)]
        if not spurs or len(spurs) == len(graph.arcs):
            break
        for number in spurs:
            graph.drop(number)
        for node in [node for node, numbers in graph.at.items() if len(set(numbers)) == len(numbers) == 2]:
            _merge_arcs(graph, node)
    for number, arc in graph.arcs.items():
        for end in arc.ends:
            if len(graph.at[end]) == 1:
                graph.arcs[number] = _without_corner(graph.arcs[number].away_from(end))
    return graph


def merge_crossings(graph: Graph) -> Graph:
    """Merge two forks where thinning split a crossing, or that are next to each other."""
    for number in sorted(graph.arcs, key=lambda number: (graph.arcs[number].length, number)):
        if number not in graph.arcs:
            continue
        arc = graph.arcs[number]
        first, last = arc.ends
        if first == last or min(len(graph.at[first]), len(graph.at[last])) < 3:
            continue
        reach = CLOSE * max(float(arc.radii[0]), float(arc.radii[-1])) + CLOSE_PX
        if arc.length < CLOSE_PX or (arc.length < reach and _cross(graph, number)):
            _contract(graph, number)
    return graph


def heading(arc: Arc, node: int) -> Floats:
    """Return the unit direction (2,) in which an arc leaves a node, measured outside the ink that arcs share."""
    outward = arc.away_from(node)
    arcs, start = arc_lengths(outward.points), max(3.0, float(outward.radii[0]))
    near, far = place_at(outward.points, np.array([min(start, arcs[-1] / 2), min(2.5 * start + LOOK_PX, arcs[-1])]))
    direction = far - near
    return np.asarray(direction / max(float(np.linalg.norm(direction)), 1e-9))


def turn(first: Floats, second: Floats) -> float:
    """Return the turn, radians, of a line whose two arcs leave a node in unit directions (2,); 0 is straight."""
    return float(np.arccos(np.clip(-(first @ second), -1.0, 1.0)))


def _cross(graph: Graph, number: int) -> bool:
    """Return whether two lines cross at an arc: the two at one end of it continue those at the other end."""
    sides = [[other for other in graph.at[node] if other != number] for node in graph.arcs[number].ends]
    if [len(side) for side in sides] != [2, 2] or len({*sides[0], *sides[1]}) != 4:
        return False
    (a, b), (c, d) = (
        [heading(graph.arcs[other], node) for other in side]
        for side, node in zip(sides, graph.arcs[number].ends, strict=True)
    )
    return bool(min(max(turn(a, c), turn(b, d)), max(turn(a, d), turn(b, c))) < STRAIGHT_RAD)


def neighbours(pixels: Indices, shape: tuple[int, ...]) -> list[list[int]]:
    """List the neighbours of each pixel (n, 2); a diagonal one counts only where no pixel shares a side with both."""
    number = np.full((shape[0] + 2, shape[1] + 2), -1, dtype=np.int64)
    row, column = pixels.T + 1
    number[row, column] = np.arange(len(pixels))
    found = np.stack([number[row + down, column + right] for down, right in _AROUND], axis=1)
    there = found >= 0
    for corner, sides in _BESIDE.items():
        found[there[:, sides[0]] | there[:, sides[1]], corner] = -1
    return [[other for other in row if other >= 0] for row in found.tolist()]


def _chains(around: list[list[int]], pixels: Indices) -> list[list[int]]:
    """List the pixels of each piece between two ends or forks; a ring without one starts at its lowest pixel."""
    chains: list[list[int]] = []
    used: set[tuple[int, int]] = set()
    seen = np.zeros(len(around), dtype=bool)
    nodes = [pixel for pixel, others in enumerate(around) if len(others) not in (0, 2)]
    ends = set(nodes)
    for node in nodes:
        for following in around[node]:
            if (node, following) not in used:
                chain = _follow(around, node, following, ends)
                used |= {(chain[0], chain[1]), (chain[-1], chain[-2])}
                seen[chain] = True
                chains.append(chain)
    for start in np.argsort(-pixels[:, 0], kind="stable").tolist():
        if not seen[start] and len(around[start]) == 2:
            chain = _follow(around, start, around[start][0], {start})
            seen[chain] = True
            chains.append(chain)
    return chains


def _follow(around: list[list[int]], start: int, following: int, ends: set[int]) -> list[int]:
    """List the pixels from a start and the one that follows it to the first of the ends."""
    chain = [start, following]
    while chain[-1] not in ends:
        first, second = around[chain[-1]]
        chain.append(second if first == chain[-2] else first)
    return chain


def _is_spur(graph: Graph, arc: Arc) -> bool:
    """Return whether an end arc follows an uneven edge or leads into a corner of the ink."""
    counts = [len(graph.at[node]) for node in arc.ends]
    if min(counts) != 1 or max(counts) < 3:
        return False
    outward = arc if counts[0] > 1 else arc.away_from(arc.ends[1])
    fork, tip = float(outward.radii[0]), float(outward.radii[-1])
    if arc.length + tip < SPUR * fork + SPUR_PX:
        return True
    arcs = arc_lengths(outward.points)
    outside = float(np.interp(fork, arcs, outward.radii))
    steep = outside - tip > CORNER * (float(arcs[-1]) - fork)
    return bool(fork > CORNER_PX and steep and arcs[-1] < CORNER_LENGTH * fork)


def _merge_arcs(graph: Graph, node: int) -> None:
    """Merge the two arcs at a node into one."""
    first, second = (graph.arcs[number].away_from(node) for number in graph.at[node])
    for number in list(graph.at[node]):
        graph.drop(number)
    points = np.vstack([first.points[:0:-1], second.points])
    radii = np.concatenate([first.radii[:0:-1], second.radii])
    graph.add(Arc((first.ends[1], second.ends[1]), points, radii))


def _without_corner(arc: Arc) -> Arc:
    """Cut off the part at an arc's tip, its first point, that leads into a corner of the ink."""
    arcs = arc_lengths(arc.points)
    reach = min(float(arcs[-1]) - SPUR * float(arc.radii[-1]), CORNER_LENGTH * float(arc.radii.max()))
    start = int(np.argmax(np.where(arcs <= reach, arc.radii - CORNER * arcs, -np.inf))) if reach > 0 else 0
    if arc.radii[start] < CORNER_PX:
        return arc
    start = min(start, len(arc.points) - 2)
    return Arc(arc.ends, arc.points[start:], arc.radii[start:])


def _contract(graph: Graph, number: int) -> None:
    """Contract an arc to a node at its middle; the other arcs lead straight there from outside the ink."""
    arc = graph.arcs[number]
    keep, gone = arc.ends
    middle, radius = arc.points[len(arc.points) // 2], float(arc.radii.max())
    graph.drop(number)
    for node in (keep, gone):
        for other in set(graph.at[node]):
            graph.arcs[other] = _redirect(graph.arcs[other], node, middle, radius)
    for other in list(dict.fromkeys(graph.at[gone])):
        graph.move(other, gone, keep)
    del graph.at[gone]
    for other in [number for number in set(graph.at[keep]) if graph.arcs[number].ends == (keep, keep)]:
        if graph.arcs[other].length < 2 * CLOSE_PX + CLOSE * radius:
            graph.drop(other)


def _redirect(arc: Arc, node: int, place: Floats, radius: float) -> Arc:
    """Move each end of an arc at a node to another place (2,), px, and drop the points within a radius of it, px."""
    for end in (0, 1):
        if arc.ends[end] == node:
            outward = arc if end == 0 else arc.reversed()
            off = np.linalg.norm(outward.points - place, axis=1) > radius
            start = min(int(off.argmax()) if off.any() else len(off) - 1, len(off) - 1)
            points = np.vstack([place, outward.points[max(start, 1) :]])
            radii = np.append(outward.radii[0], outward.radii[max(start, 1) :])
            arc = Arc(outward.ends, points, radii)
            arc = arc if end == 0 else arc.reversed()
    return arc
