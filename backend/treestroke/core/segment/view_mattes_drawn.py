"""What a stroked shot shows of the tree: its crown as in a single photo, and the trunk below."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from treestroke.core.imaging.grid_cut import cut_grid
from treestroke.core.imaging.mixture import Mixture, fit_mixture, log_density, table_colours, table_index
from treestroke.core.segment.bare import wood_in_crown
from treestroke.core.segment.foliage import Foliage, segment_foliage
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
        Whether the tree bears no leaves.
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
    foliage = wood or foliage
    near, trunk = _trunk(photo, foliage, trunk_px)
    alpha = np.maximum(foliage.alpha, trunk) * kept
    return DrawnTree(alpha, trunk & below & kept, (foliage.region | near) & kept, wood is not None)


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
