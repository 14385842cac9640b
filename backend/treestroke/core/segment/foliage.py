"""Foliage from one crown stroke: colour mixtures, a graph cut and a matte.

Source: Tan et al. 2008, section 2, "Foliage extraction". We differ in how colours are divided between leaves and ground
(`leaf_odds.initial_models`): by where they lie, with colour as a prior, so that yellow autumn, white blossom and bare
twigs work too. And the cut tells only roughly where the foliage is; the `matte` tells sky between leaves from leaves.
"""

from dataclasses import dataclass
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.imaging.grid_cut import cut_grid
from treestroke.core.imaging.histogram import median_of_bytes
from treestroke.core.imaging.mixture import Mixture
from treestroke.core.imaging.outline import fill_outline
from treestroke.core.progress import Report, silent
from treestroke.core.segment.contrast import stands_out
from treestroke.core.segment.cues import Cues, crown_cues
from treestroke.core.segment.cut_foliage import cut_foliage
from treestroke.core.segment.leaf_odds import (
    depth_inside,
    initial_models,
    leaf_likelihood,
    log_odds_by_colour,
    log_odds_by_height,
    log_odds_by_place,
    refitted_models,
)
from treestroke.core.segment.matte import matte
from treestroke.core.segment.shaded_leaves import log_odds_by_roughness, roughness
from treestroke.core.types import Floats, Mask, Opacity, Picture

REFERENCE_SIDE = 1500
"""Long side of a photo, px, for which the paper gives its pixel constants."""
BLUR_PX = 2.0
"""Standard deviation of the blur of log odds before models are refitted, px: a cheap substitute for the cut."""
GLARE = 4.0
"""Brightness relative to the foliage's median above which a pixel is not foliage."""
HALF = 0.5
"""Opacity from which on a pixel counts as foliage."""
PURE_ODDS = 0.0
"""Log odds above which a pixel is a leaf by its colour alone."""


Kind = TypeVar("Kind", bound=np.generic)


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
        Number of times that the colour models are refitted to what they separated.
    cut_pixels
        Greatest number of pixels in the coarse graph; at finer levels only a band along the border is cut.
    pore_share
        Holes narrower than this share of the crown are none in the mask, and pieces of foliage as small are left out.
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
    """Foliage found inside a crown stroke.

    Attributes
    ----------
    alpha
        (h, w) share of each pixel that foliage covers; twigs, if the tree is bare.
    mask
        (h, w) pixels that foliage covers by half or more, and small holes between them.
    pure
        (h, w) foliage pixels that are leaves by their own colour, with nothing shining through.
    region
        (h, w) where foliage was looked for: the crown, slightly dilated.
    leaf, ground
        Colour models of the foliage and of everything else near it.
    cues
        What was measured for judging what the tree is.
    clear
        Whether the crown stands out from what is around it.
    """

    alpha: Opacity
    mask: Mask
    pure: Mask
    region: Mask
    leaf: Mixture
    ground: Mixture
    cues: Cues
    clear: bool

    @property
    def covered(self) -> Mask:
        """(h, w) pixels that foliage covers by half or more."""
        return self.alpha > HALF


def segment_foliage(
    photo: Picture,
    crown_px: Floats,
    params: FoliageParams = FoliageParams(),
    report: Report = silent,
    cut_out: Opacity | None = None,
) -> Foliage:
    """Find the foliage inside a crown stroke (n, 2), px, 3 points at least, on a photo (h, w, 3), sRGB.

    The mask is never empty: where nothing looks like a leaf it is the inside of the stroke. ``cut_out`` (h, w) is the
    opacity of a tree that was cut out of its photo: what it covers is taken as it is, and only colours are told apart.

    Source: Tan et al. 2008, section 2; docs/papers.md lists where we differ.
    """
    height, width = photo.shape[:2]
    crown = fill_outline(crown_px, height, width)
    box = _surroundings(crown)
    inside, pixels = crown[box], np.ascontiguousarray(photo[box])
    known = None if cut_out is None else cut_out[box]
    leaf, ground, odds = _told_apart(pixels, inside, known, params, report)
    if known is None:
        inside = inside | cut_foliage(odds, inside)
    dilation_px = params.dilation_px * max(height, width) / REFERENCE_SIDE
    region = cv2.distanceTransform((~inside).astype(np.uint8), cv2.DIST_L2, 5) <= dilation_px
    if known is None:
        odds_there = odds + log_odds_by_place(inside, depth_inside(inside))
        found = cut_grid(pixels, odds_there, region, params.smoothness, params.cut_pixels)
        report("foliage", 0.8)
        likely = leaf_likelihood(pixels, found if found.any() else inside, params.components, params.samples)
        alpha = matte(pixels, likely, region)
    else:
        found, alpha = known * region > HALF, known * region
    if not found.any() or not (alpha > HALF).any():
        found, alpha = inside, inside.astype(np.float32)
    pore = params.pore_share * np.sqrt(inside.sum())
    mask, pure = _without_pores(alpha > HALF, pore), (alpha > HALF) & (odds > PURE_ODDS) & ~_bluish(pixels)
    cues = crown_cues(pixels, _without_pores(found, pore), region, pure)
    pure = _without_glare(pure, pixels)
    mask, pure, region = (_in_frame(part, box, crown.shape) for part in (mask, pure, region))
    report("foliage", 1.0)
    clear = stands_out(pixels, inside, max(height, width))
    return Foliage(_in_frame(alpha, box, crown.shape), mask, pure, region, leaf, ground, cues, clear)


