"""Cues that tell kinds of foliage and forms of crowns apart.

They are measured on a copy of the crown that always has the same size, so that a photo's size hardly matters.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Mask, Picture

Cues = Mapping[str, float]
"""What was measured, by name; `crown_cues` says what each name means."""

COPY_SIZE = 256.0
"""Square root of the crown's area in the copy, px: there a leaf of most trees is 1 to 4 px long."""
LEAST_PIXELS = 50
"""Foliage of fewer pixels in the copy is too little to be judged: the whole crown is judged in its place."""

_Map = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class _Copy:
    """The crown at `COPY_SIZE`: pixels (h, w, 3), brightness (h, w), 0 to 255, foliage and crown (h, w)."""

    pixels: Picture
    grey: _Map
    mask: Mask
    crown: Mask

    @property
    def weights(self) -> _Map:
        """1 in the foliage, else 0."""
        return self.mask.astype(np.float32)

    @property
    def filled(self) -> _Map:
        """Brightness with what is not foliage replaced by the brightness of the foliage near by."""
        near = _blurred(self.grey * self.weights, 6) / np.maximum(_blurred(self.weights, 6), 1e-3)
        return np.where(self.mask, self.grey, near).astype(np.float32)

    @property
    def brightness(self) -> float:
        """Mean brightness of the foliage."""
        return max(_mean(self.grey, self.weights), 20.0)


def crown_cues(photo: Picture, mask: Mask, crown: Mask) -> Cues:
    """Measure the foliage (h, w, flags) of a crown (h, w, flags) on a photo (h, w, 3), sRGB.

    Returns
    -------
    By name. Colour: ``tint``, how much green or red exceed blue in the median pixel; ``greenish``, share of green
    pixels. Light: ``clumps``, contrast of details of 2 to 4 px; ``light_top``, brightness of the upper half over the
    lower one's; ``tiers``, how much rows differ in brightness compared with columns. Lines: ``fine_lines`` and
    ``coarse_lines``, how parallel edges are near by, 0 to 1; ``from_top`` and ``from_centre``, how far fine and coarse
    lines radiate from the crown's top or centre, -1 to 1; ``drooping``, how far coarse lines sink outward; ``level``,
    how far fine lines lie level (upright ones below 0); ``contrast``, fine lines' over the whole crown's.
    Cover: ``cover``, the crown's share that is foliage; ``thinness``, the foliage's share in thin lines; ``runs``,
    length of level runs of foliage over that of upright ones. Outline: see `_outline_cues`. Ratios without a bound are
    logarithms.
    """
    copy = _copy(photo, mask, crown)
    return {**_colour_cues(copy), **_light_cues(copy), **_line_cues(copy), **_cover_cues(copy), **_outline_cues(copy)}


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


def _light_cues(copy: _Copy) -> dict[str, float]:
    filled, weights = copy.filled, copy.weights
    detail = _blurred(filled, 2) - _blurred(filled, 4)
    upper, lower = np.array_split(copy.grey[copy.mask], 2)  # in the order of the rows
    rows, columns = (_bands(filled, weights, axis) / copy.brightness for axis in (1, 0))
    return {
        "clumps": float(np.log(np.sqrt(_mean(detail**2, weights)) / copy.brightness + 1e-3)),
        "light_top": float(np.log((upper.mean() + 5.0) / (lower.mean() + 5.0))),
        "tiers": float(np.log((rows + 0.003) / (columns + 0.003))),
    }


def _bands(brightness: _Map, weights: _Map, axis: int) -> float:
    """Return how much rows (axis 1) or columns (axis 0) differ in brightness, 0 to 255, at 2 to 6 px."""
    count = weights.sum(axis=axis)
    profile = ((brightness * weights).sum(axis=axis) / np.maximum(count, 1))[count > 10][None]
    if profile.size < 20:
        return 0.0
    return float((_blurred(profile, 1.5) - _blurred(profile, 6)).std())


