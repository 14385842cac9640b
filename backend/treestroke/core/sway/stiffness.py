"""How much a tree's bones give in the wind."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.sway.wind import Rig
from treestroke.core.types import Floats

_SLENDER = 1.25  # power of the radius at which the turn falls: twigs move some centimetres where the trunk moves one
_THIN = 0.03  # of the greatest radius: thinner wood is no longer much softer


def thickness(rig: Rig) -> Floats:
    """Radius of each bone's wood over the tree's greatest, 0 to 1 (b,)."""
    return rig.radii / max(float(rig.radii.max()), 1e-9)


def softness(rig: Rig) -> Floats:
    """Give relative angles (b,) that bones turn by: 1 the thickest wood, more thinner, 0 the root and flutter."""
    soft = ((1.0 + _THIN) / (thickness(rig) + _THIN)) ** _SLENDER
    return np.where(moving_branches(rig), soft, 0.0)


def moving_branches(rig: Rig) -> NDArray[np.bool_]:
    """Tell which bones (b,) are branches that turn: neither the root nor flutter."""
    return np.array([name.startswith("branch") for name in rig.names])


def swing(rig: Rig, turns: Floats) -> Floats:
    """Estimate how far each bone's end swings, metres (b,), where bones turn by ``turns`` (b,), rad.

    Each turns in its own time, so of what the bones on the way to the root add the squares add up.
    """
    squares = np.zeros(len(turns))
    for bone in range(1, len(turns)):
        at, total = bone, 0.0
        while at > 0:
            total += (turns[at] * float(np.linalg.norm(rig.ends[bone] - rig.heads[at]))) ** 2
            at = int(rig.parents[at])
        squares[bone] = total
    return np.sqrt(squares)
