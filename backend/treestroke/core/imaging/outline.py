"""Outlines and the regions inside them."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats


def winding_numbers(points: Floats, height: int, width: int) -> NDArray[np.int16]:
    """Count how often a closed outline goes around each pixel's centre.

    Parameters
    ----------
    points
        (n, 2) px, closed by joining the last to the first.
    height, width
        Size of the result, px.

    Returns
    -------
    (height, width), positive where the outline turns clockwise on the screen.
    """
    start, end = points, np.roll(points, -1, axis=0)
    first = np.ceil(np.minimum(start[:, 1], end[:, 1]) - 0.5).astype(np.int64)
    last = np.ceil(np.maximum(start[:, 1], end[:, 1]) - 0.5).astype(np.int64)
    counts = last - first
    edge = np.repeat(np.arange(len(points)), counts)
    row = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + first[edge]
    slope = (end[edge, 0] - start[edge, 0]) / (end[edge, 1] - start[edge, 1])
    x = start[edge, 0] + slope * (row + 0.5 - start[edge, 1])
    column = np.clip(np.ceil(x - 0.5).astype(np.int64), 0, width)
    turn = np.where(end[edge, 1] > start[edge, 1], -1, 1).astype(np.int16)
    inside = (row >= 0) & (row < height)
    steps = np.zeros((height, width + 1), dtype=np.int16)
    row, column = row[inside], column[inside]
    np.add.at(steps, (row, column), turn[inside])
    if len(row):
        around = steps[row.min() : row.max() + 1, column.min() : column.max() + 1]
        np.cumsum(around, axis=1, dtype=np.int16, out=around)
    return steps[:, :width]


def fill_outline(points: Floats, height: int, width: int) -> NDArray[np.bool_]:
    """Fill everything that a closed outline (n, 2), px, encloses (height, width): the union, where it crosses itself.

    A pixel belongs to it if its centre does. Loops that turn against each other both count, and so does the area
    between them that cannot be left without crossing the line.
    """
    return filled_and_crossing(points, height, width)[0]


def filled_and_crossing(points: Floats, height: int, width: int) -> tuple[NDArray[np.bool_], bool]:
    """Fill a closed outline (n, 2), px, as `fill_outline` does; tell whether it crosses itself by a pixel or more."""
    winding = winding_numbers(points, height, width)
    enclosed = winding != 0
    filled = _without_holes(enclosed)
    crossing = int(winding.max()) - int(winding.min()) > 1 or not np.array_equal(filled, enclosed)
    return filled, crossing


def rings_of_mask(mask: NDArray[np.bool_]) -> list[Floats]:
    """Trace the border of a mask (h, w) as closed rings (n, 2), px, for the even-odd rule, holes included.

    The rings follow the pixels' edges to a quarter pixel and are then simplified, so that they stay within 1 px of the
    mask's border. Specks that simplify to less than a triangle are left out.

    Source: border following by Suzuki and Abe 1985, simplification by Douglas and Peucker 1973, both by OpenCV.
    """
    # At twice the size, a contour through pixel centres runs a quarter of a photo's pixel inside the edge.
    doubled = np.repeat(np.repeat(mask.astype(np.uint8), 2, axis=0), 2, axis=1)
    contours, _ = cv2.findContours(doubled, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    simple = (cv2.approxPolyDP(contour, 1.5, closed=True) for contour in contours)
    return [(ring[:, 0, :].astype(np.float64) + 0.5) / 2 for ring in simple if len(ring) >= 3]


def _without_holes(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Fill the holes of a mask (h, w)."""
    ground = cv2.copyMakeBorder((~mask).astype(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=1)
    _, outside, _, _ = cv2.floodFill(ground, None, (0, 0), 2, flags=4)
    return np.asarray(outside[1:-1, 1:-1] != 2, dtype=np.bool_)
