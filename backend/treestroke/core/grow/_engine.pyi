"""The compiled evaluator of growth; arrays are C-contiguous, lengths px of the picture (see `GrowthSpace`)."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Indices

class Engine:
    """What `placements.Evaluator` is, without objects; (s, a, k) are subtrees, angles and shoots of a subtree."""

    def __init__(
        self,
        size: tuple[int, int],
        mask: NDArray[np.uint8],
        middle: Floats,
        radius: Floats,
        near: Floats,
        deep: Floats,
        foot: tuple[float, float, float],
        spacing: float,
        closeness: float,
        keep: float,
        inward_cosine: float,
        counts: Indices,
        parents: Indices,
        fractions: Floats,
        vectors: Floats,
    ) -> None:
        """Take a crown: size (h, w), mask (h, w), sections (h,) px, foot; `Rules`; and a `TurnedLibrary`."""

    def add_branches(self, bases: Floats, tips: Floats, scales: Floats, steering: Floats) -> None:
        """Add branches: bases and tips (k, 3), px; factors (k, s); steering (k, 2) as in `Evaluator`."""

    def add_attractors(self, points: Floats, in_space: bool) -> None:
        """Add attractors (m, 3), px, in space or, with z = 0, in the image."""

    def group(self, starts: Indices) -> None:
        """Set the groups of neighbouring image attractors: indices (g + 1,) of their first ones, then m."""

    def best(self, candidates: Indices, in_space: bool) -> tuple[int, int, int, float]:
        """Return branch, subtree, angle and gain (px) of the best placement on candidates (c,), branch indices."""

    def place(
        self, branch: int, subtree: int, angle: int
    ) -> list[tuple[int, float, float, float, float, float, float, float]]:
        """List parent, fraction, base (x, y, z) and tip (x, y, z), px, of a placement's remaining shoots."""

    def distances(self) -> bytes:
        """Return the image attractors' distances (m,), px, as bytes of float64, in the order they were added."""
