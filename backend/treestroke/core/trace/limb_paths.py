"""Shortest paths from the strokes along ribbons of wood, and behind leaves from one ribbon to the next.

Their tree joins every ribbon to the strokes in the cheapest way: along wood at a low cost, across gaps at a higher
one, the more so where a limb turns at a gap, or where no leaves cover it: there a limb would be seen. What would have
to turn too far, or to wind, is no limb: where lines are found among leaves such ways make nets.
"""

import heapq
import math
from collections import defaultdict
from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from treestroke.core.geometry.vectors import unit
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.trace.centre_lines import neighbours
from treestroke.core.trace.ribbons import Ribbons, headings
from treestroke.core.types import Floats, Indices, Mask

ON_WOOD = 0.3
"""Cost of a step along wood, relative to a straight gap of the same length behind leaves."""
ASLANT, UNCOVERED, BACKWARD = 3.0, 4.0, 4.0
"""What a gap costs more, relative, if it lies across the ribbon behind it (twice that if the ribbon turns back), if no
leaves cover it, and if it leads back along the way or the stroke that it leaves: limbs leave a stem forward, seldom
toward its root."""
LONGEST_GAP, LONGEST_WITH_TURNS = 0.12, 0.18
"""Longest gap, as it is and with what its turns cost added, as shares of the tree's height: a limb that leaves hide
over its length goes straight on."""
HEADING_PX = 12
"""Distance over which the direction of a ribbon or of a way at a gap is measured, px."""
WINDING = 2.0
"""Greatest length of a way from its stroke, relative to the straight distance, beyond `HEADING_PX`. (Of the wood found
in 15 synthetic trees 0.02 lies further along, where limbs cross; of that in 8 photos of dense crowns none.)"""
STROKE_PX = 2.0
"""Distance from a stroke's wood within which a ribbon is the stroke's own, px."""
_COARSE = 2
"""Side, px, of the cells in which neighbouring ribbons are found."""


@dataclass(frozen=True, eq=False)
class Network:
    """Ribbons (n pixels) together with the strokes' lines.

    Attributes
    ----------
    stroked
        (n,) which pixels belong to strokes.
    onward
        (n, 2) unit direction in which a stroke's line goes on there; 0 beside the lines.
    """

    ribbons: Ribbons
    stroked: Mask
    onward: Floats


@dataclass(frozen=True, eq=False)
class Paths:
    """The tree of shortest paths in a network of n pixels.

    Attributes
    ----------
    order
        (m,) the pixels that are reached, each after the one before it on its path.
    before
        (n,) that one; -1 at the strokes, and where nothing leads.
    gap
        (n,) length of the gap between both, px; 0 along wood.
    """

    order: Indices
    before: Indices
    gap: Floats


