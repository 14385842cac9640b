"""Models that contradict what their photos show: places that look alike, in two trees' surroundings, were joined.

Two photos of different places may match in a few dozen features, of a paving or a fence. A photo that is placed by
these does not fit its true neighbours any more, with which it has far more matches. Compare Zach, Irschara and
Bischof 2008, "What can missing correspondences tell us about 3D structure and motion?".
"""

from collections.abc import Mapping

import numpy as np
import pycolmap

from treestroke.core.types import Floats
from treestroke.engines.densifying import rays_of
from treestroke.engines.mapping import Matched, Pair, indices_of

_STRONG, _WEAK = 0.3, 0.1
"""Matches of a pair over the most that its photos have with any other: from the first on, for both photos, they surely
show one place; below the second, for both, they may be of two that look alike."""
_FITS_PX = 6.0
"""Greatest distance of a match from its epipolar line in a model that it fits, px."""
_LEAST_FITTING = 0.5
"""Share of a strong pair's matches that fit a right model."""


def contradicts(model: pycolmap.Reconstruction, matched: Matched) -> bool:
    """Tell whether a model has photos elsewhere than many of their matches say."""
    used = set(indices_of(model))
    rays = {index: rays_of(model, matched.views[index], matched.features[index], index) for index in used}
    most = _most(matched.pairs)
    for pair, geometry in matched.pairs.items():
        surely = len(geometry.inlier_matches) >= _STRONG * max(most[index] for index in pair)
        if not surely or not used.issuperset(pair):
            continue
        first, second = (rays[index] for index in pair)
        rows, columns = geometry.inlier_matches.T
        off = _off(first.directions[rows], second.directions[columns], second.centre - first.centre)
        if float((off < _FITS_PX * second.px_rad).mean()) < _LEAST_FITTING:
            return True
    return False


def without_weak(pairs: Mapping[Pair, pycolmap.TwoViewGeometry]) -> dict[Pair, pycolmap.TwoViewGeometry]:
    """Leave out the pairs that have next to no matches beside what both photos have with others."""
    most = _most(pairs)
    return {
        pair: geometry
        for pair, geometry in pairs.items()
        if len(geometry.inlier_matches) >= _WEAK * min(most[index] for index in pair)
    }


def _most(pairs: Mapping[Pair, pycolmap.TwoViewGeometry]) -> dict[int, int]:
    """Return the most matches that each photo, by its index, has with any other."""
    most: dict[int, int] = {}
    for pair, geometry in pairs.items():
        for index in pair:
            most[index] = max(most.get(index, 0), len(geometry.inlier_matches))
    return most


def _off(first: Floats, second: Floats, baseline: Floats) -> Floats:
    """Return how far, radians, unit directions (m, 3) of one photo are from the epipolar planes of another's (m, 3)."""
    normal = np.cross(baseline, first)
    length = np.maximum(np.linalg.norm(normal, axis=1), 1e-12)
    return np.asarray(np.abs((normal * second).sum(axis=1)) / length)
