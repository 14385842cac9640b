"""More matches between photos with known cameras: only features on each other's epipolar lines are compared.

Leaves and bark look alike all over a tree, so a feature's descriptor alone seldom tells which of thousands it is; among
the few on its epipolar line it does.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Indices
from treestroke.engines.matching import clear

_TOLERANCE_PX = 1.5
"""Greatest distance of a match from its epipolar line, px."""
_RATIO = 0.85
"""As the ratio of `match_descriptors`, but among the features on the line."""
_LEAST_PARALLAX_RAD = np.radians(1.5)
_CHUNK = 100_000
"""Candidates whose descriptors are compared at a time."""


class Rays(NamedTuple):
    """What a solved photo sees.

    Attributes
    ----------
    centre
        (3,) where it was taken.
    directions
        (n, 3) unit directions to its features, in the world.
    descriptors
        (n, 128) their descriptors.
    px_rad
        The angle that a pixel covers.
    """

    centre: Floats
    directions: Floats
    descriptors: NDArray[np.float32]
    px_rad: float


def match_along_lines(first: Rays, second: Rays, parallax_rad: tuple[float, float]) -> Indices:
    """Match features of two solved photos: pairs of rows (m, 2).

    ``parallax_rad`` is the range of angles under which the scene's points see the two photos' centres.
    """
    rows, columns = _candidates(first, second, parallax_rad)
    if not len(rows):
        return np.zeros((0, 2), np.int64)
    product = np.concatenate(
        [
            np.einsum("ij,ij->i", first.descriptors[rows[start:end]], second.descriptors[columns[start:end]])
            for start in range(0, len(rows), _CHUNK)
            for end in [start + _CHUNK]
        ]
    )
    best_row, next_row = _two_best(rows, product, len(first.directions))
    best_column, next_column = _two_best(columns, product, len(second.directions))
    mutual = (product == best_row[rows]) & (product == best_column[columns])
    rows, columns, product = rows[mutual], columns[mutual], product[mutual]
    kept = clear(product, np.maximum(next_row[rows], next_column[columns]), _RATIO)
    return np.column_stack([rows[kept], columns[kept]])


def _candidates(first: Rays, second: Rays, parallax_rad: tuple[float, float]) -> tuple[Indices, Indices]:
    """Return the rows (c,) and (c,) of features that may be of one point by their rays.

    Rays that meet lie in one half-plane about the line between the centres: they have the same angle about it.
    """
    baseline = second.centre - first.centre
    axis = baseline / np.linalg.norm(baseline)
    frame = np.linalg.svd(axis[None])[2]
    turn_1, along_1 = _about(axis, frame, first.directions)
    turn_2, along_2 = _about(axis, frame, second.directions)
    order = np.argsort(turn_2, kind="stable")
    sorted_turns = turn_2[order]
    tolerance = _TOLERANCE_PX * first.px_rad / np.maximum(np.sin(along_1), 0.02)
    doubled = np.concatenate([sorted_turns, sorted_turns + 2 * np.pi])  # a half-plane at -pi is near one at pi
    low = np.where(turn_1 - tolerance < -np.pi, turn_1 + 2 * np.pi, turn_1) - tolerance
    begin, end = np.searchsorted(doubled, low), np.searchsorted(doubled, low + 2 * tolerance)
    count = end - begin
    rows = np.repeat(np.arange(len(turn_1)), count)
    within = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    columns = order[(np.repeat(begin, count) + within) % len(order)]
    parallax = along_2[columns] - along_1[rows]
    low_rad, high_rad = max(parallax_rad[0], _LEAST_PARALLAX_RAD), parallax_rad[1]
    kept = (parallax > low_rad) & (parallax < high_rad)
    return rows[kept], columns[kept]


def _about(axis: Floats, frame: Floats, directions: Floats) -> tuple[Floats, Floats]:
    """Return the angles (n,) of directions about an axis, and their angles (n,) from it; ``frame`` rows 1, 2 span."""
    turn = np.arctan2(directions @ frame[2], directions @ frame[1])
    return turn, np.arccos(np.clip(directions @ axis, -1.0, 1.0))


def _two_best(index: Indices, values: NDArray[np.float32], count: int) -> tuple[NDArray[np.float32], ...]:
    """Return the greatest and the second greatest of the values (c,) of each index below ``count``; -1 if missing."""
    order = np.lexsort((-values, index))
    sorted_index, sorted_values = index[order], values[order]
    first = np.flatnonzero(np.diff(sorted_index, prepend=-1))
    best, following = np.full(count, -1.0, np.float32), np.full(count, -1.0, np.float32)
    best[sorted_index[first]] = sorted_values[first]
    second = first[:-1] + 1 if len(first) and first[-1] + 1 >= len(index) else first + 1
    second = second[sorted_index[second] == sorted_index[second - 1]]
    following[sorted_index[second]] = sorted_values[second]
    return best, following
