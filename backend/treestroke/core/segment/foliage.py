"""Foliage from one crown stroke: colour mixtures and a graph cut.

Source: Tan et al. 2008, section 2, "Foliage extraction". Where the paper takes the four most green or red of
ten components for leaves, we ask where a component's pixels lie: leaves fill the crown's middle, background
also fills the ring around the stroke. Colour is a prior on top of that, so that yellow autumn, white blossom
and bare twigs work too.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.imaging.grid_cut import cut_grid
from treestroke.core.imaging.mixture import (
    Mixture,
    component_shares,
    fit_mixture,
    join_mixtures,
    log_density,
    table_colours,
    table_index,
)
from treestroke.core.imaging.outline import fill_outline
from treestroke.core.progress import Report, silent
from treestroke.core.segment.contrast import stands_out
from treestroke.core.segment.height import LIMIT, log_odds_by_height
from treestroke.core.segment.kind import Look, foliage_look
from treestroke.core.types import Floats, Mask, Picture

REFERENCE_SIDE = 1500
"""Long side of a photo, px, for which the paper gives its pixel constants."""


BLUR_PX = 2.0
"""Blur of the odds before mixtures are fitted anew: a cheap stand-in for the cut."""
GLARE = 4.0
"""Times the foliage's usual brightness over which a pixel is none of it."""
PURE_ODDS = 0.0
"""Log odds over which a pixel's colour alone tells a leaf."""


@dataclass(frozen=True)
class FoliageParams:
    """How foliage is told from its background.

    Attributes
    ----------
    components
        Gaussians over the crown's colours.
    dilation_px
        How far beyond the stroke foliage is looked for, px at a long side of 1500.
    smoothness
        The paper's lambda: cost of a border between two pixels times the difference of their colours.
    samples
        Pixels that a mixture is fitted to.
    refits
        How often the mixtures are fitted anew to what they told apart.
    cut_pixels
        Pixels of the coarse graph; finer borders are cut in a band.
    pore_share
        Holes as wide as this share of the crown are shade among leaves, no gaps.
    """

    components: int = 12
    dilation_px: float = 10.0
    smoothness: float = 60.0
    samples: int = 6000
    refits: int = 2
    cut_pixels: int = 120_000
    pore_share: float = 0.01

    def __post_init__(self) -> None:
        if self.components < 2 or self.samples < 100 or self.cut_pixels < 1000:
            raise ValueError(f"foliage needs 2 components, 100 samples and 1000 pixels at least: {self}")
        if self.dilation_px < 0 or self.smoothness < 0:
            raise ValueError(f"dilation and smoothness cannot be negative: {self}")


@dataclass(frozen=True, eq=False)
class Foliage:
    """What the crown stroke gave.

    Attributes
    ----------
    mask
        (h, w) leaf pixels (of a bare tree: twigs).
    pure
        (h, w) those that by their own colour are leaves, with nothing shining through.
    region
        (h, w) where foliage was looked for: the crown, a little dilated.
    leaf, ground
        Colour models of the foliage and of all else near it.
    look
        How the leaves look, for judging what they are.
    sureness
        How sure it is that they are leaves and not bare twigs, or the other way round, 0 to 1.
    clear
        Whether the crown stands out from what is around it.
    """

    mask: Mask
    pure: Mask
    region: Mask
    leaf: Mixture
    ground: Mixture
    look: Look
    sureness: float
    clear: bool


