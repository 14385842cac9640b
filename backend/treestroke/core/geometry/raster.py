"""A small software rasteriser: the triangle that each pixel of a picture shows."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Indices

Cut = Callable[[Indices, Floats, Floats], NDArray[np.bool_]]
"""Alpha test: called with the index (m,) of triangles, and the x and y (m,), px, of points on them; true if opaque."""

_CHUNK = 2_000
"""Triangles at a time: enough for numpy, few enough for the cache."""
_GOLDEN = 0.6180339887


@dataclass(frozen=True, eq=False)
class Planes:
    """Plane equations of k vertex attributes over t triangles: linear functions of the pixel.

    Attributes
    ----------
    origin_px
        (2, t) x and y of each triangle's first corner.
    start, along_x, along_y
        (k, t) values there, and their change per px to the right and down.
    """

    origin_px: Floats
    start: Floats
    along_x: Floats
    along_y: Floats

    def at(self, triangle: Indices, x: Floats, y: Floats) -> Floats:
        """Interpolate the attributes (k, m) at points x, y (m,), px, of the triangles with index (m,)."""
        across, down = x - self.origin_px[0].take(triangle), y - self.origin_px[1].take(triangle)
        found = np.empty((len(self.start), len(triangle)))
        for row, (start, by_x, by_y) in enumerate(zip(self.start, self.along_x, self.along_y, strict=True)):
            found[row] = start.take(triangle) + across * by_x.take(triangle) + down * by_y.take(triangle)
        return found


def planes(corners_px: Floats, values: Floats) -> Planes:
    """Fit planes through values (t, 3, k) at corners (t, 3, 2), px; constant on a triangle without area."""
    first, second = corners_px[:, 1] - corners_px[:, 0], corners_px[:, 2] - corners_px[:, 0]
    area = first[:, 0] * second[:, 1] - second[:, 0] * first[:, 1]
    inverse = np.where(np.abs(area) > 1e-9, 1.0 / np.where(area == 0.0, 1.0, area), 0.0)[:, None]
    rise, run = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
    along_x = (rise * second[:, 1:] - run * first[:, 1:]) * inverse
    along_y = (run * first[:, :1] - rise * second[:, :1]) * inverse
    columns = (np.ascontiguousarray(each.T) for each in (corners_px[:, 0], values[:, 0], along_x, along_y))
    return Planes(*columns)


def pixel_centres(pixel: Indices, width: int) -> tuple[Floats, Floats]:
    """Return the x (m,) and the y (m,), px, of the centres of pixels, by their flat index (m,) in a picture."""
    row = pixel // width  # a remainder would take five times as long
    return (pixel - row * width).astype(np.float64) + 0.5, row.astype(np.float64) + 0.5


def visible_triangles(corners_px: Floats, nearness: Floats, cut: Cut, height: int, width: int) -> Indices:
    """Find the triangle that each pixel's centre shows.

    Triangles are sorted by depth as a whole, so the hidden parts of triangles that cross each other may come out
    wrong; a preview does not show it.

    Parameters
    ----------
    corners_px
        (t, 3, 2) corners of the triangles, px.
    nearness
        (t,) greater is nearer, any unit; a triangle at minus infinity is not drawn.
    cut
        Alpha test, for textures with holes.
    height, width
        Size of the picture, px.

    Returns
    -------
    (height, width) index of the triangle, -1 where there is none.
    """
    shown = np.full(height * width, -1, dtype=np.int64)
    order = np.argsort(-nearness, kind="stable")
    order = order[nearness[order] > -np.inf]
    columns = np.ascontiguousarray(corners_px.transpose(2, 1, 0))
    for start in range(0, len(order), _CHUNK):
        triangle, pixel = _fragments(columns, order[start : start + _CHUNK], height, width)
        free = shown[pixel] < 0
        triangle, pixel = triangle[free], pixel[free]
        there = cut(triangle, *pixel_centres(pixel, width))
        # Where an index is named twice the last assignment stays: the nearest comes last.
        shown[pixel[there][::-1]] = triangle[there][::-1]
    return shown.reshape(height, width)


def covered_pixels(corners_px: Floats, cut: Cut, seen: NDArray[np.bool_]) -> None:
    """Mark in the mask ``seen`` (height, width) the pixels whose centres lie on opaque points of triangles.

    The triangles' corners (t, 3, 2) are px. They are drawn in an order that spreads them over the picture, and those
    that lie wholly on marked pixels are skipped.
    """
    height, width = seen.shape
    columns = np.ascontiguousarray(corners_px.transpose(2, 1, 0))
    low, high = np.floor(columns.min(axis=1)), np.ceil(columns.max(axis=1))
    inside = (low < [[width], [height]]).all(axis=0) & (high > 0).all(axis=0)
    (left, top), (right, bottom) = (np.clip(edge.T, 0, (width, height)).astype(np.int64).T for edge in (low, high))
    order = np.argsort(np.arange(len(corners_px)) * _GOLDEN % 1.0, kind="stable")
    order = order[inside[order]]
    while len(order):
        free = cv2.integral((~seen).astype(np.uint8))
        needed = free[bottom, right] - free[top, right] - free[bottom, left] + free[top, left] > 0
        order = order[needed[order]]
        triangle, pixel = _fragments(columns, order[:_CHUNK], height, width)
        unmarked = ~seen.ravel()[pixel]
        triangle, pixel = triangle[unmarked], pixel[unmarked]
        seen.ravel()[pixel[cut(triangle, *pixel_centres(pixel, width))]] = True
        order = order[_CHUNK:]


def _fragments(columns: Floats, chosen: Indices, height: int, width: int) -> tuple[Indices, Indices]:
    """List the pixels whose centres the chosen triangles cover, in the triangles' order: (triangle, flat pixel) index.

    ``columns`` (2, 3, t) holds x and y of each corner, px.
    """
    first, second, third = columns[1][:, chosen]
    highest, lowest = (pick(pick(first, second), third) for pick in (np.minimum, np.maximum))
    top = np.clip(np.ceil(highest - 0.5), 0, height).astype(np.int64)
    bottom = np.clip(np.ceil(lowest - 0.5), 0, height).astype(np.int64)
    which, row = _runs(top, bottom)
    triangle = chosen[which]
    left, right = _row_span(columns[:, :, triangle], row.astype(np.float64) + 0.5)
    start = np.clip(np.ceil(left - 0.5), 0, width).astype(np.int64)
    end = np.clip(np.ceil(right - 0.5), 0, width).astype(np.int64)
    line, column = _runs(start, end)
    return triangle[line], row[line] * width + column


def _row_span(columns: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Intersect triangles, x and y of each corner (2, 3, m), with the rows at y (m,): leftmost and rightmost x, px."""
    left, right = np.full(len(y), np.inf), np.full(len(y), -np.inf)
    for start, end in ((0, 1), (1, 2), (2, 0)):
        (x0, y0), (x1, y1) = columns[:, start], columns[:, end]
        with np.errstate(divide="ignore", invalid="ignore"):
            x = x0 + (y - y0) * ((x1 - x0) / (y1 - y0))
        crossed = (y0 <= y) != (y1 <= y)
        np.minimum(left, np.where(crossed, x, np.inf), out=left)
        np.maximum(right, np.where(crossed, x, -np.inf), out=right)
    return left, right


def _runs(start: Indices, end: Indices) -> tuple[Indices, Indices]:
    """Enumerate half-open ranges one after the other: the range (m,) and the number (m,) in it of each entry."""
    lengths = np.maximum(end - start, 0)
    which = np.repeat(np.arange(len(start)), lengths)
    return which, np.arange(len(which)) + (start - np.cumsum(lengths) + lengths).take(which)
