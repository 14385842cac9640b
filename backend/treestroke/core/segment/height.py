"""Colours that lie at other heights of a picture: sky above, distant trees and grass below.

What is seen through a crown is what is seen beside it at the same height, and leaves are brighter at a crown's top
than in its shade. So a mixture's components stay what they are, and their weights follow the height.
"""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.imaging.mixture import Mixture, component_shares, log_components, table_colours, table_index
from treestroke.core.types import Floats

BANDS = 10
"""Heights at which weights are counted; between them they are interpolated."""
EVERYWHERE = 0.25
"""Share of a component's weight that does not depend on the height: what a band did not show may still be there."""
SAMPLES = 8000
FEWEST = 20
"""Samples that a band must have for weights of its own."""

LIMIT = 8.0
"""No colour tells more, in log odds."""


def log_odds_by_height(
    leaf: Mixture, ground: Mixture, pixels: NDArray[np.uint8], found: NDArray[np.bool_]
) -> NDArray[np.float32]:
    """Log odds (h, w) that each pixel (h, w, 3) is a leaf, by its colour and height, within +-8.

    ``found`` (h, w) says where leaves were found before: their components' weights are counted there, those of the
    ground elsewhere.
    """
    density = _log_density(leaf, pixels, found) - _log_density(ground, pixels, ~found)
    return interpolated(np.clip(density, -LIMIT, LIMIT), table_index(pixels))


def _log_density(mixture: Mixture, pixels: NDArray[np.uint8], where: NDArray[np.bool_]) -> Floats:
    """Logarithm of a mixture's density at the look-up table's colours in each band (bands, 32768)."""
    parts = log_components(mixture, table_colours())
    peak = parts.max(axis=1)
    change = weights_by_height(mixture, pixels, where) / np.maximum(mixture.weights, 1e-12)
    return np.asarray(peak + np.log(change @ np.exp(parts - peak[:, None]).T))


def weights_by_height(mixture: Mixture, pixels: NDArray[np.uint8], where: NDArray[np.bool_]) -> Floats:
    """Count a mixture's weights (bands, k), top to bottom, over the pixels (h, w, 3) where it is found (h, w)."""
    index = np.flatnonzero(where.ravel())
    index = index[:: max(1, len(index) // SAMPLES)]
    share = component_shares(mixture, pixels.reshape(-1, 3)[index].astype(np.float64))
    place = (index // where.shape[1] + 0.5) / where.shape[0] * BANDS - 0.5
    near = np.exp(-0.5 * (place[None] - np.arange(BANDS)[:, None]) ** 2)
    count = near.sum(axis=1, keepdims=True)
    local = np.where(count > FEWEST, near @ share / np.maximum(count, 1e-9), mixture.weights)
    return np.asarray((1 - EVERYWHERE) * local + EVERYWHERE * mixture.weights)


def interpolated(tables: Floats, index: NDArray[np.uint16]) -> NDArray[np.float32]:
    """Look each pixel (h, w) up in the two tables (bands, 32768) nearest to its height and mix them."""
    height, compact = index.shape[0], tables.astype(np.float32)
    place = np.clip((np.arange(height) + 0.5) / height * BANDS - 0.5, 0, BANDS - 1)
    above = np.minimum(place.astype(np.int64), BANDS - 2)
    below = (place - above).astype(np.float32)[:, None]
    upper, lower = compact[above[:, None], index], compact[above[:, None] + 1, index]
    return np.asarray(upper + (lower - upper) * below)
