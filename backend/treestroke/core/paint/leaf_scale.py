"""How long leaves are in a photo: as far as its light and dark go together."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.paint.species import Species
from treestroke.core.types import Indices, Mask, Opacity, Picture

CLUMP = 1.5
"""Side of the window whose mean lightness is a clump's, over that of a spray."""
RELATED = 0.3
"""Correlation of lightness below which two places are taken for different leaves: lower ones depend on the window."""
LEAF_OVER_REACH = 3.5
"""Length of a leaf over the distance at which correlation has fallen to `RELATED`: most leaves are hidden in part, and
narrower than long (leaves of seven photos, measured by hand: 2.8 to 7)."""
LENGTHS = (0.7, 2.1)
"""Least and greatest length of a leaf that is seen, over its species' in a spray."""
LONGEST = 0.56
"""Greatest length of a leaf, a share of the spray's side: several must fit."""
FURTHEST_PX = 24
"""Greatest distance at which places are compared, px."""
INNER = 0.9
"""Least cover of a pixel, and of its neighbours, that is compared: gaps and edges before the sky tell nothing."""
WINDOW_PX = 640
"""Longest side of the part of the foliage that is compared, px: of large photos the middle."""
FEWEST = 500
"""Fewest pixels from which a correlation is told."""


def leaf_length_px(photo: Picture, cover: Opacity | Mask, spray_px: float) -> float | None:
    """Measure a leaf's usual length, px, in a photo (h, w, 3), sRGB; None where too little of it can be compared.

    ``cover`` (h, w) is the share of each pixel that shows a leaf in its own colour, ``spray_px`` a spray's side. Leaves
    that a photo does not resolve seem as long as its blur.

    Source: the correlation length of a random field, of lightness less that of clumps; its relation to a leaf is ours.
    """
    covered = np.asarray(cover >= np.float32(INNER))
    box = _middle(np.flatnonzero(covered.any(axis=1))), _middle(np.flatnonzero(covered.any(axis=0)))
    weight = np.asarray(cv2.erode(covered[box].astype(np.float32), np.ones((3, 3), np.uint8)), dtype=np.float32)
    if np.count_nonzero(weight) < FEWEST:
        return None
    lightness = cv2.cvtColor(np.ascontiguousarray(photo[box]), cv2.COLOR_RGB2LAB)[..., 0].astype(np.float32)
    detail = _detail(lightness, weight, CLUMP * spray_px)
    variance, before = float((detail * detail).sum() / weight.sum()), 1.0
    if variance == 0:
        return None
    for distance in range(1, FURTHEST_PX + 1):
        correlation = _covariance(detail, weight, distance) / variance
        if correlation < RELATED:
            return LEAF_OVER_REACH * (distance - 1 + (before - RELATED) / (before - correlation))
        before = correlation
    return LEAF_OVER_REACH * FURTHEST_PX


def bounded_length(seen: float, species: Species) -> float:
    """Bound the length of a leaf that is seen, a share of the spray's side, by that of its species."""
    least, most = (factor * species.length for factor in LENGTHS)
    return min(max(seen, least), most, LONGEST)


def _middle(places: Indices) -> slice:
    """Range from the first to the last of the places (n,), in rising order, or `WINDOW_PX` in its middle."""
    if len(places) == 0:
        return slice(0, 1)
    first, end = int(places[0]), int(places[-1]) + 1
    cut = max(0, end - first - WINDOW_PX)
    return slice(first + cut // 2, end - (cut - cut // 2))


def _detail(lightness: NDArray[np.float32], weight: NDArray[np.float32], clump_px: float) -> NDArray[np.float32]:
    """Lightness (h, w) less that of its clump where weight (h, w) is 1, 0 elsewhere."""
    side = 2 * max(1, round(0.5 * clump_px)) + 1
    total, share = (cv2.blur(part, (side, side)) for part in (lightness * weight, weight))
    return np.asarray((lightness - total / np.maximum(share, np.float32(1e-6))) * weight)


def _covariance(detail: NDArray[np.float32], weight: NDArray[np.float32], distance: int) -> float:
    """Covariance of detail (h, w) with itself, ``distance`` px to the right and below, where both weights are 1."""
    pairs = ((np.s_[:, distance:], np.s_[:, :-distance]), (np.s_[distance:], np.s_[:-distance]))
    total = sum(float(np.vdot(detail[a], detail[b])) for a, b in pairs)
    return total / max(sum(float(np.vdot(weight[a], weight[b])) for a, b in pairs), 1.0)
