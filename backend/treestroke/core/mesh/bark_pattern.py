"""Procedural bark: the height pattern of a form of bark, for photos that show no bark or too little."""

from typing import Literal

import numpy as np

from treestroke.core.types import Floats

BarkForm = Literal["smooth", "furrowed", "plated", "peeling", "banded", "scaly"]

_BANDS = ((5.0, 26.0, 1.0), (2.2, 9.0, 0.55), (0.9, 1.6, 0.25))  # (width px, height px, weight) of each size of feature
_RIDGE = 0.75  # share of ridged noise in each size of feature; the rest is plain noise
_PLATE, _SCALE = (62.0, 112.0), (23.0, 27.0)  # width and height, px, of a pine's plates and a spruce's scales
_WARP = 5.0  # px by which the borders of plates are displaced
_COARSE = 2  # plates are computed on every second pixel
_LENTICELS = 150
_LENTICEL = (10.0, 34.0)  # least and greatest half width of a lenticel, px


def bark_pattern(size: tuple[int, int], rng: np.random.Generator, form: BarkForm = "furrowed") -> Floats:
    """Draw a height pattern of bark (h, w), unitless, mean 0, deviation 1; fissures are negative. It tiles seamlessly.

    Notes
    -----
    Furrows are ridged noise after Musgrave ("Texturing and Modeling", 1994), in three sizes, stretched vertically;
    plates and scales are cellular noise (Worley 1996); peeling bark consists of flat flakes at three levels.
    """
    match form:
        case "furrowed":
            return _furrows(size, rng)
        case "smooth":
            return _smooth(size, rng)
        case "plated":
            return standardized(_plates(size, _PLATE, 0.3, rng) + 0.22 * _fine(size, rng))
        case "scaly":
            return standardized(_plates(size, _SCALE, 0.45, rng) + 0.25 * _fine(size, rng))
        case "peeling":
            return _flakes(size, rng)
        case "banded":
            return _bands(size, rng)


def _furrows(size: tuple[int, int], rng: np.random.Generator) -> Floats:
    """Vertical fissures between ridges."""
    total = np.zeros(size)
    for width, height, weight in _BANDS:
        noise = _blobs(size, width, height, rng)
        ridged = standardized(0.8 - np.abs(_blobs(size, 1.6 * width, 2.0 * height, rng)))
        total += weight * ((1.0 - _RIDGE) * noise + _RIDGE * np.maximum(ridged, -2.0))
    return standardized(total)


def _fine(size: tuple[int, int], rng: np.random.Generator) -> Floats:
    """Fine grain, smaller than the features of any form."""
    return standardized(_blobs(size, 1.0, 1.6, rng) + 0.7 * _blobs(size, 2.5, 5.0, rng))


def _smooth(size: tuple[int, int], rng: np.random.Generator) -> Floats:
    """Shallow dents, and faint wrinkles around the stem."""
    return standardized(_blobs(size, 14.0, 18.0, rng) + 0.3 * _blobs(size, 14.0, 1.4, rng) + 0.35 * _fine(size, rng))


