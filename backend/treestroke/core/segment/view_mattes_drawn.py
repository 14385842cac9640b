"""What a stroked shot shows of the tree: its crown as in a single photo, and the trunk below."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from treestroke.core.imaging.grid_cut import cut_grid
from treestroke.core.imaging.mixture import Mixture, fit_mixture, log_density, table_colours, table_index
from treestroke.core.segment.bare import wood_in_crown, wood_matte
from treestroke.core.segment.border_edges import share_without_edge
from treestroke.core.segment.foliage import HALF, Foliage, segment_foliage
from treestroke.core.segment.kind import kind_odds, likeliest
from treestroke.core.strokes import Stroke, Strokes
from treestroke.core.types import Floats, Mask, Opacity, Picture

TRUNK_REACH, TRUNK_LINE = 0.045, 0.006
"""Half the breadth along a trunk's stroke in which its trunk is looked for, and the breadth that surely is trunk, as
shares of the tree's height."""
BESIDE = 0.16
"""How far beside the trunk its background is learnt, likewise."""
INTO_CROWN = 0.1
"""How far into the crown the trunk counts as below it, as a share of the crown's height."""
WOOD_COMPONENTS, GROUND_COMPONENTS = 5, 10
SAMPLES = 4000
SMOOTHNESS = 40.0
CUT_PIXELS = 60_000
ERASED = 0.015
"""Breadth of an erasing stroke without a width, as a share of the picture's long side."""
MOST = 5.0
"""Greatest log odds by colour."""
MOST_PLAIN, LEAST_PLAIN = 0.02, 0.08
"""Share of the border without an edge up to which a tree is believed, and from which on it holds background: 0 to 0.03
on 38 trees in leaf, 0.15 and more on thin plants before a cloth."""
BESIDE_STEM, LEAST_OF_STEM = 0.012, 0.85
"""How far beside its stroke, as a share of the photo's long side, a thin stem may be, and least share of the stroke
that must have some."""


@dataclass(frozen=True, eq=False)
class DrawnTree:
    """The tree in a stroked shot.

    Attributes
    ----------
    alpha
        (h, w) share of each pixel that the tree covers.
    stem
        (h, w) the trunk below the crown.
    region
        (h, w) where the tree may be: around the crown and along the trunk; below a crown without a trunk, anywhere.
    bare
        Whether the tree bears no leaves, or is a thin plant of one colour: all that is seen of it is found as wood is.
    """

    alpha: Opacity
    stem: Mask
    region: Mask
    bare: bool


def drawn_tree(photo: Picture, strokes: Strokes) -> DrawnTree:
    """Find the tree that strokes show in a photo (h, w, 3), sRGB: its crown as in a single photo, and its trunk."""
    crown = strokes.crown.points
    foliage = segment_foliage(photo, crown)
    below = np.arange(len(photo))[:, None] > crown[:, 1].max() - INTO_CROWN * np.ptp(crown[:, 1])
    kept = ~_erased(strokes.erase, foliage.region.shape)
    if not strokes.branches:
        return DrawnTree(foliage.alpha * kept, np.zeros_like(foliage.mask), (foliage.region | below) & kept, False)
    trunk_px = strokes.branches[0].points
    bare = likeliest(kind_odds(foliage.cues, crown, trunk_px)) == "bare"
    wood = wood_in_crown(foliage, photo, trunk_px) if bare else None
    thin = None if wood is not None else _thin_plant(foliage, photo, trunk_px)
    if thin is not None:  # its stroke runs beside so thin a stem as often as on it
        return DrawnTree(thin.alpha * kept, np.zeros_like(thin.mask), foliage.region & kept, True)
    foliage = wood or foliage
    near, trunk = _trunk(photo, foliage, trunk_px)
    alpha = np.maximum(foliage.alpha, trunk) * kept
    return DrawnTree(alpha, trunk & below & kept, (foliage.region | near) & kept, wood is not None)


def _thin_plant(foliage: Foliage, photo: Picture, stem_px: Floats) -> Foliage | None:
    """Return what has the colours of the stem's stroke (n, 2), px, where the crown is mostly background.

    A plant that covers little of its crown's outline is lost in what is seen between its branches: that is taken for
    foliage, and ends where the photo shows no edge. None where it ends at edges, or the stem's colours tell no better.
    """
    if share_without_edge(photo, foliage.covered, foliage.region) < LEAST_PLAIN:
        return None
    alpha = wood_matte(photo, foliage.region, stem_px)
    covered = alpha > HALF
    on_stem = _distance(stem_px, covered.shape) < 1
    side = 2 * round(BESIDE_STEM * max(covered.shape)) + 1
    near = cv2.dilate(covered.astype(np.uint8), np.ones((side, side), np.uint8)) > 0
    told = near[on_stem & foliage.region].mean() >= LEAST_OF_STEM if (on_stem & foliage.region).any() else False
    if not told or share_without_edge(photo, covered, foliage.region) > MOST_PLAIN:
        return None
    return replace(foliage, alpha=alpha, mask=covered, pure=covered)


def _trunk(photo: Picture, foliage: Foliage, stem_px: Floats) -> tuple[Mask, Mask]:
    """Return where the trunk of a stroke (n, 2), px, may be, and where it is: masks (h, w)."""
    rows = np.flatnonzero(foliage.region.any(axis=1))
    height = max(float(stem_px[:, 1].max()) - rows[0], 1.0)
    away = _distance(stem_px, foliage.region.shape)
    foot = np.arange(len(away))[:, None] <= stem_px[:, 1].max()
    near = (away <= TRUNK_REACH * height) & foot
    line = away <= 0.5 * TRUNK_LINE * height
    beside = (away > TRUNK_REACH * height) & (away < BESIDE * height) & ~foliage.region
    if not beside.any():
        return near, line
    ground = _fitted(photo[beside], GROUND_COMPONENTS)
    found = line & foot
    for _ in range(2):
        odds = _odds(_fitted(photo[found], WOOD_COMPONENTS), ground)[table_index(photo)]
        odds = odds + 3.0 * (1 - away / (0.35 * TRUNK_REACH * height))
        odds[line] = 3 * MOST
        found = cut_grid(photo, odds.astype(np.float32), near, SMOOTHNESS, CUT_PIXELS)
    return near, found


def _erased(strokes: Sequence[Stroke], shape: tuple[int, ...]) -> Mask:
    """Return what erasing strokes cover (h, w)."""
    drawn = np.zeros(shape, dtype=np.uint8)
    for stroke in strokes:
        breadth = max(1, round(ERASED * max(shape) if stroke.width is None else stroke.width))
        cv2.polylines(drawn, [np.floor(stroke.points).astype(np.int32)], False, 1, breadth)
    return drawn.astype(bool)


def _distance(line_px: Floats, shape: tuple[int, ...]) -> Opacity:
    """Distance (h, w), px, of each pixel from a line (n, 2), px."""
    drawn = np.ones(shape, dtype=np.uint8)
    cv2.polylines(drawn, [np.floor(line_px).astype(np.int32)], False, 0)
    return np.asarray(cv2.distanceTransform(drawn, cv2.DIST_L2, 5))


def _fitted(pixels: Picture, components: int) -> Mixture:
    return fit_mixture(pixels[:: max(1, len(pixels) // SAMPLES)], components)


def _odds(wood: Mixture, ground: Mixture) -> Floats:
    """Log odds of wood for each colour of the colour table."""
    colours = table_colours()
    return np.clip(log_density(wood, colours) - log_density(ground, colours), -MOST, MOST)
