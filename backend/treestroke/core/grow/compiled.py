"""The compiled evaluator: same choices as `reference`, some hundred times faster."""

import numpy as np

from treestroke.core.grow._engine import Engine
from treestroke.core.grow.evaluator import Choice, Rules, Shoot, turn_library
from treestroke.core.grow.growth_space import GrowthSpace
from treestroke.core.grow.library import Subtree
from treestroke.core.types import Floats, Indices

GROUP_SIDE = 2.0
"""Side of the cells that group the image attractors, in mean distances between them."""


def _floats(array: Floats) -> Floats:
    """Make an array fit for the extension."""
    return np.ascontiguousarray(array, dtype=np.float64)


def _neighbours(points: Floats) -> tuple[Indices, Indices]:
    """Order points (m, 2) so that neighbours stand together; give the order and where each group starts, and m."""
    side = max(GROUP_SIDE * float(np.sqrt(np.prod(np.ptp(points, axis=0)) / len(points))), 1e-9)
    cells = np.floor((points - points.min(axis=0)) / side).astype(np.int64)
    order = np.lexsort((cells[:, 0], cells[:, 1]))
    new = (np.diff(cells[order], axis=0) != 0).any(axis=1)
    return order, np.concatenate([[0], np.flatnonzero(new) + 1, [len(points)]])


class CompiledEvaluator:
    """An `Evaluator` on the extension ``_engine``; how it saves work stands at the head of ``_engine.c``."""

    def __init__(self, crown: GrowthSpace, library: tuple[Subtree, ...], rules: Rules) -> None:
        turned = turn_library(library, rules.angles)
        self._order = np.zeros(0, dtype=np.int64)
        self._engine = Engine(
            crown.mask.shape,
            np.ascontiguousarray(crown.mask, dtype=np.uint8),
            _floats(crown.middle),
            _floats(crown.radius),
            tuple(crown.foot.tolist()),
            rules.spacing,
            rules.closeness,
            rules.keep,
            rules.inward_cosine,
            turned.counts,
            turned.parents,
            turned.fractions,
            turned.vectors,
        )

    def add_branches(self, bases: Floats, tips: Floats, scales: Floats) -> None:
        """Add branches, see `Evaluator`."""
        self._engine.add_branches(_floats(bases), _floats(tips), _floats(scales))

    def add_attractors(self, points: Floats) -> None:
        """Add attractors, see `Evaluator`; those of the image once, at the start."""
        if points.shape[1] == 3:
            self._engine.add_attractors(_floats(points), True)
        elif len(points):
            self._order, starts = _neighbours(points)
            ordered = points[self._order]
            self._engine.add_attractors(_floats(np.column_stack([ordered, np.zeros(len(points))])), False)
            self._engine.group(starts)

    def best(self, candidates: Indices, in_space: bool) -> Choice:
        """Find the best placement, see `Evaluator`."""
        return Choice(*self._engine.best(np.ascontiguousarray(candidates, dtype=np.int64), in_space))

    def place(self, choice: Choice) -> list[Shoot]:
        """List the shoots that stand, see `Evaluator`."""
        rows = self._engine.place(choice.branch, choice.subtree, choice.angle)
        return [Shoot(row[0], row[1], np.array(row[2:5]), np.array(row[5:8])) for row in rows]

    def image_distances(self) -> Floats:
        """Give the image attractors' distances, see `Evaluator`."""
        distances = np.empty(len(self._order))
        distances[self._order] = np.frombuffer(self._engine.distances(), dtype=np.float64)
        return distances
