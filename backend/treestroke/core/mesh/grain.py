"""Bark from nothing: fissures and ridges where the photo shows none."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_BANDS = ((5.0, 26.0, 1.0), (2.2, 9.0, 0.55), (0.9, 1.6, 0.25))  # (width px, height px, weight) of each size of feature
_RIDGE = 0.75  # how much of the coarse band is ridges between fissures, the rest even noise


def bark_grain(size: tuple[int, int], rng: np.random.Generator) -> Floats:
    """Make a pattern of upright fissures (h, w), mean 0, deviation 1, that repeats without seam.

    Ridged noise after Musgrave ("Texturing and Modeling", 1994), in three sizes, stretched upright.
    """
    total = np.zeros(size)
    for width, height, weight in _BANDS:
        noise = _blobs(size, width, height, rng)
        ridged = _unit(0.8 - np.abs(_blobs(size, 1.6 * width, 2.0 * height, rng)))
        total += weight * ((1.0 - _RIDGE) * noise + _RIDGE * np.maximum(ridged, -2.0))
    return _unit(total)


def _blobs(size: tuple[int, int], width: float, height: float, rng: np.random.Generator) -> Floats:
    """White noise smoothed by a Gaussian of these deviations, px, around the edges."""
    frequency_y = np.fft.fftfreq(size[0])[:, None]
    frequency_x = np.fft.rfftfreq(size[1])[None, :]
    kept = np.exp(-2.0 * np.pi**2 * ((frequency_x * width) ** 2 + (frequency_y * height) ** 2))
    return _unit(np.fft.irfft2(np.fft.rfft2(rng.standard_normal(size)) * kept, s=size))


def _unit(values: Floats) -> Floats:
    """Shift and scale to mean 0 and deviation 1."""
    return np.asarray((values - values.mean()) / max(float(values.std()), 1e-12))
