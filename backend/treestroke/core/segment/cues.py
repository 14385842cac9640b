"""Cues that tell kinds of foliage and forms of crowns apart.

They are measured on a copy of the crown that always has the same size, so that a photo's size hardly matters.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Mask, Picture

Cues = Mapping[str, float]
"""What was measured, by name; `crown_cues` says what each name means."""

COPY_SIZE = 256.0
"""Square root of the crown's area in the copy, px: there a leaf of most trees is 1 to 4 px long."""
LEAST_PIXELS = 50
"""Foliage of fewer pixels in the copy is too little to be judged: the whole crown is judged in its place."""
LEAST_INNER_PIXELS = 200
"""Where fewer pixels of the copy lie inside the foliage, its edges are judged too."""
TURN_PX = 6
"""The outline's direction is taken over twice as many of its points: shorter steps are those of single leaves."""
MOST_FREE = 3.0
"""A trunk's length below the crown counts up to this many heights of the crown."""

_Map = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class _Copy:
    """The crown at `COPY_SIZE`: pixels (h, w, 3), brightness (h, w), 0 to 255, foliage and crown (h, w)."""

    pixels: Picture
    grey: _Map
    mask: Mask
    crown: Mask

    @cached_property
    def weights(self) -> _Map:
        """1 in the foliage, else 0."""
        return self.mask.astype(np.float32)

    @cached_property
    def filled(self) -> _Map:
        """Brightness with what is not foliage replaced by the brightness of the foliage near by."""
        near = _blurred(self.grey * self.weights, 6) / np.maximum(_blurred(self.weights, 6), 1e-3)
        return np.where(self.mask, self.grey, near).astype(np.float32)

    @cached_property
    def brightness(self) -> float:
        """Mean brightness of the foliage."""
        return max(_mean(self.grey, self.weights), 20.0)


def crown_cues(photo: Picture, mask: Mask, crown: Mask, pure: Mask | None = None) -> Cues:
    """Measure the foliage (h, w, flags) of a crown (h, w, flags) on a photo (h, w, 3), sRGB.

    ``pure`` (h, w, flags) are those of its pixels in which nothing shines through; without them all count.

    Returns
    -------
    By name. Colour: ``tint``, how much green or red exceed blue in the median pixel; ``greenish``, share of green
    pixels; ``leafy``, share of clearly green, yellow or red ones among the pure. Light: ``light_top``, brightness of
    the upper half over the lower one's; ``fine_grain``, contrast of details under 1 px over that of 1 to 2 px, inside
    the foliage; ``coarse_grain``, that of 1 to 2 px over that of 2 to 4 px. Lines: ``fine_lines`` and
    ``coarse_lines``, how parallel edges are near by, 0 to 1; how far lines radiate, -1 to 1, fine ones ``from_top`` of
    the crown, coarse ones ``from_centre`` and ``from_foot``; ``level``, how far fine lines lie level
    (upright ones below 0). Outline: see `_outline_cues`. Ratios without a bound are logarithms.
    """
    copy = _copy(photo, mask, crown)
    judged = next(part for part in (pure, mask, crown) if part is not None and (part is crown or part.any()))
    return {
        **_colour_cues(copy),
        "leafy": _leafy(photo[judged]),
        **_light_cues(copy),
        **_line_cues(copy),
        **_outline_cues(copy),
    }


def standing_cues(crown_px: Floats, trunk_px: Floats) -> Cues:
    """Measure how a crown (n, 2) stands on its trunk (m, 2), both px.

    Returns
    -------
    By name. ``slim``, the tree's height over its crown's width, a logarithm; ``flat``, how much wider than high the
    crown is, if the trunk below it is as long as it is wide, and less on a shorter one.
    """
    (left, top), (right, bottom) = crown_px.min(axis=0), crown_px.max(axis=0)
    width, high = max(right - left, 1.0), max(bottom - top, 1.0)
    free = float(np.clip(trunk_px[:, 1].max() - bottom, 0.0, MOST_FREE * high))
    return {
        "slim": float(np.log((high + free) / width)),
        "flat": min(free / width, 1.0) * max(0.0, float(np.log(width / high))),
    }


