"""What a branch looks like, learnt from the pixels under the branch strokes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

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
from treestroke.core.types import Floats, Indices, Mask, Opacity, Picture

Odds = NDArray[np.float32]
Kind = TypeVar("Kind", bound=np.generic)

COMPONENTS = 5
"""Components of the mixture of branch colours (Tan et al. 2008, section 2)."""
LEAF_LIKE = 1.0
"""Mahalanobis distance from foliage below which a branch component is foliage that the stroke crosses."""
WOOD_LIKE = 3.0
"""Mahalanobis distance from bare wood above which a component is not wood."""
MAX_SAMPLES = 2500
"""Approximate number of pixels that a mixture is fitted to."""
MIN_BARE = 100
"""Number of pixels of bare wood under the strokes from which on it has a mixture of its own."""
MIN_DIFFERENT = 0.25
"""Least share of leaves that differ from bare wood; below it the colours in the crown tell nothing."""
SURE, MIN_LEARNT = 1.0, 200
"""Log odds from which a pixel of the crown teaches what wood looks like, and least number of them."""
OTHER_COMPONENTS, BEHIND = 8, 0.3
"""Components of a mixture of all in the crown that is not wood, and the ground's share in it."""
MAX_ODDS = 6.0
"""Limit of the log odds in both directions."""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """What surrounds the branches of a photo.

    Attributes
    ----------
    leaf, ground
        Colours (sRGB mixtures) of leaves, None on a bare tree, and of what is behind the tree.
    crown
        (h, w) mask of where leaves may be.
    foliage
        (h, w) mask of the leaves, or of the twigs of a bare tree: a limb may be hidden there.
    bare_wood
        (h, w) share of each pixel that wood covers in a bare crown; None in leaves.
    broad
        Whether its leaves are broad: shade between sprays of needles or scales makes lines like limbs.
    cut_out
        Whether the tree was cut out: nothing surrounds it, and the picture's lower edge is the ground.
    """

    leaf: Mixture | None
    ground: Mixture
    crown: Mask
    foliage: Mask
    bare_wood: Opacity | None = None
    broad: bool = False
    cut_out: bool = False


@dataclass(frozen=True, eq=False)
class WoodOdds:
    """Log odds (h, w), within +-6, that each pixel of a photo shows wood.

    Attributes
    ----------
    by_strokes
        By the colours under the strokes: they change little when the hand shakes.
    by_crown
        Inside the crown by what was learnt there: they see wood in other light, and its whole width.
    """

    by_strokes: Odds
    by_crown: Odds


def wood_odds(photo: Picture, lines_px: Sequence[Floats], breadth_px: float, surroundings: Surroundings) -> WoodOdds:
    """Return the log odds that each pixel of a photo (h, w, 3), sRGB, shows wood.

    Branches have a mixture of 5 components of the pixels within ``breadth_px`` of the lines (n, 2), px. In the crown
    the components too close to those of leaves (the stroke crosses leaves) are left out, and all else is leaf or
    ground. Outside there are no leaves and the mixture is that of the bare wood there, so that a trunk as dark as its
    leaves differs from the ground. Source: Tan et al. 2008, section 2, "Visible branch tracing".

    The crown's own odds begin with the bare wood below it, too, and with leaves that do not look like it; what these
    tell apart gives both mixtures anew, as in GrabCut (Rother, Kolmogorov and Blake 2004, section 3).
    """
    leaf, ground, crown = surroundings.leaf, surroundings.ground, surroundings.crown
    pixels, in_crown = _pixels_under(photo, lines_px, breadth_px, crown)
    model = fit_mixture(_subsample(pixels), COMPONENTS)
    bare = fit_mixture(_subsample(pixels[~in_crown]), COMPONENTS) if (~in_crown).sum() >= MIN_BARE else None
    among_leaves = model if leaf is None else _without_leaf_components(model, leaf)
    among_leaves = among_leaves if bare is None else _wood_components(among_leaves, bare)
    rest = ground if leaf is None else join_mixtures([leaf, ground], [0.5, 0.5])
    place = table_index(photo)
    shown = np.flatnonzero(np.bincount(place.reshape(-1), minlength=2 ** (3 * TABLE_BITS)))
    outside = _odds(bare or model, ground, shown)
    inside = np.full_like(outside, -MAX_ODDS) if among_leaves is None else _odds(among_leaves, rest, shown)
    at = place | crown.astype(np.uint16) << 3 * TABLE_BITS
    by_strokes = by_crown = np.take(np.concatenate([outside, inside]), at)
    wood = [mixture for mixture in (bare, among_leaves) if mixture is not None]
    others = _others_in_crown(bare, surroundings) if surroundings.bare_wood is None else None
    if wood and others is not None:
        odds = _odds(join_mixtures(wood, [1.0] * len(wood)), others, shown)
        of_crown = np.flatnonzero(crown)
        learnt = _learnt(photo, of_crown, odds[place.reshape(-1)[of_crown]], ground)
        by_crown = np.take(np.concatenate([outside, odds if learnt is None else _odds(*learnt, shown)]), at)
    return WoodOdds(by_strokes, by_crown)


