"""The graph that the visible branches are found in: places where wood is seen, and places between them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from treestroke.core.lift.thin_hull import ShownArea, ThinHull, most_evidence, thin_hull
from treestroke.core.types import Floats, Indices, Mask

FINE, FINE_BARE = 0.004, 0.003
"""Side of the cells in which wood is looked for, as a share of the height; those of a bare tree are finer."""
COARSE = 0.016
"""Side of the cells through which clusters are joined, as a share of the height."""
LEAST_EVIDENCE = 2.0
"""Standard deviations above chance from which a cell is wood. With 18 shots and true mattes, cells above it have 91 to
98 % of the true branches of levels 0 to 2 near, and 70 to 99 % of them are near wood (five trees)."""
SHARE_OF_MOST = 0.7
"""The same as a share of the most evidence that the shots can give, where they are few."""
GAP_COST = 6.0
"""Cost of a length where no wood is seen, relative to the thinnest wood."""
NEIGHBOURS = 1.8
"""Cells no further apart than this, in sides of a cell, are neighbours: those that share a corner."""


@dataclass(frozen=True, eq=False)
class PointGraph:
    """Places and the edges between those that are near.

    Attributes
    ----------
    points
        (n, 3) places, metres; the first is the root, the origin.
    radii
        (n,) how far each lies within the wood, metres.
    seen
        (n,) whether wood is seen there; the others join its clusters.
    edges
        (e, 2) pairs of places.
    weights
        (e,) cost of each edge.
    unit
        Side of the cells of the wood, metres.
    """

    points: Floats
    radii: Floats
    seen: Mask
    edges: Indices
    weights: Floats
    unit: float


def point_graph(wood: Sequence[ShownArea], tree: Sequence[ShownArea], fine: float) -> PointGraph:
    """Build the graph from what the shots show of the wood, and of the whole tree.

    An edge's weight is its length over the wood's radius, more where the evidence is weak: the way runs in the middle
    of thick, certain wood as long as it can. Where no wood is seen it leads through the crown's coarser cells. The
    root alone remains where no wood is seen at all.

    Source: Tan et al. 2007, section 5.1. The weight's image distance is how near the projected segment runs to the
    wood's outline, in the mean of both ends: the gradient along it, as in the paper, is high within bark as well.
    """
    hull, crown = thin_hull(wood, fine), thin_hull(tree, COARSE)
    sure = hull.evidence >= min(LEAST_EVIDENCE, SHARE_OF_MOST * most_evidence(len(wood)))
    cells = ThinHull(hull.cells[sure], hull.side, hull.evidence[sure], hull.radius[sure])
    if len(cells) == 0 or len(crown) == 0:
        return PointGraph(np.zeros((1, 3)), np.zeros(1), np.zeros(1, bool), np.zeros((0, 2), int), np.zeros(0), fine)
    first, count = 1 + len(cells), len(crown)
    points = np.concatenate([np.zeros((1, 3)), cells.middles, crown.middles])
    radii = np.concatenate([[0.0], cells.radius, np.zeros(count)])
    seen = np.arange(len(points)) < first
    fine_edges = 1 + _neighbours(cells)
    between = np.concatenate([first + _neighbours(crown), _bridges(points, first)])
    edges = np.concatenate([fine_edges, between])
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    trust = np.concatenate([[1.0], 1 / np.maximum(cells.evidence, 1.0), np.zeros(count)])
    thickness = radii[edges].mean(axis=1) / hull.side + 0.5
    cost = np.where(seen[edges].all(axis=1), trust[edges].mean(axis=1) / thickness, GAP_COST)
    return PointGraph(points, radii, seen, edges, lengths * cost, hull.side)


def _neighbours(hull: ThinHull) -> Indices:
    """List the pairs (e, 2) of neighbouring cells."""
    return np.asarray(cKDTree(hull.cells).query_pairs(NEIGHBOURS, output_type="ndarray"), dtype=np.int64)


def _bridges(points: Floats, first: int) -> Indices:
    """Join the places of the wood, those before ``first``, to the nearest of the crown's, and the root to the wood."""
    nearest = first + cKDTree(points[first:]).query(points[:first])[1]
    to_crown = np.column_stack([np.arange(first), nearest])
    near_root = 1 + np.argsort(np.linalg.norm(points[1:first], axis=1), kind="stable")[:9]
    return np.concatenate([to_crown, np.column_stack([np.zeros(len(near_root), dtype=np.int64), near_root])])
