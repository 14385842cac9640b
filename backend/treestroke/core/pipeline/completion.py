"""A crown that the photo's edge cuts is completed beyond it, by what the photo shows of the tree itself.

How far it reaches is read off the crown's own shape. Beyond the left and right edge it is mirrored about its trunk,
beyond the upper edge about the edge itself. What is added is moved a little, so that nobody sees the mirror.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import arc_lengths, place_at, smoothed
from treestroke.core.pipeline.working_copy import WorkingCopy
from treestroke.core.segment.foliage import Foliage
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.trace.tracing import Traced
from treestroke.core.types import Floats, Indices, Mask

SIDES = ("left", "right", "top")
"""Edges beyond which a crown is completed; below the lower one is ground."""
BAND_PX = 3
"""Foliage this near the photo's edge, px of the working copy, touches it."""
ONE_CUT = 0.15
"""Gaps between places where the crown touches the edge belong to the same cut up to this share of the crown's size."""
LEAST_REACH = 0.04
"""Least share of the crown's size that is added; less is left as it is. (Of 135 cut crowns of synthetic trees, those
that would be completed by less lose as much as they gain.)"""
MOST_REACH = 1.0
"""Greatest reach beyond the edge, as a share of the crown's visible depth behind it."""
ELLIPSE_SHARE = 0.3
"""Weight of the axis of the ellipse that the visible crown suggests; the rest is the trunk's. (Judged on the masks of
19 trees without 10, 20 and 35 % of their width: 0.3 to 0.5 are alike, either axis alone is worse.)"""
STEADY = 0.02
"""Standard deviation, as a share of the crown's size, over which its far outline is averaged."""
DISPLACEMENT, WAVE = 0.04, 0.3
"""How far what is added is moved along the edge, and over what length that changes, as shares of the crown's size."""