def join_strokes(ribbons: Ribbons, strokes: Skeleton, shape: tuple[int, int]) -> Network:
    """Draw the strokes' lines (2D, px) into the ribbons of a picture (h, w); ribbons in their wood become theirs."""
    line, drawn = np.zeros(shape, dtype=np.uint8), np.zeros((*shape, 3), dtype=np.float32)
    ends = np.floor(strokes.points).astype(np.int64).tolist()
    for joint, parent in enumerate(strokes.parents.tolist()):
        if parent >= 0:
            right, down = unit(strokes.points[joint] - strokes.points[parent], np.zeros(2)).tolist()
            cv2.line(line, ends[parent], ends[joint], 1)
            cv2.line(drawn, ends[parent], ends[joint], (float(strokes.radii[joint]), right, down))
    width, onward = drawn[..., 0].copy(), drawn[..., 1:]
    away, nearest = cv2.distanceTransformWithLabels(1 - line, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    radius = np.zeros(int(nearest.max()) + 1)
    radius[nearest[line > 0]] = width[line > 0]
    at = tuple(ribbons.pixels.T)
    own = away[at] <= np.maximum(ribbons.half_widths, radius[nearest[at]]) + STROKE_PX
    width[at] = ribbons.half_widths
    stroked = line > 0
    stroked[tuple(ribbons.pixels[own].T)] = True
    line[at] = 1
    pixels = np.argwhere(line)
    at = tuple(pixels.T)
    return Network(Ribbons(pixels, width[at].astype(np.float64)), stroked[at], onward[at].astype(np.float64))


def shortest_paths(network: Network, leafy: Mask, height_px: float, on_wood: Floats | float = ON_WOOD) -> Paths:
    """Return the shortest paths from the strokes to all ribbons; ``leafy`` (h, w) is where leaves may hide a limb.

    ``on_wood`` is what a step to a pixel (n,) of wood costs, relative to a straight gap of the same length.
    """
    pixels = network.ribbons.pixels
    gaps: dict[int, list[_Gap]] = defaultdict(list)
    for start, gap in _gaps(network, leafy, LONGEST_GAP * height_px):
        gaps[start].append(gap)
    costs = np.broadcast_to(on_wood, len(pixels)).tolist()
    return _dijkstra(network, neighbours(pixels, leafy.shape), costs, gaps, LONGEST_WITH_TURNS * height_px)


class _Gap(NamedTuple):
    """A gap to the pixel at its end: its length, px, alone and with what the turn behind it costs, and its cost."""

    end: int
    length: float
    turned: float
    cost: float


def _gaps(network: Network, leafy: Mask, longest_px: float) -> list[tuple[int, _Gap]]:
    """List the gaps between neighbouring pieces, in both directions, each with the pixel at its start.

    Pieces are neighbours where the parts of the picture that lie nearest to each of them touch; all that is stroked is
    one piece. Of the gaps between two pieces in one direction the cheapest counts.
    """
    piece, borders = _neighbouring(network, leafy.shape)
    points = network.ribbons.points
    way = points[borders[:, 1]] - points[borders[:, 0]]
    length = np.hypot(*way.T)
    near = (length <= longest_px) & (length > 0)
    borders, way, length = borders[near], way[near], length[near]
    if not len(borders):
        return []
    places = points[borders[:, 0]] + np.linspace(0.0, 1.0, 9)[1:-1, None, None] * way
    uncovered = 1.0 - sample_nearest(leafy, places, False).mean(axis=0)
    heading, found = headings(network.ribbons, HEADING_PX), []
    into = _into(network.ribbons.pixels, piece, np.unique(borders))
    at_end = np.hypot(*into.T)
    forth = way / length[:, None]
    for start, end, along in ((*borders.T, forth), (*borders.T[::-1], -forth)):
        ahead = (1.0 - at_end[end]) * np.abs((along * heading[end]).sum(axis=1)) + (along * into[end]).sum(axis=1)
        turned = length * (1.0 + ASLANT * (1.0 - ahead))
        cost = turned + length * UNCOVERED * uncovered
        order = np.lexsort([cost, piece[end], piece[start]])
        pairs = np.column_stack([piece[start], piece[end]])[order]
        best = order[np.append(True, (np.diff(pairs, axis=0) != 0).any(axis=1))]
        gaps = zip(*(values[best].tolist() for values in (end, length, turned, cost)), strict=True)
        found += list(zip(start[best].tolist(), map(_Gap._make, gaps), strict=True))
    return found


def _neighbouring(network: Network, shape: tuple[int, ...]) -> tuple[Indices, Indices]:
    """Return each pixel's piece (n,), and pairs of pixels (k, 2) of pieces that are neighbours."""
    pixels = network.ribbons.pixels
    lines = np.zeros(shape, dtype=np.uint8)
    lines[tuple(pixels.T)] = 1
    piece = cv2.connectedComponents(lines, connectivity=8)[1][tuple(pixels.T)].astype(np.int64)
    piece[network.stroked] = 0
    cells = pixels // _COARSE
    coarse = np.ones((shape[0] // _COARSE + 1, shape[1] // _COARSE + 1), dtype=np.uint8)
    coarse[tuple(cells.T)] = 0
    _, labels = cv2.distanceTransformWithLabels(coarse, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    owner = np.zeros(int(labels.max()) + 1, dtype=np.int64)
    owner[labels[tuple(cells.T)]] = np.arange(len(pixels))
    nearest = owner[labels]
    one = np.concatenate([nearest[:, :-1].ravel(), nearest[:-1].ravel()])
    other = np.concatenate([nearest[:, 1:].ravel(), nearest[1:].ravel()])
    apart = piece[one] != piece[other]
    one, other = one[apart], other[apart]
    code = np.unique(np.minimum(one, other) * len(pixels) + np.maximum(one, other))
    return piece, np.column_stack([code // len(pixels), code % len(pixels)])


def _into(pixels: Indices, piece: Indices, ends: Indices) -> Floats:
    """Return where the pieces go on from some pixels (n, 2): a unit vector from an end, 0 amid a piece and elsewhere.

    ``piece`` (n,) is each pixel's; the strokes, piece 0, are nowhere gone on with.
    """
    at = tuple((pixels - pixels.min(axis=0) + HEADING_PX).T)
    pieces = np.zeros(pixels.max(axis=0) - pixels.min(axis=0) + 2 * HEADING_PX + 1, dtype=np.int64)
    pieces[at] = piece
    side = 2 * HEADING_PX + 1
    around = sliding_window_view(pieces, (side, side))[tuple(pixels[ends].T - pixels.min(axis=0)[:, None])]
    own = ((around == piece[ends, None, None]) & (around > 0)).reshape(len(ends), -1).astype(np.float32)
    down, right = np.divmod(np.arange(side**2, dtype=np.float32), side)
    middle = own @ (np.column_stack([right, down]) - HEADING_PX) / np.maximum(own.sum(axis=1), 1.0)[:, None]
    into = np.zeros((len(pixels), 2))
    into[ends] = middle / np.maximum(np.hypot(*middle.T), HEADING_PX / 2)[:, None]
    return into


def _dijkstra(
    network: Network, wood: list[list[int]], costs: list[float], gaps: dict[int, list[_Gap]], most_px: float
) -> Paths:
    """Return the shortest paths along wood, by each pixel's neighbours and what a step to it costs, and across gaps.

    By a heap, as Dijkstra 1959: importing scipy's graphs takes longer than all tracing.
    """
    ways = _Ways(network)
    while ways.heap:
        so_far, pixel = heapq.heappop(ways.heap)
        if so_far > ways.cost[pixel]:
            continue
        ways.order.append(pixel)
        for other in wood[pixel]:
            if so_far + costs[other] < ways.cost[other]:
                ways.go(pixel, other, so_far + costs[other], 0.0)
        for gap in gaps.get(pixel, ()):
            back = BACKWARD * ways.back(pixel, gap.end)
            if gap.turned + back <= most_px and so_far + gap.cost + back < ways.cost[gap.end]:
                ways.go(pixel, gap.end, so_far + gap.cost + back, gap.length)
    return Paths(np.array(ways.order, dtype=np.int64), np.array(ways.before, dtype=np.int64), np.array(ways.gap))


class _Ways:
    """The cheapest ways to the pixels of a network that are known so far."""

    def __init__(self, network: Network) -> None:
        n = len(network.stroked)
        starts = np.flatnonzero(network.stroked).tolist()
        self.points, self.onward = network.ribbons.points.tolist(), network.onward.tolist()
        self.cost = np.where(network.stroked, 0.0, np.inf).tolist()
        self.before, self.gap, self.length, self.origin = [-1] * n, [0.0] * n, [0.0] * n, list(range(n))
        self.heap, self.order = [(0.0, start) for start in starts], list[int]()

    def go(self, pixel: int, other: int, cost: float, gap: float) -> None:
        """Go on from a pixel to another one, unless the way to it winds."""
        origin = self.origin[pixel]
        place = self.points[other]
        length = self.length[pixel] + math.dist(self.points[pixel], place)
        if length <= WINDING * math.dist(self.points[origin], place) + HEADING_PX:
            self.cost[other], self.before[other], self.gap[other] = cost, pixel, gap
            self.length[other], self.origin[other] = length, origin
            heapq.heappush(self.heap, (cost, other))

    def back(self, pixel: int, other: int) -> float:
        """Return how far another pixel lies back along the way to a pixel, or along the stroke there, px."""
        x, y = self.points[pixel]
        onward, behind = self.onward[pixel], self.before[pixel]
        if behind >= 0:
            while self.before[behind] >= 0 and math.dist(self.points[behind], (x, y)) < HEADING_PX:
                behind = self.before[behind]
            far = math.dist(self.points[behind], (x, y))
            onward = [(x - self.points[behind][0]) / far, (y - self.points[behind][1]) / far]
        to_x, to_y = self.points[other]
        return max(float(onward[0] * (x - to_x) + onward[1] * (y - to_y)), 0.0)
