"""How sprays stand on trees of their own look: flat boughs, round brushes, upright plumes, pads, hanging shoots.

All were judged on renders of six conifers and a willow from six sides.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.leaf.arrangement import Poses, Seats
from treestroke.core.leaf.leaf_crown import FITTING
from treestroke.core.types import Floats, FoliageKind, TreeForm


@dataclass(frozen=True)
class Posture:
    """How a spray stands.

    Attributes
    ----------
    aside, rise
        Weights, beside 1 for the branch's direction, of a direction across the branch and of the vertical in the
        spray's own direction.
    tilt
        Standard deviation of the vertical's weight.
    level
        Weight of the vertical, beside 1 for the way out of the crown, in the direction that the spray faces.
    scatter
        Standard deviation of that direction.
    stand_off
        How far a spray's foot stands off its branch, in halves of the spray's side: side twigs that are not drawn.
    slimness
        Length of its card over its width; the area stays.
    inside
        Share of its card's opaque dots that must lie in the foliage.
    """

    aside: float
    rise: float
    level: float
    scatter: float
    stand_off: float
    tilt: float = 0.2
    slimness: float = 1.0
    inside: float = FITTING


BOUGH = Posture(aside=0.6, rise=-0.3, level=0.4, scatter=0.45, stand_off=0.3, tilt=0.5, slimness=2.0)
"""Short needles in flat layers, those of a bough above each other."""
BRUSH = Posture(aside=0.8, rise=0.3, level=0.2, scatter=0.6, stand_off=0.5)
"""Long needles, which stand off to all sides."""
PLUME = Posture(aside=0.8, rise=0.9, level=0.15, scatter=0.45, stand_off=0.8, slimness=2.5)
"""Scales on a tree that rises."""
PAD = Posture(aside=1.2, rise=0.4, level=0.8, scatter=0.5, stand_off=2.0, slimness=2.0)
"""Scales in flat pads about the limbs."""
HANGING = Posture(aside=0.35, rise=-2.2, level=0.0, scatter=0.3, stand_off=1.2, slimness=10.0, inside=0.6)
"""Leaves on long shoots that hang, many of them out of the crown below: its lower edge is no line."""


def posture_of(kind: FoliageKind, form: TreeForm) -> Posture | None:
    """Return how the sprays of a kind stand on a tree of a form; None for broad leaves, which have no own look."""
    match kind:
        case "needles":
            return BOUGH if form == "spire" else BRUSH
        case "scales":
            return PLUME if form in ("spire", "columnar") else PAD
        case "leaves" if form == "weeping":
            return HANGING
    return None


def pose_by_posture(
    seats: Seats, half_sizes: Floats, crown_middle: Floats, posture: Posture, rng: np.random.Generator
) -> Poses:
    """Set a spray on each of n seats as its posture has it, to the sides of its branch.

    ``half_sizes`` (n,) and ``crown_middle`` (3,) are in metres.
    """
    n = len(seats)
    side = unit(np.cross(seats.directions, UP), np.array([1.0, 0.0, 0.0]))
    turn = rng.uniform(-1.0, 1.0, (n, 1))
    depth = rng.normal(0, 0.35, (n, 1)) * np.cross(side, seats.directions)
    around = turn * side + depth
    axis = unit(
        seats.directions + posture.aside * around + (posture.rise + rng.normal(0, posture.tilt, (n, 1))) * UP, UP
    )
    long, wide = np.sqrt(posture.slimness), 1 / np.sqrt(posture.slimness)
    foot = seats.points + posture.stand_off * rng.random((n, 1)) * half_sizes[:, None] * around
    centres = foot + 0.8 * long * half_sizes[:, None] * axis
    facing = unit(centres - crown_middle, UP) + posture.level * UP + rng.normal(0, posture.scatter, (n, 3))
    right = unit(np.cross(axis, facing), UP)
    return Poses(centres, wide * right * half_sizes[:, None], long * axis * half_sizes[:, None])
