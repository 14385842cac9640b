"""The values of a tree's motion: bones, animations, and the skinning of vertices."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Indices


@dataclass(frozen=True, eq=False)
class Rig:
    """The bones of a tree at rest, all without rotation: their axes are the world's.

    ======  ====================================================================
    letter  meaning
    ======  ====================================================================
    b       bones: the root first, then branches, then those for the flutter of leaves, then perhaps tips, which
            say where the last bones of branches end and move nothing
    n       joints of the skeleton
    ======  ====================================================================

    Attributes
    ----------
    names
        b names, ``root``, ``branch_01`` ..., ``flutter_01`` ..., and perhaps ``tip_01`` ...
    parents
        (b,) index of each bone's parent, smaller than its own; -1 for the root.
    heads
        (b, 3) the point where each bone starts and that it turns about, metres, world.
    ends
        (b, 3) the point where it ends, metres: the next bone of its limb or the limb's tip; for the root its head.
    radii
        (b,) radius of the wood at the head, metres; 0 for flutter bones.
    joint_bones
        (n, 2) index of the two bones that each joint of the skeleton follows.
    joint_share
        (n,) weight of the second of them, 0 to 1.
    flutter
        (b,) index of the flutter bone that the outer corners of leaves on a bone follow: a child of the bone or of its
        nearest ancestor that has one; -1 without any.
    extent
        Greatest extent of the skeleton along an axis, metres.
    """

    names: tuple[str, ...]
    parents: Indices
    heads: Floats
    ends: Floats
    radii: Floats
    joint_bones: Indices
    joint_share: Floats
    flutter: Indices
    extent: float


@dataclass(frozen=True, eq=False)
class Animation:
    """A looping animation: keyframes of rotations of bones about their heads; the root never moves.

    Attributes
    ----------
    name
        ``measured``, ``breeze`` or ``gust``.
    bones
        Index of the bones that move, each with its own keyframes.
    times
        For each such bone the times (k,) of its keyframes, seconds, from 0 to its length.
    rotations
        For each such bone the unit quaternions (k, 4) x, y, z, w of its keyframes; the last equals the first.
    many
        Whether there are so many keyframes that files keep them in 16 bit, exact to 0.00003.
    """

    name: str
    bones: tuple[int, ...]
    times: tuple[Floats, ...]
    rotations: tuple[Floats, ...]
    many: bool = False


@dataclass(frozen=True, eq=False)
class Motion:
    """A rig and the animations that move it."""

    rig: Rig
    animations: tuple[Animation, ...]


@dataclass(frozen=True, eq=False)
class Skin:
    """The skinning of one mesh: the bones that each vertex follows, and their weights.

    Attributes
    ----------
    bones
        (v, 4) uint8 index; where the weight is 0, bone 0.
    weights
        (v, 4) uint8, 255ths, summing to 255.
    sway
        (v,) float32 amplitude, 0 at the root to 1 at the vertex that moves most: for engines with a wind of their own.
    phase
        (v,) float32 share of a swing by which a vertex is ahead, 0 to 1.
    """

    bones: NDArray[np.uint8]
    weights: NDArray[np.uint8]
    sway: NDArray[np.float32]
    phase: NDArray[np.float32]

    def at(self, vertices: Indices) -> "Skin":
        """Select vertices by their index (j,)."""
        return Skin(self.bones[vertices], self.weights[vertices], self.sway[vertices], self.phase[vertices])