def _others_in_crown(bare: Mixture | None, surroundings: Surroundings) -> Mixture | None:
    """Return the colours of all in the crown that is not wood: of the ground, and of leaves that differ from bare wood.

    None where nearly all leaves have the colours of bare wood.
    """
    leaf, ground = surroundings.leaf, surroundings.ground
    if leaf is None:
        return ground
    differs = np.array([bare is None or distance(bare, mean) > LEAF_LIKE for mean in leaf.means])
    if leaf.weights[differs].sum() < MIN_DIFFERENT:
        return None
    return join_mixtures([leaf.select(differs), ground], [0.5, 0.5])


def _learnt(photo: Picture, pixels: Indices, known: Odds, ground: Mixture) -> tuple[Mixture, Mixture] | None:
    """Return the colours of wood and of all else, learnt from what log odds (n,) tell apart in a crown, if enough.

    ``pixels`` (n,) are the crown's in the photo (h, w, 3), row by row.
    """
    found, left = pixels[known > SURE], pixels[known <= 0]
    if min(len(found), len(left)) < MIN_LEARNT:
        return None
    colours = photo.reshape(-1, 3)
    others = join_mixtures([fit_mixture(colours[_subsample(left)], OTHER_COMPONENTS), ground], [1 - BEHIND, BEHIND])
    return fit_mixture(colours[_subsample(found)], COMPONENTS), others


def _odds(branch: Mixture, rest: Mixture, shown: Indices) -> Odds:
    """Return the log odds of a branch for the colours of the colour table that a photo shows (n,); 0 for the others."""
    colours, odds = table_colours(), np.zeros(2 ** (3 * TABLE_BITS), dtype=np.float32)
    of_shown = log_density(branch, colours[shown]) - log_density(rest, colours[shown])
    odds[shown] = np.clip(of_shown, -MAX_ODDS, MAX_ODDS)
    return odds


def _pixels_under(photo: Picture, lines_px: Sequence[Floats], breadth_px: float, crown: Mask) -> tuple[Picture, Mask]:
    """Return the pixels (n, 3) on the lines and up to ``breadth_px`` beside them, and which (n,) lie in the crown."""
    offsets = np.arange(-np.floor(breadth_px), np.floor(breadth_px) + 1)
    dense = [resample(line, 1.0) for line in lines_px]
    places = np.concatenate([(d[:, None] + offsets[:, None] * normals(d)[:, None]).reshape(-1, 2) for d in dense])
    return np.asarray(sample_nearest(photo, places, 0), dtype=np.uint8), sample_nearest(crown, places, False)


def _subsample(pixels: NDArray[Kind]) -> NDArray[Kind]:
    """Return evenly spaced ones of many pixels (n, ...)."""
    return pixels[:: max(1, len(pixels) // MAX_SAMPLES)]


def _without_leaf_components(model: Mixture, leaf: Mixture) -> Mixture | None:
    """Return the components that differ from leaves; None where no component does."""
    common = leaf.weights > 0.05
    solid = leaf.select(common) if common.any() else leaf
    kept = np.array([distance(solid, mean) > LEAF_LIKE for mean in model.means])
    return model.select(kept) if kept.any() else None


def _wood_components(model: Mixture | None, bare: Mixture) -> Mixture | None:
    """Return the components that look like bare wood, as a stroke in the crown crosses sky, too; None if none does."""
    if model is None:
        return None
    kept = np.array([distance(bare, mean) < WOOD_LIKE for mean in model.means])
    return model.select(kept) if kept.any() else None
