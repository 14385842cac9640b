"""How sprays of conifers sit on their branches: needles in flat layers, scales as upright plumes."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.leaf.arrangement import Poses, Seats
from treestroke.core.types import Floats, FoliageKind


@dataclass(frozen=True)
class Posture:
    """How a spray stands.

    Attributes
    ----------
    aside, rise
        Weights, beside 1 for the branch's direction, of a direction across the branch and of the vertical in the
        spray's own direction.
    level
        Weight of the vertical, beside 1 for the way out of the crown, in the direction that the spray faces.
    scatter
        Standard deviation of that direction.
    stand_off
        How far a spray's foot stands off its branch, in halves of the spray's side: side twigs that are not drawn.
    """

    aside: float
    rise: float
    level: float
    scatter: float
    stand_off: float


POSTURES: dict[FoliageKind, Posture] = {
    "needles": Posture(aside=0.7, rise=-0.2, level=0.8, scatter=0.4, stand_off=0.3),
    "scales": Posture(aside=0.8, rise=0.9, level=0.15, scatter=0.45, stand_off=0.6),
}
"""Judged on renders of four conifers from six sides."""


def pose_conifer_sprays(
    seats: Seats, half_sizes: Floats, crown_middle: Floats, posture: Posture, rng: np.random.Generator
) -> Poses:
    """Set a spray on each of n seats, along its branch and to its sides; a flat one lies level like its layer.

    ``half_sizes`` (n,) and ``crown_middle`` (3,) are in metres.
    """
    n = len(seats)
    side = unit(np.cross(seats.directions, UP), np.array([1.0, 0.0, 0.0]))
    turn = rng.uniform(-1.0, 1.0, (n, 1))
    depth = rng.normal(0, 0.35, (n, 1)) * np.cross(side, seats.directions)
    around = turn * side + depth
    axis = unit(seats.directions + posture.aside * around + (posture.rise + rng.normal(0, 0.12, (n, 1))) * UP, UP)
    foot = seats.points + posture.stand_off * rng.random((n, 1)) * half_sizes[:, None] * around
    centres = foot + 0.8 * half_sizes[:, None] * axis
    facing = unit(centres - crown_middle, UP) + posture.level * UP + rng.normal(0, posture.scatter, (n, 3))
    right = unit(np.cross(axis, facing), UP)
    return Poses(centres, right * half_sizes[:, None], axis * half_sizes[:, None])
