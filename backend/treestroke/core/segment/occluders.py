"""Poles and wires before a crown: found where they go on beside it, followed into it, and painted over.

They are stripes with straight, parallel sides, of one width and one colour. Beside the crown they stand out; from there
their colour tells how far they go on before it. What was painted over is then neither a hole in the crown nor a colour
of leaves or wood.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import normals, resample
from treestroke.core.imaging.outline import fill_outline
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.types import Floats, Mask, Picture

AROUND = 0.4
"""How far beside a crown poles are looked for, as a share of its size: the longer side of its box."""
SHORTEST, THICKEST = 0.06, 0.05
"""Least length of a side that is seen beside the crown, and greatest width, as shares of the crown's size."""
MOST = 16
"""Number of stripes that are followed, the longest: a house behind the tree has many."""
PARALLEL_RAD = 0.035
"""Greatest angle between the two sides of a stripe."""
STRAY = 0.02
"""How far a wire sags away from the straight line, as a share of the crown's size."""
STRAIGHT = 0.05
"""Greatest mean distance of a stripe's middle from an arc, as a share of its width, besides half a pixel."""
ON, FOLLOWED, STEM = 0.02, 0.3, 0.06
"""A pole is a branch if a stroke comes this near (share of the crown's size) to more than this share of it, or if it
ends this near a stroke: a limb, or a stem beside the trunk."""
NOISE = 12.0
"""Distance of colours, steps of 255, up to which they count as the same, besides what the stripe itself varies."""
WINDOW = 0.06
"""Length over which places along a stripe are counted, as a share of the crown's size."""
LIKE, LEAST = 0.65, 0.1
"""Least share of the places in a window that have the stripe's colour for it to be seen there, and least length that is
seen before the crown, as a share of the crown's size."""
SAG, TURN_RAD = 0.1, 0.25
"""Greatest sag of a wire, as a share of its length, and angle by which it turns."""
BOTH = 0.4
"""Least share of the places seen before the crown at which each side differs from the stripe."""
CORE = 7
"""Number of places across a stripe whose colours are compared."""
ASIDE, UNLIKE = 2.0, 1e3
"""Cost of a step aside along a stripe, in steps of 255, and a cost above that of any colour."""
MARGIN_PX = 1.5
"""What is painted over beside a stripe's sides, px: pixels that it shares with what is behind."""


@dataclass(frozen=True, eq=False)
class Pole:
    """A pole or wire: its middle (n, 2), px, and its width with the blurred sides, px."""

    middle: Floats
    width: float


@dataclass(frozen=True, eq=False)
class _Stripe:
    """A stripe beside the crown: the ends of its middle (2, 2) and its width, px."""

    ends: Floats
    width: float

    @property
    def along(self) -> Floats:
        """Unit vector (2,) of its direction."""
        way = self.ends[1] - self.ends[0]
        return np.asarray(way / max(float(np.hypot(*way)), 1e-9))


@dataclass(frozen=True, eq=False)
class _Course:
    """Where a stripe may go on: places (n, 2), px, a step apart, and which of them (n,) show the stripe itself."""

    places: Floats
    own: Mask
    width: float
    step: float


def find_poles(photo: Picture, crown_px: Floats, strokes_px: Sequence[Floats]) -> tuple[Pole, ...]:
    """Find the poles and wires that pass before a crown (n, 2), px, in a photo (h, w, 3), sRGB.

    What a branch stroke (m, 2), px, follows is none.
    """
    crown, size = fill_outline(crown_px, *photo.shape[:2]), _size(crown_px)
    stripes = _stripes(photo, crown, crown_px, size)
    found: list[Pole] = []
    for stripe in stripes:
        middle = stripe.ends.mean(axis=0)
        known = any(_is_near(middle, pole.middle, pole.width / 2) for pole in found)
        if known or any(_is_near(middle, stroke, ON * size) for stroke in strokes_px):
            continue
        pole = _followed(photo, crown, _course(stripe, _partner(stripe, stripes, size), size), size)
        if pole is not None and not is_branch(pole, crown_px, strokes_px):
            found.append(pole)
    return tuple(found)