def segment_foliage(
    photo: Picture, crown_px: Floats, params: FoliageParams = FoliageParams(), report: Report = silent
) -> Foliage:
    """Find the foliage inside a crown stroke (n, 3 points at least), px, on a photo (h, w, 3), sRGB.

    The mask is never empty: where nothing looks like a leaf it is the crown itself.
    """
    height, width = photo.shape[:2]
    crown = fill_outline(crown_px, height, width)
    box = _surroundings(crown)
    inside, pixels = crown[box], np.ascontiguousarray(photo[box])
    grow_px = params.dilation_px * max(height, width) / REFERENCE_SIDE
    region = cv2.distanceTransform((~inside).astype(np.uint8), cv2.DIST_L2, 5) <= grow_px
    leaf, ground = _colour_models(pixels, inside, params)
    report("foliage", 0.2)
    place = _place_prior(inside)
    odds = _log_odds(leaf, ground, pixels)
    for refit in range(params.refits):
        told = inside & (cv2.GaussianBlur(odds + place, (0, 0), BLUR_PX) > 0)
        if not told.any() or told.all():
            break
        leaf, ground = _refit(pixels, told, params)
        odds = log_odds_by_height(leaf, ground, pixels, told)
        report("foliage", 0.2 + 0.5 * (refit + 1) / params.refits)
    found = cut_grid(pixels, odds + place, region, params.smoothness, params.cut_pixels)
    report("foliage", 0.9)
    pure = _alike(found & (odds > PURE_ODDS) & ~_bluish(pixels), pixels)
    found = _without_pores(found, params.pore_share * np.sqrt(inside.sum())) if found.any() else inside
    look, sureness = foliage_look(pixels, found, region)
    mask, sure, searched = (_framed(part, box, crown) for part in (found, pure, region))
    report("foliage", 1.0)
    clear = stands_out(pixels, inside, max(height, width))
    return Foliage(mask, sure, searched, leaf, ground, look, sureness, clear)


def _alike(pure: Mask, pixels: Picture) -> Mask:
    """Drop the pixels that glare among dark foliage: a cloud between the leaves."""
    brightness = np.maximum(pixels[..., 2], np.maximum(pixels[..., 0], pixels[..., 1]))
    usual = float(np.median(brightness[pure])) if pure.any() else 255.0
    return np.asarray(pure & (brightness <= GLARE * usual + 30))


def _bluish(pixels: Picture) -> Mask:
    """Tell where blue outshines red and green: sky shines through, or on."""
    return np.asarray(pixels[..., 2] > 1.04 * np.maximum(pixels[..., 0], pixels[..., 1]))


def _framed(part: Mask, box: tuple[slice, slice], frame: Mask) -> Mask:
    """Set a box's mask back in its frame."""
    whole = np.zeros_like(frame)
    whole[box] = part
    return whole


def _without_pores(found: Mask, width_px: float) -> Mask:
    """Fill the holes of a mask whose area is at most that of a square ``width_px`` wide."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats((~found).astype(np.uint8), connectivity=4)
    small = np.zeros(count, dtype=bool)
    small[1:] = stats[1:, cv2.CC_STAT_AREA] <= width_px**2
    return np.asarray(found | small[labels])


def _surroundings(crown: Mask) -> tuple[slice, slice]:
    """Give the crown's box with a fifth of its size around it."""
    rows, columns = np.flatnonzero(crown.any(axis=1)), np.flatnonzero(crown.any(axis=0))
    edge = max(4, int(0.2 * max(len(rows), len(columns))))
    top, left = max(0, rows[0] - edge), max(0, columns[0] - edge)
    return slice(top, rows[-1] + 1 + edge), slice(left, columns[-1] + 1 + edge)