def _told_apart(
    pixels: Picture, inside: Mask, known: Opacity | None, params: FoliageParams, report: Report
) -> tuple[Mixture, Mixture, NDArray[np.float32]]:
    """Fit colour models of leaves and ground; return them and the log odds (h, w) that each pixel is a leaf.

    These go by colour, and in the shade by roughness, too. ``inside`` (h, w) is the stroke's, ``known`` (h, w) the
    foliage's opacity where that is known.
    """
    depth = depth_inside(inside)
    leaf, ground = initial_models(pixels, inside, depth, params.components, params.samples)
    report("foliage", 0.2)
    place, odds = log_odds_by_place(inside, depth), log_odds_by_colour(leaf, ground, pixels)
    for refit in range(params.refits):
        leaves = inside & (cv2.GaussianBlur(odds + place, (0, 0), BLUR_PX) > 0 if known is None else known > HALF)
        if not leaves.any() or leaves.all():
            break
        leaf, ground = refitted_models(pixels, leaves, params.components, params.samples)
        odds = log_odds_by_height(leaf, ground, pixels, leaves)
        report("foliage", 0.2 + 0.5 * (refit + 1) / params.refits)
    if known is None:
        odds += log_odds_by_roughness(roughness(pixels, inside), inside & (odds + place > 0), inside)
    return leaf, ground, odds


def _without_glare(foliage: Mask, pixels: Picture) -> Mask:
    """Drop the pixels (h, w) that glare among dark foliage: clouds between the leaves."""
    brightness = np.maximum(pixels[..., 2], np.maximum(pixels[..., 0], pixels[..., 1]))
    median = median_of_bytes(brightness[foliage]) if foliage.any() else 255.0
    return np.asarray(foliage & (brightness <= GLARE * median + 30))


def _bluish(pixels: Picture) -> Mask:
    """Tell where (h, w) blue exceeds red and green: sky shines through, or lights the leaves."""
    return np.asarray(pixels[..., 2] > 1.04 * np.maximum(pixels[..., 0], pixels[..., 1]))


def _in_frame(part: NDArray[Kind], box: tuple[slice, slice], shape: tuple[int, ...]) -> NDArray[Kind]:
    """Place the map of a box in an empty map of the whole photo's shape."""
    whole = np.zeros(shape, dtype=part.dtype)
    whole[box] = part
    return whole


def _without_pores(found: Mask, width_px: float) -> Mask:
    """Fill the holes of a mask whose area is at most that of a square ``width_px`` wide; then drop pieces as small."""
    filled = found | _pieces(~found, 0.0, width_px)
    return np.asarray(_pieces(filled, width_px, np.inf)) if found.any() else filled


def _pieces(mask: Mask, over_px: float, up_to_px: float) -> Mask:
    """Keep the connected pieces of a mask with areas between those of squares as wide."""
    labels = np.asarray(cv2.connectedComponents(mask.astype(np.uint8), connectivity=4)[1], dtype=np.int32)
    area = np.bincount(labels.reshape(-1))
    kept = (over_px**2 < area) & (area <= up_to_px**2)
    kept[0] = False
    return np.asarray(kept.take(labels))


def _surroundings(crown: Mask) -> tuple[slice, slice]:
    """Rows and columns of the crown's bounding box, enlarged by a fifth of its long side."""
    rows, columns = np.flatnonzero(crown.any(axis=1)), np.flatnonzero(crown.any(axis=0))
    edge = max(4, int(0.2 * max(len(rows), len(columns))))
    top, left = max(0, rows[0] - edge), max(0, columns[0] - edge)
    return slice(top, rows[-1] + 1 + edge), slice(left, columns[-1] + 1 + edge)