@dataclass(frozen=True, eq=False)
class Completed:
    """What was read of a photo, on a canvas that is larger than it; ``sides`` are the edges that the canvas passes."""

    working: WorkingCopy
    foliage: Foliage
    traced: Traced
    sides: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class _Canvas:
    """A picture that goes on beyond the photo's edges.

    Attributes
    ----------
    source
        (h, w) index of the photo's pixel that is repeated at each.
    tree
        (h, w) where the crown may be: all of the photo, and what was added to the crown.
    corner
        (x, y) of the photo, px.
    sides
        Edges that were passed.
    """

    source: Indices
    tree: Mask
    corner: tuple[int, int]
    sides: tuple[str, ...]

    def shows(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return values of the photo's pixels (h, w, ...) as the canvas repeats them."""
        return np.asarray(values.reshape(-1, *values.shape[2:])[self.source])

    def bears(self, mask: Mask) -> Mask:
        """Return a mask of the photo (h, w) as the canvas repeats it in the crown."""
        return np.asarray(self.shows(mask) & self.tree)

    def holds(self, mask: Mask) -> Mask:
        """Return a mask of the photo (h, w) that is not repeated."""
        (x, y), (height, width) = self.corner, mask.shape
        whole = np.zeros(self.source.shape, dtype=np.bool_)
        whole[y : y + height, x : x + width] = mask
        return whole


@dataclass(frozen=True, eq=False)
class _Cut:
    """A crown as an edge cuts it, turned so that the edge is on the left and rows run along it.

    Attributes
    ----------
    crown
        (h, w) its mask.
    far
        (h,) how far from the edge it ends.
    start, end
        The rows between which the edge cuts it.
    size
        The number of rows that it has.
    whole
        Whether the photo shows its other side.
    """

    crown: Mask
    far: Floats
    start: int
    end: int
    size: int
    whole: bool

    @property
    def depth(self) -> float:
        """Depth of the visible crown behind the edge, px."""
        return float(self.far.max())

    @property
    def chord(self) -> float:
        """Length of the cut relative to the crown's, 0 to 1."""
        return min((self.end - self.start) / self.size, 0.99)


def completed(working: WorkingCopy, foliage: Foliage, traced: Traced, crown: Mask, pointed: bool) -> Completed | None:
    """Complete what the photo's edges cut off of a crown (h, w), the closed foliage; None where they cut nothing.

    The top of a ``pointed`` tree, such as a fir, is completed to a point, any other to a dome.
    """
    canvas = _canvas(crown, _axis(working), pointed)
    if not canvas.sides:
        return None
    shift = np.array(canvas.corner, dtype=np.float64)
    wood = traced.skeleton
    return Completed(
        working.on_canvas(np.asarray(canvas.shows(working.photo), dtype=np.uint8), canvas.corner),
        replace(
            foliage,
            mask=canvas.bears(foliage.mask),
            alpha=np.where(canvas.tree, canvas.shows(foliage.alpha), np.float32(0)),
            pure=canvas.bears(foliage.pure),
            region=canvas.bears(foliage.region),
        ),
        replace(
            traced,
            skeleton=Skeleton(wood.points + shift, wood.radii, wood.parents),
            wood=canvas.holds(traced.wood),
        ),
        canvas.sides,
    )


def touches_edge(mask: Mask) -> bool:
    """Tell whether a mask (h, w) touches an edge beyond which a crown is completed; closed gaps do not change that."""
    return bool(mask[:BAND_PX].any() or mask[:, :BAND_PX].any() or mask[:, -BAND_PX:].any())


def _axis(working: WorkingCopy) -> float:
    """Return the trunk's mean column, px."""
    trunk = working.strokes.branches[0].points
    return float(place_at(trunk, np.linspace(0.0, arc_lengths(trunk)[-1], 50))[:, 0].mean())


def _canvas(crown: Mask, axis: float, pointed: bool) -> _Canvas:
    """Return the canvas on which a crown (h, w) about an axis, px, is whole."""
    source = np.arange(crown.size).reshape(crown.shape)
    canvas = _Canvas(source, np.ones_like(crown), (0, 0), ())
    for side in SIDES:
        turned = _TURNS[side]
        cut = _cut(turned(canvas.bears(crown)))
        if cut is None:
            continue
        place = {"left": canvas.corner[0] + axis, "right": canvas.source.shape[1] - canvas.corner[0] - axis}.get(side)
        middle = None if place is None or not cut.whole else _middle(cut, place)
        reach = _reach(cut, middle, pointed and side == "top")
        if reach.max() < max(LEAST_REACH * cut.size, 2.0):
            continue
        added, added_tree = _margin(cut, reach, middle, turned(canvas.source))
        x, y = canvas.corner
        corner = {"left": (x + added.shape[1], y), "right": (x, y), "top": (x, y + added.shape[1])}[side]
        source, tree = (
            np.ascontiguousarray(turned(np.hstack([beyond, turned(seen)])))
            for beyond, seen in ((added, canvas.source), (added_tree, canvas.tree))
        )
        canvas = _Canvas(source, tree, corner, (*canvas.sides, side))
    return canvas


_TURNS: dict[str, Callable[[NDArray[Any]], NDArray[Any]]] = {
    "left": lambda values: values,
    "right": lambda values: values[:, ::-1],
    "top": lambda values: values.T,
}
"""How a picture is turned so that an edge is on the left; doing it again turns it back."""


def _cut(crown: Mask) -> _Cut | None:
    """Find where the left edge cuts a crown (h, w); None where it does not."""
    rows = np.flatnonzero(crown.any(axis=1))
    touching = np.flatnonzero(crown[:, :BAND_PX].any(axis=1))
    if len(touching) == 0:
        return None
    size = int(rows[-1] - rows[0] + 1)
    pieces = np.split(touching, np.flatnonzero(np.diff(touching) > max(ONE_CUT * size, 2.0)) + 1)
    longest = max(pieces, key=lambda piece: int(piece[-1] - piece[0]))
    width = crown.shape[1]
    far = np.interp(np.arange(len(crown)), rows, width - crown[rows, ::-1].argmax(axis=1))
    whole = bool(far.max() <= width - BAND_PX)
    return _Cut(crown, smoothed(far, STEADY * size), int(longest[0]), int(longest[-1]) + 1, size, whole)


def _middle(cut: _Cut, trunk: float) -> float:
    """Return the distance from the edge of the axis, px, about which a crown is mirrored.

    A crown whose outline is an ellipse has its axis where the cut's length tells; the trunk tells it, too.
    """
    ellipse = (cut.depth - _dome(cut)) / 2
    return max(ELLIPSE_SHARE * ellipse + (1 - ELLIPSE_SHARE) * trunk, 1.0)


def _dome(cut: _Cut) -> float:
    """Return how far a crown reaches beyond the edge if its outline is an ellipse, px."""
    half = np.sqrt(1 - cut.chord**2)
    if cut.whole:
        return float(cut.depth * (1 - half) / (1 + half))
    return float(cut.depth / 2 * (1 / half - 1))


def _point(cut: _Cut) -> float:
    """Return how far a crown reaches beyond the edge if it narrows to a point, px."""
    widest = float(np.argmax(cut.crown.sum(axis=0)))
    return widest * cut.chord / (1 - cut.chord)


def _reach(cut: _Cut, middle: float | None, pointed: bool) -> Floats:
    """Return how far the crown goes on beyond the edge, px, in each row (h,): an ellipse, a top as a parabola."""
    along = (np.arange(len(cut.crown)) + 0.5 - cut.start) / (cut.end - cut.start)
    inward = 1 - np.abs(2 * np.clip(along, 0.0, 1.0) - 1)
    parabola, chord_px = inward * (2 - inward), float(cut.end - cut.start)
    if middle is None:
        furthest = min(_point(cut), chord_px) if pointed else min(_dome(cut), chord_px / 2)
        return np.asarray(min(furthest, MOST_REACH * cut.depth) * (inward if pointed else parabola))
    furthest = min(max(cut.depth - 2 * middle, 0.0), MOST_REACH * cut.depth)
    return np.asarray(np.minimum(np.maximum(cut.far - 2 * middle, 0.0), furthest * np.sqrt(parabola)))


def _margin(cut: _Cut, reach: Floats, middle: float | None, source: Indices) -> tuple[Indices, Mask]:
    """Return the source (h, m) of the pixels beyond the edge, and where among them the crown may be.

    Without a ``middle`` the crown is mirrored at the edge.
    """
    height, width = source.shape
    count = int(np.ceil(reach.max())) + BAND_PX
    away = np.arange(count, 0, -1) - 0.5
    if middle is None:
        columns = np.broadcast_to(away, (height, count))
    else:
        stretch = np.maximum(cut.far - middle, 1.0) / (middle + reach)
        columns = middle + (middle + away) * stretch[:, None]
    rows = np.arange(height)[:, None] + _waves((height, count), cut.size) * np.minimum(away / (WAVE * cut.size), 1.0)
    row = np.clip(np.floor(rows), 0, height - 1).astype(np.int64)
    column = np.clip(np.floor(columns), 0, width - 1).astype(np.int64)
    return source[row, column], np.asarray(away <= reach[:, None])


def _waves(shape: tuple[int, int], size: int) -> Floats:
    """Return by how much each pixel (h, w) of a margin is moved, px; ``size`` is the crown's."""
    coarse = tuple(2 + round(side / (WAVE * size)) for side in shape)
    waves = cv2.resize(np.random.default_rng(0).standard_normal(coarse), shape[::-1], interpolation=cv2.INTER_CUBIC)
    return np.asarray(DISPLACEMENT * size * waves, dtype=np.float64)
