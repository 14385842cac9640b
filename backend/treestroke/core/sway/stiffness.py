"""How far a tree's bones turn and swing in the wind, by the thickness of their wood."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.sway.motion import Rig
from treestroke.core.types import Floats

_SLENDER = 1.25  # exponent of the radius by which angles fall: twigs move some centimetres where the trunk moves one
_THIN = 0.03  # of the greatest radius: thinner wood is hardly softer


def thickness(rig: Rig) -> Floats:
    """Return the radius of each bone's wood (b,) as a share of the tree's greatest, 0 to 1."""
    return rig.radii / max(float(rig.radii.max()), 1e-9)


def softness(rig: Rig) -> Floats:
    """Return the relative angle (b,) by which each bone turns, a factor: 1 for the thickest wood, more for thinner.

    All others have 0.
    """
    soft = ((1.0 + _THIN) / (thickness(rig) + _THIN)) ** _SLENDER
    return np.where(moving_branches(rig), soft, 0.0)


def moving_branches(rig: Rig) -> NDArray[np.bool_]:
    """Return the mask (b,) of the bones that are branches: neither the root, nor for flutter, nor tips."""
    return np.array([name.startswith("branch") for name in rig.names])


def fluttering(rig: Rig) -> NDArray[np.bool_]:
    """Return the mask (b,) of the bones for the flutter of leaves."""
    return np.array([name.startswith("flutter") for name in rig.names])


def swing_amplitudes(rig: Rig, turns: Floats) -> Floats:
    """Estimate how far each bone's end swings (b,), metres, when bones turn by ``turns`` (b,), radians.

    Bones turn independently, so the squares of what the bones on the path to the root contribute add up. Why bones only
    turn: docs/decisions/0012.
    """
    squares = np.zeros(len(turns))
    for bone in range(1, len(turns)):
        at, total = bone, 0.0
        while at > 0:
            total += (turns[at] * float(np.linalg.norm(rig.ends[bone] - rig.heads[at]))) ** 2
            at = int(rig.parents[at])
        squares[bone] = total
    return np.sqrt(squares)