def _plates(size: tuple[int, int], plate: tuple[float, float], crack: float, rng: np.random.Generator) -> Floats:
    """Domed plates of a width and height, px, each at its own level, with cracks between them."""
    across, down = max(2, round(size[1] / plate[0])), max(2, round(size[0] / plate[1]))
    within, level = rng.uniform(0.08, 0.92, (down, across, 2)), rng.normal(0, 0.35, (down, across))
    y, x = np.indices((size[0] // _COARSE, size[1] // _COARSE)) * float(_COARSE)
    y, x = (
        (at + _WARP * _blobs(size, 6.0, 9.0, rng)[::_COARSE, ::_COARSE]) * count / extent
        for at, count, extent in ((y, down, size[0]), (x, across, size[1]))
    )
    nearest, second, plate_level = _two_nearest(y, x, within, level)
    return standardized(_enlarged(np.minimum((second - nearest) / crack, 1.0) ** 0.6 * (1.5 + plate_level)))


def _two_nearest(y: Floats, x: Floats, within: Floats, level: Floats) -> tuple[Floats, Floats, Floats]:
    """Distances of places to the nearest and second nearest point, of one in each cell, and the nearest one's level.

    Written out: a k-d tree finds them no faster, and importing scipy's would take half a second in every such model.
    """
    down, across = level.shape
    row, column = np.floor(y).astype(np.int64), np.floor(x).astype(np.int64)
    nearest, second, nearest_level = np.full(y.shape, np.inf), np.full(y.shape, np.inf), np.zeros(y.shape)
    for step_y in (-1, 0, 1):
        for step_x in (-1, 0, 1):
            cell = (row + step_y) % down, (column + step_x) % across
            far = np.hypot(row + step_y + within[cell][..., 0] - y, column + step_x + within[cell][..., 1] - x)
            second = np.minimum(second, np.maximum(nearest, far))
            nearest_level = np.where(far < nearest, level[cell], nearest_level)
            nearest = np.minimum(nearest, far)
    return nearest, second, nearest_level


def _flakes(size: tuple[int, int], rng: np.random.Generator) -> Floats:
    """Patches from which thin flakes have been shed, as on a plane tree: three levels with sharp edges."""
    first, second = (_blobs(size, w, h, rng) + 0.25 * _blobs(size, 4.0, 5.0, rng) for w, h in ((13, 22), (9, 15)))
    steps = _step(first) + 0.8 * _step(second - 0.5) - 0.7 * _step(-first - 1.0)
    return standardized(steps + 0.08 * _fine(size, rng))


def _bands(size: tuple[int, int], rng: np.random.Generator) -> Floats:
    """Faint bands around a smooth stem, and lenticels (short dark dashes), as on a birch or a cherry."""
    rows, columns = np.arange(size[0]), np.arange(size[1])
    dashes = np.zeros(size)
    half = rng.uniform(*_LENTICEL, _LENTICELS) * rng.random(_LENTICELS) ** 0.7
    thick, strength = rng.uniform(0.8, 2.2, _LENTICELS), rng.uniform(0.4, 1.0, _LENTICELS)
    middle = rng.random((_LENTICELS, 2)) * size
    for index in range(_LENTICELS):
        off_y = np.mod(rows - middle[index, 0] + size[0] / 2, size[0]) - size[0] / 2
        off_x = np.mod(columns - middle[index, 1] + size[1] / 2, size[1]) - size[1] / 2
        high = np.exp(-0.5 * (off_y / thick[index]) ** 2)
        wide = 1.0 / (1.0 + np.exp(np.clip((np.abs(off_x) - half[index]) / 1.5, -30, 30)))
        dashes = np.maximum(dashes, strength[index] * high[:, None] * wide)
    bands = 0.09 * _blobs(size, 40.0, 2.0, rng) + 0.05 * _blobs(size, 12.0, 14.0, rng)
    return standardized(bands - dashes + 0.03 * _fine(size, rng))


def _step(values: Floats) -> Floats:
    """Apply a smooth step: 0 well below 0, 1 well above."""
    return np.asarray(1.0 / (1.0 + np.exp(-9.0 * np.clip(values, -3, 3))))


def _enlarged(coarse: Floats) -> Floats:
    """Double the resolution (h, w) by linear interpolation that wraps around the edges."""
    for axis in (0, 1):
        between = 0.5 * (coarse + np.roll(coarse, -1, axis))
        shape = [n * (2 if k == axis else 1) for k, n in enumerate(coarse.shape)]
        coarse = np.stack([coarse, between], axis=axis + 1).reshape(shape)
    return coarse


def _blobs(size: tuple[int, int], width: float, height: float, rng: np.random.Generator) -> Floats:
    """White noise smoothed by a Gaussian of these deviations, px, that wraps around the edges."""
    frequency_y = np.fft.fftfreq(size[0])[:, None]
    frequency_x = np.fft.rfftfreq(size[1])[None, :]
    kept = np.exp(-2.0 * np.pi**2 * ((frequency_x * width) ** 2 + (frequency_y * height) ** 2))
    return standardized(np.fft.irfft2(np.fft.rfft2(rng.standard_normal(size)) * kept, s=size))


def standardized(values: Floats) -> Floats:
    """Shift and scale values (h, w) of any unit to mean 0 and deviation 1."""
    return np.asarray((values - values.mean()) / max(float(values.std()), 1e-12))
