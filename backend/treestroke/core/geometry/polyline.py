"""Polylines: points (n, d) in order, joined by straight segments; d is 2 (px) or 3 (metres)."""

import cv2
import numpy as np

from treestroke.core.types import Floats, Indices


def arc_lengths(points: Floats) -> Floats:
    """Compute the length along a polyline (n, d) up to each of its points (n,), 0 at the first, in the points' unit."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def resample(points: Floats, step: float) -> Floats:
    """Resample a polyline (n, d), n >= 1, in equal steps of about ``step``; both ends stay. Unit: px or metres."""
    arc = arc_lengths(points)
    count = max(1, round(float(arc[-1]) / step))
    at = np.linspace(0.0, arc[-1], count + 1)
    return np.stack([np.interp(at, arc, column) for column in points.T], axis=1)


def smoothed(values: Floats, sigma: float) -> Floats:
    """Smooth values (n,) or (n, d) of any unit by a Gaussian of ``sigma`` index steps; end values are repeated."""
    if len(values) == 0:
        return values
    size = (1, 2 * int(np.ceil(4.0 * sigma)) + 1)
    columns = values.reshape(len(values), -1)
    smooth = cv2.GaussianBlur(columns, size, sigmaX=1.0, sigmaY=sigma, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(smooth, dtype=np.float64).reshape(values.shape)


def directions(points: Floats) -> Floats:
    """Compute the unit tangents (n, d) of a polyline of two points or more, by central differences."""
    tangents = np.gradient(points, axis=0)
    return np.asarray(tangents / np.maximum(np.linalg.norm(tangents, axis=1, keepdims=True), 1e-12))


def normals(points: Floats) -> Floats:
    """Compute the unit normals (n, 2) of a plane polyline: its tangents turned a quarter from x toward y."""
    tangents = directions(points)
    return np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)


def simplified(points: Floats, tolerance: float) -> Indices:
    """Return the index of the points of a polyline (n, d) that keep it within ``tolerance`` (px or metres); ends stay.

    Notes
    -----
    Douglas and Peucker 1973.
    """
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
    """Distances (n,) of points (n, d) from the segment between two points (d,), in the points' unit (px or metres)."""
    chord = end - start
    along = np.clip((points - start) @ chord / max(float(chord @ chord), 1e-12), 0.0, 1.0)
    return np.asarray(np.linalg.norm(points - start - along[:, None] * chord, axis=1))


def places_along(line: Floats, points: Floats, missing: Indices | None = None) -> tuple[Floats, Floats]:
    """Find the point of a polyline (n, d), n >= 2, that is nearest to each point (m, d).

    Segments listed in ``missing``, by the index of their first point, are ignored.

    Returns
    -------
    The lengths (m,) along the polyline at which these points lie, and their distances (m,); px or metres.
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
    """Interpolate the points (..., d) of a polyline (n, d) at lengths along it (...), px or metres."""
    known = arc_lengths(line)
    return np.stack([np.interp(arcs, known, column) for column in line.T], axis=-1)
