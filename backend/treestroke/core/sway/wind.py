"""Wind: bones in a tree, how its vertices follow them, and clips that move them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Indices


@dataclass(frozen=True, eq=False)
class Rig:
    """Bones of a tree at rest, all unturned: their axes are the world's.

    ======  ====================================================================
    letter  meaning
    ======  ====================================================================
    b       bones: the root first, then branches, then those that let leaves flutter
    n       joints of the skeleton
    ======  ====================================================================

    Attributes
    ----------
    names
        b names, ``root``, ``branch_01`` ..., ``flutter_01`` ...
    parents
        (b,) -1 for the root, else smaller than the bone's own index.
    heads
        (b, 3) where each bone starts and turns about, metres, world.
    ends
        (b, 3) where it ends: at the next bone of its limb or at the limb's tip; the root where it starts.
    radii
        (b,) radius of the wood at the head, metres; 0 for flutter.
    joint_bones
        (n, 2) the two bones that each joint of the skeleton follows.
    joint_share
        (n,) weight of the second of them, 0 to 1.
    flutter
        (b,) the flutter bone that the outer corners of leaves on a bone follow, or -1: its own child, or that of its
        nearest ancestor with one.
    """

    names: tuple[str, ...]
    parents: Indices
    heads: Floats
    ends: Floats
    radii: Floats
    joint_bones: Indices
    joint_share: Floats
    flutter: Indices


@dataclass(frozen=True, eq=False)
class Clip:
    """A looping movement: bones turn about their heads, the root never.

    Attributes
    ----------
    name
        ``breeze`` or ``gust``.
    bones
        The bones that move, each with its own times.
    times
        For each such bone (k,) seconds from 0 to the clip's length, the same at both ends.
    turns
        For each such bone (k, 4) unit quaternions x, y, z, w; the last equals the first.
    """

    name: str
    bones: tuple[int, ...]
    times: tuple[Floats, ...]
    turns: tuple[Floats, ...]


@dataclass(frozen=True, eq=False)
class Wind:
    """A rig and the clips that move it."""

    rig: Rig
    clips: tuple[Clip, ...]


@dataclass(frozen=True, eq=False)
class Skin:
    """How the vertices of one mesh follow a rig.

    Attributes
    ----------
    bones
        (v, 4) uint8; a bone of weight 0 is bone 0.
    weights
        (v, 4) uint8, summing to 255.
    sway
        (v,) float32, 0 at the root to 1 at what moves most: for engines with a wind of their own.
    phase
        (v,) float32, 0 to 1, when in a swing a vertex moves.
    """

    bones: NDArray[np.uint8]
    weights: NDArray[np.uint8]
    sway: NDArray[np.float32]
    phase: NDArray[np.float32]

    def at(self, vertices: Indices) -> "Skin":
        """Pick some of the vertices."""
        return Skin(self.bones[vertices], self.weights[vertices], self.sway[vertices], self.phase[vertices])
