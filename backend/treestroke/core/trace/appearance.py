"""What a branch looks like, learnt from the pixels under the branch strokes."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import normals, resample
from treestroke.core.imaging.mixture import (
    TABLE_BITS,
    Mixture,
    distance,
    fit_mixture,
    join_mixtures,
    log_density,
    table_colours,
    table_index,
)
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.types import Floats, Mask, Picture

Odds = NDArray[np.float32]

COMPONENTS = 5
LEAF_LIKE = 1.0
"""Mahalanobis distance under which a branch component is taken for foliage that the stroke crosses."""
WOOD_LIKE = 3.0
"""Mahalanobis distance from bare wood beyond which a component is no wood."""
SAMPLES = 2500
FEWEST = 100
"""Pixels of bare wood under the strokes from which it has a mixture of its own."""


def branch_odds(
    photo: Picture, lines_px: Sequence[Floats], breadth_px: float, leaf: Mixture, ground: Mixture, crown: Mask
) -> Odds:
    """Log odds (h, w) that each pixel is branch rather than anything else, within +-6.

    Branch: a mixture of 5 components of the pixels within ``breadth_px`` of the lines (n, 2). Inside the crown (h, w)
    it goes without the components that lie too close to one of ``leaf`` (the stroke crosses leaves), and all else is
    leaf or ground; outside there are no leaves and the mixture is that of the bare wood there, so that a trunk as dark
    as its leaves is seen against the ground.
    Source: Tan et al. 2008, section 2, "Visible branch tracing".
    """
    pixels, in_crown = _pixels_under(photo, lines_px, breadth_px, crown)
    model = fit_mixture(_thinned(pixels), COMPONENTS)
    bare = fit_mixture(_thinned(pixels[~in_crown]), COMPONENTS) if (~in_crown).sum() >= FEWEST else model
    among_leaves = _like(_unlike(model, leaf), bare)
    rest = join_mixtures([leaf, ground], [0.5, 0.5])
    outside = _odds(bare, ground)
    inside = _odds(among_leaves, rest) if among_leaves is not None else np.full_like(outside, -6.0)
    return np.take(np.concatenate([outside, inside]), table_index(photo) | crown.astype(np.uint16) << 3 * TABLE_BITS)


def _odds(branch: Mixture, rest: Mixture) -> Odds:
    """Tabulate the log odds of a branch by colour."""
    colours = table_colours()
    return np.clip(log_density(branch, colours) - log_density(rest, colours), -6.0, 6.0).astype(np.float32)


def _pixels_under(
    photo: Picture, lines_px: Sequence[Floats], breadth_px: float, crown: Mask
) -> tuple[Picture, NDArray[np.bool_]]:
    """Read the pixels along the lines and up to ``breadth_px`` beside them (n, 3); tell which lie in the crown (n,)."""
    offsets = np.arange(-np.floor(breadth_px), np.floor(breadth_px) + 1)
    walked = [resample(line, 1.0) for line in lines_px]
    places = [(w[:, None] + offsets[:, None] * normals(w)[:, None]).reshape(-1, 2) for w in walked]
    spread = np.concatenate(places)
    return np.asarray(sample_nearest(photo, spread, 0), dtype=np.uint8), sample_nearest(crown, spread, False)


def _thinned(pixels: Picture) -> Picture:
    """Take evenly spaced ones of many pixels."""
    return pixels[:: max(1, len(pixels) // SAMPLES)]


def _unlike(model: Mixture, leaf: Mixture) -> Mixture | None:
    """Keep the components that are unlike leaves; None where there are none."""
    common = leaf.weights > 0.05
    solid = leaf.select(common) if common.any() else leaf
    kept = np.array([distance(solid, mean) > LEAF_LIKE for mean in model.means])
    return model.select(kept) if kept.any() else None


def _like(model: Mixture | None, bare: Mixture) -> Mixture | None:
    """Keep the components that look like bare wood: a stroke in the crown crosses sky, too."""
    if model is None:
        return None
    kept = np.array([distance(bare, mean) < WOOD_LIKE for mean in model.means])
    return model.select(kept) if kept.any() else None
