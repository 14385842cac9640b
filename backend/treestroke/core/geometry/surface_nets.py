"""The surface of filled cells as a smooth, closed mesh of few triangles."""

import numpy as np
from scipy import ndimage

from treestroke.core.geometry.clumped_crown import Cells
from treestroke.core.types import Floats, Indices, Mask

LEVEL = 0.5
"""Share of its surroundings that is filled from which on a place is inside; less where the volume would shrink."""
SMOOTHING = 0.7
"""Standard deviation, in places, over which what is filled is smoothed."""
FINEST = 48
"""Most blocks along the longest side of the grid that the surface is laid around."""
FURTHEST = 0.3
"""Most places by which the surface is moved to hold the cells' volume."""
WIDER = 1.08
"""Factor by which places are further apart where there are too many triangles."""


def surface(cells: Cells, most_triangles: int) -> tuple[Floats, Indices]:
    """Return the surface of filled cells: points (n, 3), in the cells' unit, and triangles (m, 3), at most so many.

    It is closed, and triangles run counterclockwise from outside. It keeps to the cells' volume but for parts that are
    small beside the triangles.

    Source: Gibson 1998, "Constrained Elastic Surface Nets", in the plain form: a point for each cube of a grid that the
    surface crosses, in the mean of where it crosses the cube's edges.
    """
    together = -(-max(cells.filled.shape) // FINEST)
    blocks, side, width = _blocks(cells.filled, together), cells.side * together, 1.0
    while True:
        values = _smoothed(blocks, width)
        count = max(round(float(blocks.sum()) / width**3), 1)
        level = min(LEVEL, float(np.sort(values, axis=None)[-count]))
        points, triangles = _net(values, level)
        if len(triangles) <= most_triangles:
            points = _of_volume(points, triangles, float(blocks.sum()) / width**3)
            return cells.corner + side * width * (points - 0.5), triangles
        width *= WIDER


def _blocks(filled: Mask, together: int) -> Floats:
    """Return the share of each block of so many cells, a side, that is filled."""
    padded = np.pad(filled, [(0, -size % together) for size in filled.shape])
    x, y, z = (size // together for size in padded.shape)
    blocks = padded.reshape(x, together, y, together, z, together)
    return np.asarray(blocks.mean(axis=(1, 3, 5)))


def _smoothed(filled: Floats, width: float) -> Floats:
    """Return how much of the surroundings is filled at places ``width`` cells apart, (x, y, z), the outermost empty.

    The first place lies half a width before the first cell.
    """
    rim = int(np.ceil(2 * width))
    soft = ndimage.gaussian_filter(np.pad(filled, rim), SMOOTHING * width)
    counts = [int(np.ceil(size / width)) + 2 for size in filled.shape]
    at = [width * (np.arange(count) - 0.5) - 0.5 + rim for count in counts]
    found = ndimage.map_coordinates(soft, np.stack(np.meshgrid(*at, indexing="ij")), order=1)
    return np.pad(found[1:-1, 1:-1, 1:-1], 1)


def _net(values: Floats, level: float) -> tuple[Floats, Indices]:
    """Lay a net around the values (x, y, z) of at least ``level``: points (n, 3) in places, triangles (m, 3)."""
    cubes = np.array(values.shape) - 1
    total, count, quads = np.zeros((*cubes, 3)), np.zeros(cubes), []
    for axis, steps in enumerate(cubes.tolist()):
        start, end = (np.take(values, np.arange(steps) + ahead, axis) for ahead in (0, 1))
        edges = np.argwhere((start >= level) != (end >= level))
        one, other = start[tuple(edges.T)], end[tuple(edges.T)]
        places = edges.astype(np.float64)
        places[:, axis] += (level - one) / (other - one)
        around = _around(edges, axis)
        for cube in around.transpose(1, 2, 0):
            np.add.at(total, tuple(cube), places)
            np.add.at(count, tuple(cube), 1.0)
        quads.append(np.where((one >= level)[:, None, None], around, around[:, ::-1]))
    number = np.cumsum(count.ravel() > 0).reshape(count.shape) - 1
    corners = number[tuple(np.concatenate(quads).transpose(2, 0, 1))]
    crossed = count > 0
    return total[crossed] / count[crossed][:, None], np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])


def _of_volume(points: Floats, triangles: Indices, volume: float) -> Floats:
    """Move points (n, 3) outward until the mesh holds the volume: between points that touch a ball it holds less."""
    one, two, three = points[triangles].transpose(1, 0, 2)
    areas = np.cross(two - one, three - one) / 2
    outward = np.zeros_like(points)
    np.add.at(outward, triangles.ravel(), np.repeat(areas, 3, axis=0))
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-12)
    missing, area = volume - float((one * areas).sum()) / 3, float(np.linalg.norm(areas, axis=1).sum())
    return np.asarray(points + float(np.clip(missing / max(area, 1e-12), -FURTHEST, FURTHEST)) * outward)


def _around(edges: Indices, axis: int) -> Indices:
    """Return the four cubes (n, 4, 3) around edges (n, 3) along an axis, counterclockwise as seen from its end."""
    one, other = np.eye(3, dtype=np.int64)[[(axis + 1) % 3, (axis + 2) % 3]]
    return np.asarray(edges[:, None] - np.stack([one + other, other, 0 * one, one]))
