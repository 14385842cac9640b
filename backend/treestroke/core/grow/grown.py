"""The result of growth, by any method."""

from dataclasses import dataclass

from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Indices


@dataclass(frozen=True, eq=False)
class Grown:
    """A grown tree.

    Attributes
    ----------
    skeleton
        The whole tree, 3D, metres, world frame, with radii by the pipe model.
    born
        (n,) iteration (or level) at which each joint appeared, from 1; 0 for joints of the visible tree.
    choices
        (k, 3) the branch, subtree and angle of each replacement; empty where growth does not replace.
    attractors_reached
        Share of the image attractors within 10 px (of a crown 1,000 px wide) of a branch; 0 without attractors.
    root_swelling
        Least radius of a stem at its root over that above its flare; 1 where the skeleton's radii say it all.
    """

    skeleton: Skeleton
    born: Indices
    choices: Indices
    attractors_reached: float = 0.0
    root_swelling: float = 1.0