def is_branch(pole: Pole, crown_px: Floats, strokes_px: Sequence[Floats]) -> bool:
    """Return whether a pole is a branch: a branch stroke (m, 2) follows it or meets its end; the crown is (n, 2)."""
    middle, size = pole.middle, _size(crown_px)
    ends, along = middle[[0, -1]], middle[:: max(1, len(middle) // 20)]
    return any(
        any(_is_near(end, stroke, STEM * size) for end in ends)
        or np.mean([_is_near(place, stroke, ON * size) for place in along]) > FOLLOWED
        for stroke in strokes_px
    )


def painted_over(photo: Picture, poles: Sequence[Pole]) -> Picture:
    """Return a photo (h, w, 3) with each pole painted over by what is beside it, mirrored at its sides."""
    painted = photo.copy()
    for _ in range(2):  # what is beside one pole may be another one
        for pole in poles:
            _paint_over(painted, pole)
    return painted


def _paint_over(photo: Picture, pole: Pole) -> None:
    """Paint over one pole in a photo (h, w, 3)."""
    middle = resample(pole.middle, 0.5)
    along = np.gradient(middle, axis=0)
    along /= np.maximum(np.hypot(*along.T), 1e-9)[:, None]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    offsets = np.arange(-pole.width / 2, pole.width / 2 + 0.25, 0.5)
    source = np.where(offsets < 0, -1, 1) * pole.width - offsets
    at, beside = (middle[:, None] + step[:, None] * across[:, None] for step in (offsets, source))
    height, width = photo.shape[:2]
    column, row = np.floor(at).astype(np.int64).transpose(2, 0, 1)
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    from_column, from_row = np.floor(beside).astype(np.int64).transpose(2, 0, 1)
    colours = photo[np.clip(from_row, 0, height - 1), np.clip(from_column, 0, width - 1)]
    photo[row[inside], column[inside]] = colours[inside]


def _stripes(photo: Picture, crown: Mask, crown_px: Floats, size: float) -> list[_Stripe]:
    """Return the stripes beside a crown, the widest first."""
    corner = np.maximum(np.floor(crown_px.min(axis=0) - AROUND * size), 0).astype(int)
    end = np.ceil(crown_px.max(axis=0) + AROUND * size).astype(int)
    grey = cv2.cvtColor(photo[corner[1] : end[1], corner[0] : end[0]], cv2.COLOR_RGB2GRAY)
    detector = cv2.ximgproc.createFastLineDetector(max(8, int(SHORTEST * size)), 1.5, 40.0, 40.0, 3, True)
    lines: Any = detector.detect(grey)  # None where there are none
    found = np.zeros((0, 2, 2)) if lines is None else np.asarray(lines, dtype=np.float64).reshape(-1, 2, 2)
    sides = _beside(found + corner + 0.5, crown, SHORTEST * size)
    stripes = [stripe for first in range(len(sides)) for stripe in _pairs(sides, first, THICKEST * size)]
    longest = sorted(stripes, key=lambda stripe: -float(np.hypot(*(stripe.ends[1] - stripe.ends[0]))))[:MOST]
    return sorted(longest, key=lambda stripe: -stripe.width)


def _beside(sides: Floats, crown: Mask, shortest: float) -> Floats:
    """Return the longest part outside the crown (h, w) of each of the sides (n, 2, 2), if it is long enough."""
    parts = []
    shares = np.linspace(0.0, 1.0, 65)
    for start, end in sides:
        outside = ~sample_nearest(crown, start + shares[:, None] * (end - start), False)
        changes = np.flatnonzero(np.diff(np.concatenate([[False], outside, [False]]).astype(np.int8)))
        runs = changes.reshape(-1, 2)
        if len(runs) == 0:
            continue
        first, after = runs[(runs[:, 1] - runs[:, 0]).argmax()]
        part = start + shares[[first, after - 1], None] * (end - start)
        if np.hypot(*(part[1] - part[0])) >= shortest:
            parts.append(part)
    return np.array(parts).reshape(-1, 2, 2)


def _pairs(sides: Floats, first: int, widest: float) -> list[_Stripe]:
    """Return the stripes between a side and later ones among sides (n, 2, 2).

    The detector directs sides by where the brighter pixels are: both sides of a stripe run against each other.
    """
    start, end = sides[first]
    length = float(np.hypot(*(end - start)))
    along = (end - start) / max(length, 1e-9)
    across = np.array([-along[1], along[0]])
    others = sides[first + 1 :]
    ways = others[:, 1] - others[:, 0]
    against = -(ways @ along) / np.maximum(np.hypot(*ways.T), 1e-9) > np.cos(PARALLEL_RAD)
    places = np.sort((others - start) @ along, axis=1)
    low, high = np.maximum(places[:, 0], 0.0), np.minimum(places[:, 1], length)
    gaps = (others.mean(axis=1) - start) @ across
    shared = (high - low) >= 0.5 * np.minimum(length, places[:, 1] - places[:, 0])
    fits = np.flatnonzero(against & shared & (np.abs(gaps) <= widest))
    ends = [start + np.array([[low[at]], [high[at]]]) * along + gaps[at] / 2 * across for at in fits]
    return [_Stripe(end, abs(float(gaps[at]))) for at, end in zip(fits, ends, strict=True)]


def _partner(stripe: _Stripe, others: Sequence[_Stripe], size: float) -> _Stripe | None:
    """Return the stripe furthest away that lies on one flat arc with a stripe; None without one."""
    best, furthest = None, 0.5 * size
    for other in others:
        x, y = _seen_along(stripe, other.ends)
        away = float(np.abs(x).max())
        alike = 0.5 * stripe.width - 1 <= other.width <= 2 * stripe.width + 1
        if away <= furthest or not alike or abs(float(stripe.along @ other.along)) < np.cos(TURN_RAD):
            continue
        own = _seen_along(stripe, stripe.ends)
        arc = np.polyfit(np.append(own[0], x), np.append(own[1], y), 2)
        off = np.abs(np.polyval(arc, np.append(own[0], x)) - np.append(own[1], y)).max()
        if off <= max(1.5, 0.3 * stripe.width) and abs(arc[0]) * away**2 / 4 <= SAG * away:
            best, furthest = other, away
    return best


def _seen_along(stripe: _Stripe, places: Floats) -> tuple[Floats, Floats]:
    """Return how far along a stripe from its middle, and how far aside of it, places (n, 2) lie, px."""
    from_middle = places - stripe.ends.mean(axis=0)
    along = stripe.along
    return from_middle @ along, from_middle @ np.array([-along[1], along[0]])


def _course(stripe: _Stripe, partner: _Stripe | None, size: float) -> _Course:
    """Return the places along a stripe, and on through its partner."""
    step = max(0.5 * stripe.width, size / 300)
    own = _seen_along(stripe, stripe.ends)
    x, y = own
    if partner is not None:
        more = _seen_along(stripe, partner.ends)
        x, y = np.append(x, more[0]), np.append(y, more[1])
    arc = np.polyfit(x, y, 1 if partner is None else 2)
    places = np.arange(x.min() - 1.8 * size, x.max() + 1.8 * size, step)
    along = stripe.along
    aside = np.polyval(arc, np.clip(places, x.min(), x.max())) if partner is not None else np.polyval(arc, places)
    line = stripe.ends.mean(axis=0) + places[:, None] * along + aside[:, None] * np.array([-along[1], along[0]])
    return _Course(line, (places >= own[0].min()) & (places <= own[0].max()), stripe.width, step)


def _size(crown_px: Floats) -> float:
    """Return the longer side of a crown's box, px."""
    return float(np.ptp(crown_px, axis=0).max())


def _is_near(place: Floats, line: Floats, reach: float) -> bool:
    """Return whether a place (2,) lies within ``reach`` of a line (n, 2), px."""
    return float(np.hypot(*(resample(line, max(reach / 2, 0.5)) - place).T).min()) <= reach


def _followed(photo: Picture, crown: Mask, course: _Course, size: float) -> Pole | None:
    """Follow a course through the crown (h, w); None where no stripe passes before it."""
    on_photo = ((course.places >= 0) & (course.places < photo.shape[1::-1])).all(axis=1)
    places, own, width = course.places[on_photo], course.own[on_photo], course.width
    reach = int(np.ceil(STRAY * size + 1))
    room = reach + int(1.5 * width) + 2
    offsets = np.arange(-room, room + 1)
    across = normals(places)
    colours = sample_nearest(photo, places[:, None] + offsets[:, None] * across[:, None], 0).astype(np.float32)
    apart, usual = _unlikeness(colours, own, offsets, width)
    path = _cheapest(apart, np.abs(offsets) <= reach)
    like, beside = _likeness(apart, path, width, 2 * usual + NOISE)
    window = max(3, int(WINDOW * size / course.step) | 1)
    flags = np.column_stack([like & beside.any(axis=1), like & beside[:, 0], like & beside[:, 1]])
    counted = cv2.blur(flags.astype(np.float32), (1, window))
    before_crown = sample_nearest(crown, places, False)
    seen = _run((counted[:, 0] > LIKE) | before_crown, int(np.flatnonzero(own).mean())) & (counted[:, 0] > LIKE)
    inside = seen & before_crown
    if inside.sum() * course.step < LEAST * size or counted[inside, 1:].mean(axis=0).min() < BOTH:
        return None
    if not _is_arc(places[seen] + offsets[path[seen]][:, None] * across[seen], width):
        return None
    kept = slice(*(np.flatnonzero(seen)[[0, -1]] + [0, 1]))
    return Pole(places[kept] + offsets[path[kept]][:, None] * across[kept], width + 2 * MARGIN_PX)


def _unlikeness(
    colours: NDArray[np.float32], own: Mask, offsets: NDArray[np.int64], width: float
) -> tuple[NDArray[np.float32], float]:
    """Return how far, steps of 255, each place (n, m) of colours (n, m, 3) is from the stripe, as the middle of one.

    Also how far its own places (n,) usually are. All across the stripe counts: a stem that tapers becomes unlike it.
    """
    half, middle = int(0.4 * width), len(offsets) // 2
    core = np.unique(np.linspace(-half, half, CORE).round()).astype(np.int64)
    usual = np.median(colours[own][:, middle + core], axis=0)
    apart = np.full(colours.shape[:2], np.float32(UNLIKE))
    whole = slice(half, len(offsets) - half)
    apart[:, whole] = 0
    for away, colour in zip(core.tolist(), usual, strict=True):
        part = colours[:, whole.start + away : whole.stop + away] - colour
        apart[:, whole] += np.sqrt(np.einsum("ijk,ijk->ij", part, part)) / len(core)
    return apart, float(np.median(apart[own, middle]))


def _is_arc(middle: Floats, width: float) -> bool:
    """Return whether places (n, 2), px, lie on a flat arc, as a pole's or a wire's do, and a limb's do not."""
    way = middle - middle.mean(axis=0)
    along, across = np.linalg.svd(way, full_matrices=False)[2]
    x, y = way @ along, way @ across
    return bool(np.abs(np.polyval(np.polyfit(x, y, 2), x) - y).mean() <= STRAIGHT * width + 0.5)


def _run(flags: Mask, place: int) -> Mask:
    """Return the run of true flags (n,) around a place."""
    ends = np.flatnonzero(np.concatenate([[True], ~flags, [True]]))
    after = int(np.searchsorted(ends, place + 1))
    run = np.zeros_like(flags)
    run[ends[after - 1] : ends[after] - 1] = flags[place]
    return run


def _cheapest(cost: NDArray[np.float32], allowed: Mask) -> NDArray[np.int64]:
    """Return the column (n,) in each row of a cost (n, m) on the cheapest way down that moves by one column at most."""
    total = np.pad(np.where(allowed, cost, UNLIKE), ((0, 0), (1, 1)), constant_values=UNLIKE * len(cost))
    for before, row in pairwise(total):
        row[1:-1] += np.minimum(before[1:-1], np.minimum(before[:-2], before[2:]) + ASIDE)
    path = np.empty(len(total), dtype=np.int64)
    path[-1] = column = int(total[-1, 1:-1].argmin()) + 1
    for row in range(len(total) - 2, -1, -1):
        near = total[row, column - 1 : column + 2] + (ASIDE, 0, ASIDE)
        column += int(near.argmin()) - 1
        path[row] = column
    return path - 1


def _likeness(apart: NDArray[np.float32], path: NDArray[np.int64], width: float, most: float) -> tuple[Mask, Mask]:
    """Return where (n,) a path has the stripe's colour, and where (n, 2) what is on each side of it has not."""
    rows, away = np.arange(len(path)), int(np.ceil(width)) + 1
    sides = [apart[rows, np.clip(path + turn * away, 0, apart.shape[1] - 1)] > most for turn in (-1, 1)]
    return apart[rows, path] <= most, np.column_stack(sides)