def _copy(photo: Picture, mask: Mask, crown: Mask) -> _Copy:
    """Reduce or enlarge the crown's bounding box to the copy's size."""
    rows, columns = np.flatnonzero(crown.any(axis=1)), np.flatnonzero(crown.any(axis=0))
    box = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    scale = COPY_SIZE / np.sqrt(crown.sum())
    size = max(8, round(len(columns) * scale)), max(8, round(len(rows) * scale))
    how = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_LINEAR

    def sized(part: Mask) -> Mask:
        return cv2.resize(part[box].astype(np.float32), size, interpolation=how) > 0.5

    pixels = np.asarray(cv2.resize(np.ascontiguousarray(photo[box]), size, interpolation=how), dtype=np.uint8)
    foliage, inside = sized(mask), sized(crown)
    grey = cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY).astype(np.float32)
    return _Copy(pixels, grey, foliage if foliage.sum() >= LEAST_PIXELS else inside, inside)


def _colour_cues(copy: _Copy) -> dict[str, float]:
    red, green, blue = copy.pixels[copy.mask].astype(np.float32).T
    warmest = np.maximum(red, green)
    return {
        "tint": float(np.median((warmest - blue) / np.maximum(np.maximum(warmest, blue), 40.0))),
        "greenish": float(((green > 1.03 * red) & (green > 1.1 * blue)).mean()),
    }


def _leafy(pixels: Picture) -> float:
    """Return the share of pixels (n, 3) that have colours of leaves, which wood has not."""
    red, green, blue = pixels.astype(np.float32).T
    warmest = np.maximum(red, green)
    is_green = (green > 1.03 * red) & (green > 1.15 * blue) & (green - np.minimum(red, blue) > 12.0)
    is_vivid = (warmest - blue > 0.6 * warmest) & (warmest > 70.0)
    return float((is_green | is_vivid).mean()) if len(pixels) else 0.0


def _light_cues(copy: _Copy) -> dict[str, float]:
    upper, lower = np.array_split(copy.grey[copy.mask], 2)  # in the order of the rows
    inner = np.asarray(cv2.erode(copy.weights, _disc(7)), dtype=np.float32)
    inner = inner if inner.sum() >= LEAST_INNER_PIXELS else copy.weights
    softer = [copy.filled, *(_blurred(copy.filled, size) for size in (1, 2, 4))]
    least = 0.002 * copy.brightness
    fine, middling, coarse = (np.sqrt(_mean((a - b) ** 2, inner)) + least for a, b in pairwise(softer))
    return {
        "light_top": float(np.log((upper.mean() + 5.0) / (lower.mean() + 5.0))),
        "fine_grain": float(np.log(fine / middling)),
        "coarse_grain": float(np.log(middling / coarse)),
    }


def _line_cues(copy: _Copy) -> dict[str, float]:
    rows, columns = np.nonzero(copy.mask)
    column, (highest, lowest) = float(columns.mean()), np.percentile(rows, (1, 99))
    fine = _Lines.of(copy.grey, copy.weights, 1.0, 3.0)
    coarse = _Lines.of(copy.filled, copy.weights, 2.0, 7.0)
    return {
        "fine_lines": fine.parallel,
        "coarse_lines": coarse.parallel,
        "from_top": fine.radiating((column, float(highest))),
        "from_centre": coarse.radiating((column, float(rows.mean()))),
        "from_foot": coarse.radiating((column, float(lowest))),
        "level": fine.level,
    }