def _colour_models(pixels: Picture, inside: Mask, params: FoliageParams) -> tuple[Mixture, Mixture]:
    """Share the crown's components out between leaf and ground, and let the ring around the crown join the ground."""
    crown, ring = _sample(pixels, inside, params.samples), _sample(pixels, ~inside, params.samples)
    core = _sample(pixels, _depth(inside) > 0.45, params.samples)
    mixture = fit_mixture(crown, params.components)
    belief = _leaf_belief(mixture, crown, core, ring)
    share = float((mixture.weights * (1 - belief)).sum())
    grounds = [(_weighted(mixture, 1 - belief), max(share, 0.15))]
    if len(ring):
        grounds.append((fit_mixture(ring, params.components // 2), 0.5))
    return _weighted(mixture, belief), join_mixtures([m for m, _ in grounds], [share for _, share in grounds])


def _weighted(mixture: Mixture, belief: Floats) -> Mixture:
    """Weigh each component by a belief (k,) in it."""
    weights = mixture.weights * belief
    return Mixture(weights / weights.sum(), mixture.means, mixture.covariances)


def _refit(pixels: Picture, told: Mask, params: FoliageParams) -> tuple[Mixture, Mixture]:
    """Fit leaf and ground anew to what was told to be leaves (h, w) and what was not.

    This is what makes the answer hold still when the hand trembles: the first guess depends on where the stroke
    runs, its fixed point hardly does.
    """
    leaf, ground = _sample(pixels, told, params.samples), _sample(pixels, ~told, params.samples)
    return fit_mixture(leaf, params.components // 2), fit_mixture(ground, params.components // 2 + 4)


def _sample(pixels: Picture, where: Mask, count: int) -> NDArray[np.uint8]:
    """Take at most ``count`` pixels, evenly spaced in reading order."""
    index = np.flatnonzero(where.ravel())
    step = max(1, len(index) // count)
    return pixels.reshape(-1, 3)[index[step // 2 :: step]]


def _depth(inside: Mask) -> Floats:
    """Depth of each pixel inside the crown: 0 at its border and outside, 1 at its innermost."""
    padded = cv2.copyMakeBorder(inside.astype(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    away = cv2.distanceTransform(padded, cv2.DIST_L2, 5)[1:-1, 1:-1]
    return np.asarray(away / max(float(away.max()), 1.0), dtype=np.float64)


def _leaf_belief(mixture: Mixture, crown: Picture, core: Picture, ring: Picture) -> Floats:
    """Belief (k,), 0 to 1, that a component is leaves.

    A component speaks for leaves by how much commoner it is in the crown's core than in the ring around the
    crown, and by its hue.
    """
    shares = [_shares(mixture, colours) for colours in (crown, core, ring)]
    place = np.log((0.3 * shares[0] + 0.7 * shares[1] + 0.004) / (shares[2] + 0.004))
    votes = np.clip(place, -2.0, 2.0) + _hue_prior(mixture.means)
    return np.asarray(1 / (1 + np.exp(-4.0 * votes)))


def _shares(mixture: Mixture, colours: Picture) -> Floats:
    """Share of the colours that each component explains (k,)."""
    if len(colours) == 0:
        return np.zeros(len(mixture))
    return np.asarray(component_shares(mixture, colours.astype(np.float64)).mean(axis=0))


def _hue_prior(means: Floats) -> Floats:
    """How much a colour (k, 3) looks like a leaf (k,): green, yellow and red do, sky does not."""
    red, green, blue = means.T
    brightness = means.max(axis=1)
    vegetation = (np.maximum(red, green) - blue) / np.maximum(brightness, 40.0)
    sky = (blue - np.minimum(red, green)) / np.maximum(brightness, 40.0)
    return np.asarray(1.5 * np.clip(vegetation, 0, 0.6) - 6.0 * np.clip(sky - 0.2, 0, 0.6) * (brightness > 60))


def _log_odds(leaf: Mixture, ground: Mixture, pixels: Picture) -> NDArray[np.float32]:
    """Log odds that each pixel (h, w) is a leaf, by its colour, within +-8."""
    colours = table_colours()
    table = np.clip(log_density(leaf, colours) - log_density(ground, colours), -LIMIT, LIMIT)
    return table.astype(np.float32)[table_index(pixels)]


def _place_prior(inside: Mask) -> NDArray[np.float32]:
    """Log odds by place (h, w): the stroke is loose, so its rim and what lies beyond it is rather ground."""
    depth = _depth(inside)
    return np.where(inside, 0.7 - 1.8 * np.exp(-depth / 0.06), -2.0).astype(np.float32)
