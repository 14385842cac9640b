"""What growth and its evaluators exchange: the rules of a placement, placements and shoots, and the protocol."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from treestroke.core.grow.library import Subtree
from treestroke.core.types import Floats, Indices

TIE = 1e-9
"""Gains within this share of the best are equal; the smallest (branch, subtree, angle) of them wins."""


@dataclass(frozen=True)
class Rules:
    """Figures that decide over a placement; lengths are px of the crown's frame.

    Attributes
    ----------
    spacing
        Distance between the samples of a branch.
    closeness
        A shoot whose outer half comes nearer to the tree than this is dropped.
    keep
        A shoot is clipped where it leaves the crown; with less than this share left it is dropped.
    inward_cosine
        A shoot is dropped where the cosine between it and the line from the crown's foot to its middle is smaller.
    angles
        Number of turns of each subtree about its branch.
    """

    spacing: float
    closeness: float
    keep: float
    inward_cosine: float
    angles: int


class Choice(NamedTuple):
    """A placement (indices) and its gain, px of summed distance; branch -1 where nothing gains."""

    branch: int
    subtree: int
    angle: int
    gain: float


class Shoot(NamedTuple):
    """A shoot that remains: its parent shoot (-1: the branch), where on it (0 to 1), its base and tip (3,), px."""

    parent: int
    fraction: float
    base: Floats
    tip: Floats


class Evaluator(Protocol):
    """Keeps the tree's samples and the attractors' distances; branches count from 0 in the order they were added."""

    def add_branches(self, bases: Floats, tips: Floats, scales: Floats, steering: Floats) -> None:
        """Add branches from bases to tips (k, 3), px; the factors (k, subtrees) stretch each subtree, 0 forbids it.

        ``steering`` (k, 2) turns each shoot that a branch gets toward or away from the vertical: the share of its rise
        that is kept, and the rise that is added, relative to its length, which stays; (1, 0) turns nothing.
        """

    def add_attractors(self, points: Floats) -> None:
        """Add attractors, px: those of the image (m, 2), or in space (m, 3)."""

    def best(self, candidates: Indices, in_space: bool) -> Choice:
        """Find the placement on one of the candidates, branch indices (c,), that shortens the distances, px, most.

        Source: Tan et al. 2008, section 3.2; the gain is the decrease of its cost E2D or, in space, E3D.
        """

    def place(self, choice: Choice) -> list[Shoot]:
        """List the shoots of a placement that pruning leaves; its branch is not a candidate any more."""

    def image_distances(self) -> Floats:
        """Return each image attractor's distance (m,), px, to the nearest sample's projection."""


@dataclass(frozen=True, eq=False)
class TurnedLibrary:
    """The library as arrays, its shoots padded to the largest subtree's: s subtrees, a angles, k shoots.

    Attributes
    ----------
    counts
        (s,) number of shoots of each subtree.
    parents, fractions
        (s, k) as in `Subtree`.
    vectors
        (s, a, k, 3) turned about the support by each angle, in lengths of the support.
    """

    counts: Indices
    parents: Indices
    fractions: Floats
    vectors: Floats


def turn_library(library: tuple[Subtree, ...], angles: int) -> TurnedLibrary:
    """Turn each subtree about its support by ``angles`` equal steps."""
    most = max(len(subtree.parents) for subtree in library)
    counts = np.array([len(subtree.parents) for subtree in library], dtype=np.int64)
    parents = np.full((len(library), most), -1, dtype=np.int64)
    fractions = np.zeros((len(library), most))
    vectors = np.zeros((len(library), angles, most, 3))
    turn = 2 * np.pi * np.arange(angles)[:, None] / angles
    cos, sin = np.cos(turn), np.sin(turn)
    for i, subtree in enumerate(library):
        k, (x, y, z) = counts[i], subtree.vectors.T
        parents[i, :k], fractions[i, :k] = subtree.parents, subtree.fractions
        vectors[i, :, :k] = np.stack(np.broadcast_arrays(cos * x + sin * z, y, cos * z - sin * x), axis=-1)
    return TurnedLibrary(counts, parents, fractions, vectors)
