"""What growth asks of an evaluator: which placement brings the tree nearest to the attractors."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from treestroke.core.grow.growth_space import GrowthSpace
from treestroke.core.grow.library import Subtree
from treestroke.core.types import Floats, Indices

TIE = 1e-9
"""Gains within this share of the best are equal; the smallest (branch, subtree, angle) of them wins."""


@dataclass(frozen=True)
class Rules:
    """The figures that decide over a placement, px of the crown's frame.

    Attributes
    ----------
    spacing
        Between the samples of a branch.
    closeness
        A shoot whose outer half comes nearer to the tree than this is dropped.
    keep
        A shoot is clipped where it leaves the crown; with less than this share left it is dropped.
    inward_cosine
        A shoot is dropped where the cosine between it and the way from the crown's foot to its middle is smaller.
    angles
        Turns of each subtree about its branch.
    """

    spacing: float
    closeness: float
    keep: float
    inward_cosine: float
    angles: int


class Choice(NamedTuple):
    """A placement and its gain, px of summed distance; branch -1 where nothing gains."""

    branch: int
    subtree: int
    angle: int
    gain: float


class Shoot(NamedTuple):
    """A shoot that stands: the shoot that bears it (-1: the branch), where on it (0..1), its two ends (3,), px."""

    parent: int
    fraction: float
    base: Floats
    tip: Floats


class Evaluator(Protocol):
    """Keeps the tree's samples and the attractors' distances; branches count from 0 in the order they were added."""

    def add_branches(self, bases: Floats, tips: Floats, scales: Floats) -> None:
        """Add branches from bases to tips (k, 3); scales (k, subtrees) stretch each subtree, 0 forbids it."""

    def add_attractors(self, points: Floats) -> None:
        """Add image attractors (m, 2) or attractors in space (m, 3)."""

    def best(self, candidates: Indices, in_space: bool) -> Choice:
        """Find the placement on a candidate branch that shortens the attractors' distances most."""

    def place(self, choice: Choice) -> list[Shoot]:
        """List the shoots of a placement that pruning leaves; its branch is no candidate any more."""

    def image_distances(self) -> Floats:
        """Give each image attractor's distance to the nearest sample's projection (m,), px."""


@dataclass(frozen=True, eq=False)
class TurnedLibrary:
    """The library as arrays, its shoots padded to the largest subtree's: s subtrees, a angles, k shoots.

    Attributes
    ----------
    counts
        (s,) shoots of each subtree.
    parents, fractions
        (s, k) as in `Subtree`.
    vectors
        (s, a, k, 3) turned about the support by each angle.
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


def evaluator_for(crown: GrowthSpace, library: tuple[Subtree, ...], rules: Rules) -> Evaluator:
    """Make the compiled evaluator, or the plain one (slow, same choices) where the extension was not built."""
    try:
        from treestroke.core.grow.compiled import CompiledEvaluator
    except ImportError:
        from treestroke.core.grow.reference import PlainEvaluator

        return PlainEvaluator(crown, library, rules)
    return CompiledEvaluator(crown, library, rules)
