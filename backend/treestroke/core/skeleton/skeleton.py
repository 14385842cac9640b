"""The Skeleton: the data structure that all stages share."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.types import Floats, Indices


@dataclass(frozen=True, eq=False)
class Skeleton:
    """A tree (or several stems) of joints with radii.

    ======  ==========================================================================
    letter  meaning
    ======  ==========================================================================
    n       joints, at least 1
    d       2 in the photo (px, x right, y down) or 3 in the world (metres, Y up)
    root    a joint without parent; joint 0 is one, further roots are further stems
    tip     a joint without child
    fork    a joint with two or more children
    edge i  the straight piece from joint ``parents[i]`` to joint ``i``
    ======  ==========================================================================

    Columns are those of SWC files. Arrays are read-only; the invariants are checked once, here.

    Attributes
    ----------
    points
        (n, d) positions.
    radii
        (n,) radius of the wood at each joint, in the unit of ``points``, not negative.
    parents
        (n,) index of each joint's parent, smaller than its own; -1 at a root.

    Raises
    ------
    ValueError
        Shapes differ, a value is not finite, a radius is negative or a parent does not come first.
    """

    points: Floats
    radii: Floats
    parents: Indices

    def __post_init__(self) -> None:
        points = np.array(self.points, dtype=np.float64)
        radii = np.array(self.radii, dtype=np.float64)
        parents = np.array(self.parents, dtype=np.int64)
        n = len(points)
        if points.ndim != 2 or points.shape[1] not in (2, 3) or n == 0:
            raise ValueError(f"points must be (n, 2) or (n, 3) with n > 0, got {points.shape}")
        if radii.shape != (n,) or parents.shape != (n,):
            raise ValueError(f"{n} points need {n} radii and parents, got {radii.shape} and {parents.shape}")
        if not (np.isfinite(points).all() and np.isfinite(radii).all() and (radii >= 0).all()):
            raise ValueError("points and radii must be finite, radii not negative")
        if parents[0] != -1 or (parents < -1).any() or (parents >= np.arange(n)).any():
            raise ValueError("each parent must come before its child, and joint 0 must be a root")
        for name, array in (("points", points), ("radii", radii), ("parents", parents)):
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    def __len__(self) -> int:
        return len(self.points)