def _line_cues(copy: _Copy) -> dict[str, float]:
    rows, columns = np.nonzero(copy.mask)
    top, centre = (float(columns.mean()), float(np.percentile(rows, 1))), (float(columns.mean()), float(rows.mean()))
    fine = _Lines.of(copy.grey, copy.weights, 1.0, 3.0)
    coarse = _Lines.of(copy.filled, copy.weights, 2.0, 7.0)
    disc = _disc(5)
    strokes = np.maximum(*(cv2.morphologyEx(copy.grey, how, disc) for how in (cv2.MORPH_TOPHAT, cv2.MORPH_BLACKHAT)))
    return {
        "fine_lines": fine.parallel,
        "coarse_lines": coarse.parallel,
        "from_top": fine.radiating(top),
        "from_centre": coarse.radiating(centre),
        "drooping": coarse.drooping(centre[0]),
        "level": fine.level,
        "contrast": float(np.log((_mean(strokes, copy.weights) + 0.5) / (copy.grey[copy.crown].std() + 3.0))),
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

    def drooping(self, column: float) -> float:
        """How far lines sink away from a column, px; -1 (they rise) to 1."""
        outward = np.sign(np.arange(self.sine.shape[1], dtype=np.float32) - column)
        return _mean(self.sine * outward, self.weights)


def _cover_cues(copy: _Copy) -> dict[str, float]:
    cells = np.pad(copy.mask.astype(np.uint8), 8)
    opened = cv2.morphologyEx(cells, cv2.MORPH_OPEN, _disc(5))
    level, upright = (int(np.abs(np.diff(cells.astype(np.int8), axis=axis)).sum()) for axis in (0, 1))
    return {
        "cover": float(copy.mask.sum()) / float(copy.crown.sum()),
        "thinness": 1.0 - float(opened.sum()) / float(cells.sum()),
        "runs": float(np.log((level + 20) / (upright + 20))),
    }


def _outline_cues(copy: _Copy) -> dict[str, float]:
    """Measure the crown's outline, without its holes.

    ``aspect``, height over width; ``ragged``, length over that of its convex hull; as shares of the greatest width
    those at the ``tip`` (an 11th of the height), at the ``shoulder`` (a sixth below the top) and at the ``foot`` (an
    8th); ``taper``, width of the upper quarter over the lower half's; ``widest``, where it is widest, 0 (top) to 1;
    ``hanging``, how far its sides reach below its middle, in heights.
    """
    filled, outline = _closed(copy.mask)
    rows = np.flatnonzero(filled.any(axis=1))
    columns = np.flatnonzero(filled.any(axis=0))
    left, right = filled[rows].argmax(axis=1), filled[rows, ::-1].argmax(axis=1)
    widths = (filled.shape[1] - left - right).astype(np.float32)
    count, most = len(rows), float(np.percentile(widths, 95))
    smooth = _blurred(widths[None], max(1.0, count / 12))[0]
    foot = (filled.shape[0] - filled[::-1].argmax(axis=0))[columns].astype(np.float64)
    outer, _, middle, _, end = np.array_split(foot, 5)
    return {
        "aspect": float(np.log(len(rows) / len(columns))),
        "ragged": float(np.log(cv2.arcLength(outline, True) / max(cv2.arcLength(cv2.convexHull(outline), True), 1.0))),
        "tip": float(widths[: max(1, count // 11)].mean()) / most,
        "shoulder": float(smooth[count // 6]) / most,
        "foot": float(widths[-max(1, count // 8) :].mean()) / most,
        "taper": float(widths[: max(1, count // 4)].mean() / max(float(widths[-max(2, count // 2) :].mean()), 1.0)),
        "widest": float(smooth.argmax()) / count,
        "hanging": float(min(np.percentile(outer, 75), np.percentile(end, 75)) - np.median(middle)) / count,
    }


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
