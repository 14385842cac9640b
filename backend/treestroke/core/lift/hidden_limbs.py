"""The limbs that hide behind those that a photo shows.

A bare crown is as full in depth as it is wide, but what lies in one line of sight is seen once. So every limb that is
seen stands for others: copies that begin and project where it does, and that lifting turns to other depths. The front
view stays as it is, and from the side the crown has the same pattern of limbs and twigs.
"""

import numpy as np

from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Indices

THINNER = 0.9
"""Radius of a hidden limb over that of the limb before it, so that it hides."""


def with_hidden_limbs(skeleton: Skeleton, stroke: Indices) -> tuple[Skeleton, Indices]:
    """Add a copy of every limb, with all that it bears, to a traced skeleton (2D, px); stems are not copied.

    ``stroke`` (n,) tells which stroke each joint follows. Returns the skeleton and the traced joint (m,) at whose place
    each joint stands; the first n are the traced ones.
    """
    stems = np.isin(stroke, stroke[skeleton.parents < 0])
    limbs = np.flatnonzero(~stems)
    number = np.arange(len(skeleton))
    number[limbs] = len(skeleton) + np.arange(len(limbs))
    joints = np.concatenate([np.arange(len(skeleton)), limbs])
    parents = np.concatenate([skeleton.parents, number[skeleton.parents[limbs]]])
    radii = np.concatenate([skeleton.radii, THINNER * skeleton.radii[limbs]])
    return Skeleton(skeleton.points[joints], radii, parents), joints