@dataclass(frozen=True, eq=False)
class _Lines:
    """Directions of lines by the structure tensor.

    Attributes
    ----------
    cosine, sine
        (h, w) of twice the lines' angle from level, times how parallel they are; rows count downward.
    weights
        (h, w) strength of the edges in the foliage.
    """

    cosine: _Map
    sine: _Map
    weights: _Map

    @classmethod
    def of(cls, picture: _Map, foliage: _Map, edge_px: float, near_px: float) -> "_Lines":
        """Find the lines of a picture (h, w): edges ``edge_px`` wide, averaged over ``near_px``."""
        smooth = _blurred(picture, edge_px)
        across, down = cv2.Sobel(smooth, cv2.CV_32F, 1, 0), cv2.Sobel(smooth, cv2.CV_32F, 0, 1)
        xx, yy, xy = (_blurred(product, near_px) for product in (across * across, down * down, across * down))
        strength = xx + yy
        return cls((yy - xx) / (strength + 1e-3), -2 * xy / (strength + 1e-3), foliage * np.sqrt(strength + 1e-6))

    @property
    def parallel(self) -> float:
        """How parallel lines are near by, 0 to 1."""
        return _mean(np.hypot(self.cosine, self.sine), self.weights)

    @property
    def level(self) -> float:
        """How far lines lie level, -1 (upright) to 1."""
        return _mean(self.cosine, self.weights)

    def radiating(self, point: tuple[float, float]) -> float:
        """How far lines radiate from a point (x, y), px; -1 (they circle it) to 1."""
        rows, columns = np.mgrid[: self.cosine.shape[0], : self.cosine.shape[1]].astype(np.float32)
        twice = 2 * np.arctan2(rows - point[1], columns - point[0])
        return _mean(self.cosine * np.cos(twice) + self.sine * np.sin(twice), self.weights)


def _outline_cues(copy: _Copy) -> dict[str, float]:
    """Measure the crown's outline, without its holes.

    ``aspect``, height over width, a logarithm; as shares of the greatest width those at the ``shoulder`` (a sixth below
    the top) and at the ``foot`` (an 8th), and without gaps those at the ``top`` and ``low`` down, at five sevenths;
    ``taper``, width of the upper quarter over the lower half's; ``widest``, where it is widest, 0 (top) to 1; ``wavy``,
    how far it turns at each place, radians.
    """
    filled, outline = _closed(copy.mask)
    rows = np.flatnonzero(filled.any(axis=1))
    columns = np.flatnonzero(filled.any(axis=0))
    left, right = filled[rows].argmax(axis=1), filled[rows, ::-1].argmax(axis=1)
    widths = (filled.shape[1] - left - right).astype(np.float32)
    count, most = len(rows), float(np.percentile(widths, 95))
    smooth = _blurred(widths[None], max(1.0, count / 12))[0]
    covered = filled[rows].sum(axis=1, dtype=np.float32)
    cover = _blurred(covered[None], max(1.0, count / 16))[0] / float(np.percentile(covered, 95))
    return {
        "aspect": float(np.log(len(rows) / len(columns))),
        "top": float(cover[0]),
        "shoulder": float(smooth[count // 6]) / most,
        "low": float(cover[5 * (count - 1) // 7]),
        "foot": float(widths[-max(1, count // 8) :].mean()) / most,
        "taper": float(widths[: max(1, count // 4)].mean() / max(float(widths[-max(2, count // 2) :].mean()), 1.0)),
        "widest": float(smooth.argmax()) / count,
        "wavy": _turning(outline),
    }


def _turning(outline: NDArray[np.int32]) -> float:
    """Return how far an outline (n, 1, 2) turns at each place, radians."""
    points = outline[:, 0].astype(np.float64)
    along = np.roll(points, -TURN_PX, axis=0) - np.roll(points, TURN_PX, axis=0)
    angles = np.arctan2(along[:, 1], along[:, 0])
    return float(np.abs(np.angle(np.exp(1j * (np.roll(angles, -TURN_PX) - angles)))).mean())


def _closed(mask: Mask) -> tuple[Mask, NDArray[np.int32]]:
    """Close gaps of a mask, keep its largest part without holes (h, w), and return its outline (n, 1, 2) too."""
    cells = cv2.morphologyEx(np.pad(mask.astype(np.uint8), 20), cv2.MORPH_CLOSE, _disc(15))
    outlines, _ = cv2.findContours(cells, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    largest = np.asarray(max(outlines, key=cv2.contourArea), dtype=np.int32)
    filled = cv2.drawContours(np.zeros_like(cells), [largest], -1, 1, -1)[20:-20, 20:-20] > 0
    return np.asarray(filled), largest


def _mean(values: _Map, weights: _Map) -> float:
    return float((values * weights).sum() / max(float(weights.sum()), 1e-9))


def _blurred(values: _Map, sigma: float) -> _Map:
    return np.asarray(cv2.GaussianBlur(values, (0, 0), sigma), dtype=np.float32)


def _disc(size: int) -> NDArray[np.uint8]:
    return np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size)), dtype=np.uint8)
