"""How far places of a tree move over time, by the tracks near them.

Tracks disagree: leaves flutter, points jump to other leaves, the background shows through. A place follows what most of
the tracks near it do (iteratively reweighted means; Holland and Welsch 1977 with Cauchy's weights).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from treestroke.core.film.tracks import Tracks
from treestroke.core.types import Floats

NEAR = 0.03
"""Standard deviation of the distance over which tracks are averaged, over the tree's height."""
AMONG = 12
"""Of how many tracks, at least as many as are seen at once."""
_MOST_AMONG = 48
_ODD_PX = 1.5  # rms distance from the others, at 640 px, at which a track counts half
_EXACT_PX = 0.3  # error of a track that agrees with all others
LIVELY = 0.7
"""Quantile of how far the tracks near a place sway, below which they count less, and..."""
STILL = 2.0
"""... by which power: what hardly moves among them is background that is seen through the tree."""
_LEAST = 1e-4  # weight of tracks far away, beside 1
_ROUNDS = 4
_FAR = 3.0  # standard deviations away, nothing is known of a place
_DRIFT_SECONDS = 5.0  # what changes more slowly is drift of the tracks, not sway
_AT_ONCE = 64  # places, to bound memory


@dataclass(frozen=True, eq=False)
class MotionField:
    """How places move.

    Attributes
    ----------
    moved
        (f, n, 2) how far each place is from where it is in the chosen frame, px; there 0.
    error_px
        (n,) standard error of that: by how far tracks disagree, and how many there are; infinite where none is near.
    """

    moved: Floats
    error_px: Floats


def motion_field(tracks: Tracks, places: Floats, height_px: float, chosen: int, seconds: float) -> MotionField:
    """Return how places (n, 2), px of the chosen frame, move in a video of so many seconds.

    ``height_px`` is the tree's height, the unit of what is near.
    """
    if not len(tracks):
        return MotionField(np.zeros((len(tracks.points), len(places), 2)), np.full(len(places), np.inf))
    often = max(float(tracks.seen.mean()), AMONG / _MOST_AMONG)
    count = min(int(np.ceil(AMONG / often)), len(tracks))
    away, near = cKDTree(tracks.rest).query(places, np.arange(1, count + 1))
    spread = NEAR * height_px
    weights = np.exp(-0.5 * (away / spread) ** 2) + _LEAST
    moved, error = np.empty((len(tracks.points), len(places), 2)), np.empty(len(places))
    for first in range(0, len(places), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        moved[:, part], error[part] = _agreed(tracks, near[part], weights[part])
    drift = legvander(np.linspace(-1.0, 1.0, len(moved)), max(1, round(seconds / _DRIFT_SECONDS)))
    flat = moved.reshape(len(moved), -1)
    flat = flat - drift @ np.linalg.lstsq(drift, flat, rcond=None)[0]
    moved = (flat - flat[chosen]).reshape(moved.shape)
    return MotionField(moved, np.where(away[:, 0] > _FAR * spread, np.inf, error))


def _agreed(tracks: Tracks, near: NDArray[np.intp], weights: Floats) -> tuple[Floats, Floats]:
    """Return the mean movement (f, n, 2) of the tracks near each place (n, k), without those that differ; its error."""
    moved, seen = tracks.moved[:, near], tracks.seen[:, near].astype(np.float64)
    often = np.maximum(seen.sum(axis=0), 1.0)
    sways = _sways(tracks)[near]
    most = np.quantile(sways, LIVELY, axis=1, keepdims=True)
    weights = weights * np.minimum(sways / np.maximum(most, 1e-9), 1.0) ** STILL
    liked = np.ones_like(weights)
    mean, spread = np.zeros((*moved.shape[:2], 2)), np.zeros_like(weights)
    for _ in range(_ROUNDS):
        shares = weights * liked * seen
        mean = (shares[..., None] * moved).sum(axis=2) / np.maximum(shares.sum(axis=2), 1e-12)[..., None]
        differs = ((moved - mean[:, :, None]) ** 2).sum(axis=3)
        spread = (differs * seen).sum(axis=0) / often
        liked = seen.mean(axis=0) / (1.0 + spread / _ODD_PX**2)
    counted = weights * liked
    error = np.sqrt((counted**2 * (spread + _EXACT_PX**2)).sum(axis=1)) / np.maximum(counted.sum(axis=1), 1e-12)
    return _without_gaps(mean, np.any(seen, axis=2)), error


def _sways(tracks: Tracks) -> Floats:
    """Return how far each track (k,) sways, px: the standard deviation of where it is seen."""
    seen = tracks.seen[..., None]
    count = np.maximum(seen.sum(axis=0), 1)
    mean = (tracks.moved * seen).sum(axis=0) / count
    return np.asarray(np.sqrt((((tracks.moved - mean) ** 2 * seen).sum(axis=0) / count).sum(axis=1)))


def _without_gaps(moved: Floats, known: Any) -> Floats:
    """Interpolate movements (f, n, 2) in time where nothing is known (f, n)."""
    frames = np.arange(len(moved))
    for place in np.flatnonzero(~known.all(axis=0) & known.any(axis=0)):
        at = known[:, place]
        for axis in range(2):
            moved[~at, place, axis] = np.interp(frames[~at], frames[at], moved[at, place, axis])
    return moved
