"""Replication blocks: subtrees that are set onto branches to stand for hidden ones."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.vectors import unit
from treestroke.core.grow.library import TYPE_1, TYPE_2, Subtree, visible_subtrees
from treestroke.core.grow.placements import TurnedLibrary, turn_library
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices

ENOUGH_VISIBLE, MOST_VISIBLE = 3, 6
"""Visible subtrees from which on only they are blocks, and the greatest number of them; with fewer the library's own
stand beside them (the paper borrows blocks from another tree)."""
TURNS = 12
"""Angles about its primary branch at which a block is tried."""

NO_SHOOT = -2
"""Parent of a shoot that a block does not have: blocks are padded to the largest."""


@dataclass(frozen=True, eq=False)
class Blocks:
    """Blocks on a primary branch from (0, 0, 0) to (0, 1, 0), at all turns: b blocks times turns, k shoots at most.

    Attributes
    ----------
    bases, ends
        (b, k, 3) where each shoot begins and ends, in lengths of the primary branch.
    parents
        (b, k) the shoot that each shoot leaves, -1 for the primary branch; `NO_SHOOT` where a block has none.
    """

    bases: Floats
    ends: Floats
    parents: Indices

    def placed(self, start: Floats, axis: Floats) -> tuple[Floats, Floats]:
        """Return the shoots' bases and ends (b, k, 3), metres, on a primary branch with a start and a vector (3,)."""
        length = float(np.linalg.norm(axis))
        up = axis / length
        side = unit(np.cross(up, [0.0, 0.0, 1.0] if abs(up[2]) < 0.9 else [1.0, 0.0, 0.0]))
        frame = length * np.stack([side, up, np.cross(side, up)])
        return start + self.bases @ frame, start + self.ends @ frame


def replication_blocks(skeleton: Skeleton) -> Blocks:
    """Take blocks from the visible subtrees of a skeleton (3D), or the library's where few are visible.

    Source: Tan et al. 2007, section 5.2.
    """
    visible: tuple[Subtree, ...] = visible_subtrees(skeleton)[:MOST_VISIBLE]
    library = visible if len(visible) >= ENOUGH_VISIBLE else visible + TYPE_1 + TYPE_2
    turned = turn_library(library, TURNS)
    bases, ends = _shoots(turned)
    exists = np.arange(turned.parents.shape[1]) < turned.counts[:, None]
    parents = np.repeat(np.where(exists, turned.parents, NO_SHOOT), TURNS, axis=0)
    return Blocks(bases.reshape(len(parents), -1, 3), ends.reshape(len(parents), -1, 3), parents)


def _shoots(turned: TurnedLibrary) -> tuple[Floats, Floats]:
    """Return where shoots begin and end (s, a, k, 3), in lengths of the primary branch."""
    bases = np.zeros_like(turned.vectors)
    for subtree in range(len(turned.counts)):
        for shoot in range(int(turned.counts[subtree])):
            parent, fraction = int(turned.parents[subtree, shoot]), float(turned.fractions[subtree, shoot])
            if parent < 0:
                bases[subtree, :, shoot, 1] = fraction
            else:
                along = fraction * turned.vectors[subtree, :, parent]
                bases[subtree, :, shoot] = bases[subtree, :, parent] + along
    return bases, bases + turned.vectors
