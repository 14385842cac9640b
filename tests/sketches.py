"""Small sketches by hand, and pictures of them."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import place_at, places_along, resample
from treestroke.core.skeleton.branched import Branched
from treestroke.core.strokes import Sketch, Stroke
from treestroke.core.trace.drawing import Drawing
from treestroke.core.types import Floats

SIZE = (900, 1100)
"""Width and height; the trees on it are 1000 px high."""
TRUNK = [[450, 1050], [445, 700], [455, 400], [450, 50]]
ARMS = (
    [[446, 750], [250, 560], [120, 540]],
    [[452, 550], [600, 480], [780, 300]],
    [[300, 608], [280, 500], [210, 400]],
)


def sketch(*lines: object, widths: Sequence[float] = (), size: tuple[int, int] = SIZE, crown: object = None) -> Sketch:
    """Sketch lines, the trunk's first."""
    points = [np.array(line, dtype=float) for line in lines]
    strokes = [Stroke(one, widths[i] if i < len(widths) else None) for i, one in enumerate(points)]
    return Sketch(size, None if crown is None else Stroke(np.array(crown, dtype=float)), tuple(strokes))


def picture(drawn: Sketch, width: float = 2.0) -> NDArray[np.uint8]:
    """Draw a sketch's branches black on white, (h, w); a stroke without a width is ``width`` px wide."""
    y, x = np.mgrid[: drawn.canvas[1], : drawn.canvas[0]] + 0.5
    seen = np.full(x.shape, 255, dtype=np.uint8)
    for one in drawn.branches:
        half = (one.width or width) / 2
        (left, top), (right, low) = one.points.min(axis=0) - half - 2, one.points.max(axis=0) + half + 2
        box = slice(max(int(top), 0), int(low)), slice(max(int(left), 0), int(right))
        centres = np.stack([x[box], y[box]], axis=-1)
        gaps = places_along(one.points, centres.reshape(-1, 2))[1].reshape(centres.shape[:2])
        seen[box] = np.minimum(seen[box], np.clip(255 * (gaps - half + 0.5), 0, 255).astype(np.uint8))
    return seen


def inked(drawn: Sketch, width: float = 2.0) -> Sketch:
    """Sketch the same as a picture."""
    return Sketch(drawn.canvas, drawn.crown, (), picture(drawn, width) < 128)


def height(drawing: Drawing) -> float:
    points = drawing.tree.skeleton.points
    return float(points[0, 1] - points[:, 1].min())


def away(tree: Branched, points: Floats) -> Floats:
    """Measure from points (n, 2) to the nearest place on a tree, px."""
    return np.min([places_along(tree.skeleton.points[chain], points)[1] for chain in tree.chains()], axis=0)


def dense(lines: Sequence[Floats]) -> Floats:
    """Return the points, a pixel apart, of lines (n, 2)."""
    return np.concatenate([resample(np.asarray(line, dtype=float), 1.0) for line in lines])


def apart(tree: Branched, lines: Sequence[Floats]) -> Floats:
    """Measure from a tree's joints to the nearest place on lines, px."""
    points = tree.skeleton.points
    return np.min([places_along(np.asarray(line, dtype=float), points)[1] for line in lines], axis=0)


def middle(line: object, share: float) -> Floats:
    """Return the point (2,) at a share of a line's length."""
    points = np.array(line, dtype=float)
    return place_at(points, share * float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()))
