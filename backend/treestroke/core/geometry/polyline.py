"""Chains of points."""

import cv2
import numpy as np

from treestroke.core.types import Floats, Indices


def arc_lengths(points: Floats) -> Floats:
    """Length along a chain (n, d) up to each of its points (n,), 0 at the first."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def resample(points: Floats, step: float) -> Floats:
    """Walk a chain (n, d), n >= 1, in equal steps of about ``step``; both ends stay."""
    arc = arc_lengths(points)
    count = max(1, round(float(arc[-1]) / step))
    at = np.linspace(0.0, arc[-1], count + 1)
    return np.stack([np.interp(at, arc, column) for column in points.T], axis=1)


def smoothed(values: Floats, sigma: float) -> Floats:
    """Smooth values (n,) or (n, d) along a chain by a Gaussian of ``sigma`` places; the ends go on as they are."""
    if len(values) == 0:
        return values
    size = (1, 2 * int(np.ceil(4.0 * sigma)) + 1)
    columns = values.reshape(len(values), -1)
    smooth = cv2.GaussianBlur(columns, size, sigmaX=1.0, sigmaY=sigma, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(smooth, dtype=np.float64).reshape(values.shape)


def directions(points: Floats) -> Floats:
    """Give the unit tangents (n, d) of a chain of two points or more, by central differences."""
    tangents = np.gradient(points, axis=0)
    return np.asarray(tangents / np.maximum(np.linalg.norm(tangents, axis=1, keepdims=True), 1e-12))


def normals(points: Floats) -> Floats:
    """Give the unit normals (n, 2) of a chain in the plane: its tangents turned a quarter from x toward y."""
    tangents = directions(points)
    return np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)


def simplified(points: Floats, tolerance: float) -> Indices:
    """Choose the points of a chain (n, d) that keep it within ``tolerance`` (Douglas and Peucker 1973); ends stay."""
    kept = np.zeros(len(points), dtype=bool)
    kept[[0, -1]] = True
    spans = [(0, len(points) - 1)]
    while spans:
        start, end = spans.pop()
        if end - start < 2:
            continue
        away = distances_to_segment(points[start + 1 : end], points[start], points[end])
        furthest = int(away.argmax())
        if away[furthest] > tolerance:
            middle = start + 1 + furthest
            kept[middle] = True
            spans += [(start, middle), (middle, end)]
    return np.flatnonzero(kept)


def distances_to_segment(points: Floats, start: Floats, end: Floats) -> Floats:
    """Distance of points (n, d) from the straight piece between two points (n,)."""
    way = end - start
    along = np.clip((points - start) @ way / max(float(way @ way), 1e-12), 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - start - along[:, None] * way, axis=1))


def places_along(line: Floats, points: Floats, missing: Indices | None = None) -> tuple[Floats, Floats]:
    """Find how far along a chain (n, d), n >= 2, the place nearest to each point (m, d) lies, and their gap (m,).

    Of pieces that are ``missing``, named by the point where they begin, no place is nearest.
    """
    start, along = line[:-1], np.diff(line, axis=0)
    square = np.maximum((along**2).sum(axis=1), 1e-12)
    share = np.clip((points @ along.T - (start * along).sum(axis=1)) / square, 0.0, 1.0)
    away = sum((points[:, None, axis] - start[:, axis] - share * along[:, axis]) ** 2 for axis in range(line.shape[1]))
    away = np.asarray(away)
    if missing is not None:
        away[:, missing] = np.inf
    rows, best = np.arange(len(points)), away.argmin(axis=1)
    gaps = np.sqrt(away[rows, best])
    return arc_lengths(line)[best] + share[rows, best] * np.sqrt(square[best]), gaps


def place_at(line: Floats, arcs: Floats | float) -> Floats:
    """Give the points (..., d) of a chain (n, d) at lengths along it (...)."""
    known = arc_lengths(line)
    return np.stack([np.interp(arcs, known, column) for column in line.T], axis=-1)
