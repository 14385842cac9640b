"""Depth retrieval: one 3D tree from the front and the left side of it, drawn apart."""

from dataclasses import dataclass

from treestroke.core.geometry.polyline import Indices
from treestroke.core.skeleton.branched import Branched

PAIRED, COMPLEMENTED, LONE = 0, 1, 2
"""How a joint came: a branch of the front paired with one of the side; one of the side that no pair used, given a
branch of the front; one at a height that the other sketch does not have."""


@dataclass(frozen=True, eq=False)
class Retrieved:
    """A 3D tree that looks like both sketches.

    Attributes
    ----------
    tree
        Its skeleton (n, 3) with branches: x from the front, y up, z from the side; the root is the origin.
    front, side
        (n,) the joint of each sketch that it stands for.
    origin
        (n,) PAIRED, COMPLEMENTED or LONE.
    """

    tree: Branched
    front: Indices
    side: Indices
    origin: Indices
