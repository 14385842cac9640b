"""Shortest paths from the strokes along ribbons of wood, and behind leaves from one ribbon to the next.

Their tree joins every ribbon to the strokes in the cheapest way: along wood at a low cost, across gaps at a higher
one, the more so where a gap lies aslant to the ribbon behind it, or where no leaves cover it: there a limb would be
seen.
"""

import heapq
from dataclasses import dataclass

import cv2
import numpy as np

from treestroke.core.geometry.vectors import unit
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.trace.centre_lines import neighbours
from treestroke.core.trace.ribbons import Ribbons, headings
from treestroke.core.types import Floats, Indices, Mask

ON_WOOD = 0.3
"""Cost of a step along wood, relative to a straight gap of the same length behind leaves."""
ASLANT, UNCOVERED, BACKWARD = 3.0, 4.0, 4.0
"""What a gap costs more, relative, if it lies across the ribbon behind it, if no leaves cover it, and if it leads back
along the stroke that it leaves: limbs leave a stem forward, seldom toward its root."""
LONGEST_GAP = 0.12
"""Longest gap, as a share of the tree's height."""
HEADING_PX = 12
"""Distance over which the direction of a ribbon at a gap is measured, px."""
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
    costs = np.broadcast_to(on_wood, len(pixels)).tolist()
    steps = [[(other, costs[other], 0.0) for other in others] for others in neighbours(pixels, leafy.shape)]
    for start, end, gap, cost in _gaps(network, leafy, LONGEST_GAP * height_px):
        steps[start].append((end, cost, gap))
    return _dijkstra(steps, np.flatnonzero(network.stroked).tolist())


def _gaps(network: Network, leafy: Mask, longest_px: float) -> list[tuple[int, int, float, float]]:
    """List the gaps between neighbouring pieces, in both directions: first and second pixel, length, px, and cost.

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
    forth = way / length[:, None]
    for start, end, along in ((*borders.T, forth), (*borders.T[::-1], -forth)):
        aslant = 1.0 - np.abs((along * heading[end]).sum(axis=1))
        backward = np.maximum(-(along * network.onward[start]).sum(axis=1), 0.0)
        cost = length * (1.0 + ASLANT * aslant + UNCOVERED * uncovered + BACKWARD * backward)
        order = np.lexsort([cost, piece[end], piece[start]])
        pairs = np.column_stack([piece[start], piece[end]])[order]
        best = order[np.append(True, (np.diff(pairs, axis=0) != 0).any(axis=1))]
        found += list(zip(*(values[best].tolist() for values in (start, end, length, cost)), strict=True))
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


def _dijkstra(steps: list[list[tuple[int, float, float]]], starts: list[int]) -> Paths:
    """Return the shortest paths from the starts; each pixel lists its steps: to which one, cost, and gap, px.

    By a heap, as Dijkstra 1959: importing scipy's graphs takes longer than all tracing.
    """
    cost, before, gap = [np.inf] * len(steps), [-1] * len(steps), [0.0] * len(steps)
    for start in starts:
        cost[start] = 0.0
    heap, order = [(0.0, start) for start in starts], []
    while heap:
        so_far, pixel = heapq.heappop(heap)
        if so_far > cost[pixel]:
            continue
        order.append(pixel)
        for other, step, length in steps[pixel]:
            if so_far + step < cost[other]:
                cost[other], before[other], gap[other] = so_far + step, pixel, length
                heapq.heappush(heap, (so_far + step, other))
    return Paths(np.array(order, dtype=np.int64), np.array(before, dtype=np.int64), np.array(gap))
