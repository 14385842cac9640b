"""Centre lines of the wood: shortest paths from the root that keep to the middle of the wood."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from treestroke.core.lift.point_graph import PointGraph
from treestroke.core.types import Floats, Indices

CLEARED, CLEARED_UNITS = 1.3, 2.0
"""A path stands for the places within so many of its radii and so many units of the graph."""
WITHIN = 0.9
"""A path ends on an earlier one where it comes within this share of its radius: else both run side by side in it."""
LEAST_UNITS = 6.0
"""Length of the shortest path that is kept, beyond the wood it leaves, in units of the graph."""


@dataclass(frozen=True, eq=False)
class CentreLines:
    """Paths through a graph, each of which leaves an earlier one.

    Attributes
    ----------
    paths
        Places (m,) of each, from one of the path it leaves (the root, for the first) to its end.
    parents
        (k,) index of the path that each leaves; -1 for the first.
    """

    paths: list[Indices]
    parents: Indices


def centre_lines(graph: PointGraph) -> CentreLines:
    """Find paths from the root through a graph that together stand for all places where wood is seen.

    Shortest by weight; the longest path comes first, and each clears the places around it. Places that no path reaches
    are left out. Source: TEASAR, Sato et al. 2000.
    """
    points, radii, count = graph.points, graph.radii, len(graph.points)
    both = np.concatenate([graph.edges, graph.edges[:, ::-1]])
    matrix = csr_matrix((np.concatenate([graph.weights, graph.weights]), both.T), shape=(count, count))
    cost, before = dijkstra(matrix, indices=0, return_predecessors=True)
    lengths = _lengths(points, cost, before)
    cleared, owner = np.isinf(cost) | ~graph.seen, np.full(count, -1, dtype=np.int64)
    nearest, tree = np.full(count, -1, dtype=np.int64), cKDTree(points)
    owner[0] = nearest[0] = 0
    paths, parents = list[Indices](), list[int]()
    for end in np.argsort(-lengths, kind="stable").tolist():
        if cleared[end]:
            continue
        path = [end]
        while nearest[path[-1]] < 0:
            path.append(int(before[path[-1]]))
        join = int(nearest[path[-1]])
        places = np.array([*path[:-1], join] if len(path) > 1 else [end, join])
        around = tree.query_ball_point(points[places], CLEARED * radii[places] + CLEARED_UNITS * graph.unit)
        cleared[np.concatenate(around).astype(np.int64)] = True
        if paths and lengths[end] - lengths[join] < radii[join] + LEAST_UNITS * graph.unit:
            continue
        parents.append(int(owner[join]) if paths else -1)
        owner[places[:-1]] = len(paths)
        paths.append(places[::-1])
        for place, within in zip(places, tree.query_ball_point(points[places], WITHIN * radii[places]), strict=True):
            inner = np.array([place, *within])
            nearest[inner[nearest[inner] < 0]] = place
        nearest[places] = places
    return CentreLines(paths, np.array(parents, dtype=np.int64))


def _lengths(points: Floats, cost: Floats, before: Indices) -> Floats:
    """Return the length (n,), metres, of each point's path to the root; -1 where none leads there."""
    step = np.linalg.norm(points - points[np.maximum(before, 0)], axis=1).tolist()
    lengths, parents = np.where(np.isinf(cost), -1.0, 0.0).tolist(), before.tolist()
    for point in np.argsort(cost, kind="stable").tolist():
        if parents[point] >= 0:
            lengths[point] = lengths[parents[point]] + step[point]
    return np.array(lengths)
