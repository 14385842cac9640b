"""Wood in the crown of a bare tree: which share of each pixel limbs and twigs cover.

A crown stroke alone tells leaves from what is around them only where leaves fill the crown. In a bare crown most
pixels are background; but all wood there is seen, and the trunk's stroke tells its colours.
"""

from dataclasses import replace

import cv2
import numpy as np

from treestroke.core.imaging.mixture import (
    Mixture,
    fit_mixture,
    join_mixtures,
    log_density,
    table_colours,
    table_index,
)
from treestroke.core.segment.foliage import HALF, Foliage
from treestroke.core.segment.matte import matte
from treestroke.core.types import Floats, Mask, Opacity, Picture

WOOD_COMPONENTS, GROUND_COMPONENTS, OTHER_COMPONENTS = 5, 12, 8
"""Components of the colours of wood, of what is beside the crown, and of what is between its twigs."""
SAMPLES = 2500
"""Approximate number of pixels that a mixture is fitted to."""
APART = 2.0
"""Log odds from which on a colour is wood rather than background: below it, it is as common beside the crown."""
BESIDE = 0.2
"""How far beside the tree the background is learnt, as a share of the crown's size."""
UNDER, CLEAR = 0.004, 0.1
"""Breadth of the stroke that is wood, and breadth along it where there may be some, as shares of the picture's size."""
BEHIND = 0.3
"""Share of the colours beside the crown in those between its twigs."""
MIN_LEARNT = 200
"""Least number of pixels of the crown that teach what wood and background look like there."""
MAX_ODDS = 6.0
"""Limit of the log odds in both directions."""
MOST_COVER = 0.48
"""Greatest share of a bare crown that wood covers: over more, it cannot be told from the background (0.18 to 0.40 on 10
photos where it can)."""
LOWEST, LEAST_OF_TRUNK = 0.33, 0.75
"""Lowest share of the trunk's stroke in the crown by which wood is judged, as a stroke may go on between limbs where
the trunk forks; and least share of it that must be found as wood (0.89 to 1 where wood can be told; 0.43 where a slope
was taken for it)."""


def wood_in_crown(foliage: Foliage, photo: Picture, trunk_px: Floats) -> Foliage | None:
    """Return the foliage of a bare tree with the wood in its crown in place of leaves, by the trunk's stroke.

    None where wood and background cannot be told apart. ``photo`` (h, w, 3) and ``trunk_px`` (n, 2) are those of
    `wood_matte`.
    """
    alpha = wood_matte(photo, foliage.region, trunk_px)
    covered = alpha > HALF
    trunk = foliage.region & _drawn(trunk_px, covered.shape, max(2, round(UNDER * max(covered.shape))))
    on_trunk = covered[trunk][int((1 - LOWEST) * trunk.sum()) :]
    is_told = not len(on_trunk) or on_trunk.mean() > LEAST_OF_TRUNK
    if not is_told or not covered.any() or covered[foliage.region].mean() > MOST_COVER:
        return None
    return replace(foliage, alpha=alpha, mask=covered, pure=covered)


def wood_matte(photo: Picture, crown: Mask, trunk_px: Floats) -> Opacity:
    """Estimate the share (h, w) of each pixel of a bare crown (h, w) that wood covers; 0 outside the crown.

    Wood has the colours of a photo (h, w, 3), sRGB, under the trunk's stroke, a line (n, 2), px; what is seen beside
    the tree is background. Colours that are common in both are background, as a stroke crosses some. What these tell
    apart in the crown gives both their colours anew, as in GrabCut (Rother, Kolmogorov and Blake 2004, section 3), and
    the odds a matte.
    """
    box = _around(crown, trunk_px)
    pixels, inside = np.ascontiguousarray(photo[box]), crown[box]
    trunk = trunk_px - (box[1].start, box[0].start)
    under = _drawn(trunk, inside.shape, max(2, round(UNDER * max(inside.shape))))
    beside = ~inside & ~_drawn(trunk, inside.shape, round(CLEAR * max(inside.shape)))
    share = np.zeros(crown.shape, dtype=np.float32)
    if not beside.any():
        return share
    ground, wood = _fitted(pixels[beside], GROUND_COMPONENTS), _fitted(pixels[under], WOOD_COMPONENTS)
    differs = log_density(wood, wood.means) - log_density(ground, wood.means) > APART
    table = _odds(wood.select(differs) if differs.any() else wood, ground)
    index = table_index(pixels)
    odds = table[index[inside]]
    found, left = pixels[inside][odds > APART], pixels[inside][odds <= APART]
    if min(len(found), len(left)) > MIN_LEARNT:
        others = join_mixtures([_fitted(left, OTHER_COMPONENTS), ground], [1 - BEHIND, BEHIND])
        table = _odds(_fitted(found, WOOD_COMPONENTS), others)
    likely = (1 / (1 + np.exp(-table))).astype(np.float32)
    share[box] = matte(pixels, likely[index], inside)
    return share


def _around(crown: Mask, trunk_px: Floats) -> tuple[slice, slice]:
    """Rows and columns of the crown (h, w) and the trunk, with what is beside both."""
    x, y, width, height = cv2.boundingRect(crown.astype(np.uint8))
    corners = np.vstack([[x, y], [x + width, y + height], trunk_px])
    margin = BESIDE * max(width, height)
    left, top = np.maximum(corners.min(axis=0) - margin, 0).astype(int).tolist()
    right, bottom = (corners.max(axis=0) + margin).astype(int).tolist()
    return slice(top, min(bottom, crown.shape[0])), slice(left, min(right, crown.shape[1]))


def _drawn(line_px: Floats, shape: tuple[int, ...], breadth_px: int) -> Mask:
    """Draw a line (n, 2), px, as a mask (h, w)."""
    drawn = np.zeros(shape, dtype=np.uint8)
    cv2.polylines(drawn, [np.floor(line_px).astype(np.int32)], False, 1, breadth_px)
    return drawn.astype(bool)


def _fitted(pixels: Picture, components: int) -> Mixture:
    """Fit a mixture to about `SAMPLES` of the pixels (n, 3)."""
    return fit_mixture(pixels[:: max(1, len(pixels) // SAMPLES)], components)


def _odds(wood: Mixture, others: Mixture) -> Floats:
    """Return the log odds of wood for each colour of the colour table."""
    colours = table_colours()
    return np.clip(log_density(wood, colours) - log_density(others, colours), -MAX_ODDS, MAX_ODDS)
