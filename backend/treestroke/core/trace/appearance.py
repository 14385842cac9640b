"""What a branch looks like, learnt from the pixels under the branch strokes."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import Floats, normals, resample
from treestroke.core.imaging.mixture import Mixture, distance, fit_mixture, log_density, table_colours, table_index
from treestroke.core.imaging.sampling import sample_nearest

Photo = NDArray[np.uint8]
Odds = NDArray[np.float32]

COMPONENTS = 5
LEAF_LIKE = 1.0
"""Mahalanobis distance under which a branch component is taken for foliage that the stroke crosses."""
SAMPLES = 2500


def branch_odds(photo: Photo, lines_px: Sequence[Floats], breadth_px: float, leaf: Mixture, rest: Mixture) -> Odds:
    """Log odds (h, w) that each pixel is branch rather than anything else, within +-6.

    Branch: a mixture of 5 components of the pixels within ``breadth_px`` of the lines (n, 2), without the
    components that lie too close to one of ``leaf`` (the stroke crosses leaves). Not branch: ``rest``.
    Source: Tan et al. 2008, section 2, "Visible branch tracing".
    """
    model = _branch_model(_pixels_under(photo, lines_px, breadth_px), leaf)
    if model is None:
        return np.full(photo.shape[:2], -6.0, np.float32)
    colours = table_colours()
    table = np.clip(log_density(model, colours) - log_density(rest, colours), -6.0, 6.0)
    return table.astype(np.float32)[table_index(photo)]


def _pixels_under(photo: Photo, lines_px: Sequence[Floats], breadth_px: float) -> Photo:
    """Pixels along the lines and up to ``breadth_px`` beside them (n, 3)."""
    offsets = np.arange(-np.floor(breadth_px), np.floor(breadth_px) + 1)
    found = []
    for line in lines_px:
        walked = resample(line, 1.0)
        spread = walked[:, None] + offsets[:, None] * normals(walked)[:, None]
        found.append(sample_nearest(photo, spread, 0).reshape(-1, 3))
    pixels = np.concatenate(found)
    return np.asarray(pixels[:: max(1, len(pixels) // SAMPLES)], dtype=np.uint8)


def _branch_model(pixels: Photo, leaf: Mixture) -> Mixture | None:
    """Fit the branch's mixture without leaf-like components; None where nothing else is left."""
    model = fit_mixture(pixels, COMPONENTS)
    common = leaf.weights > 0.05
    solid = leaf.select(common) if common.any() else leaf
    kept = np.array([distance(solid, mean) > LEAF_LIKE for mean in model.means])
    return model.select(kept) if kept.any() else None
