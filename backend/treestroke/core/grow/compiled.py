"""The compiled evaluator: the same choices as `reference`, some hundred times faster."""

import numpy as np

from treestroke.core.grow._engine import Engine
from treestroke.core.grow.growth_space import GrowthSpace
from treestroke.core.grow.library import Subtree
from treestroke.core.grow.placements import Choice, Rules, Shoot, turn_library
from treestroke.core.types import Floats, Indices

GROUP_SIDE = 2.0
"""Side of the cells that group the image attractors, relative to the mean distance between them."""


def _contiguous(array: Floats) -> Floats:
    """Return an array as the extension takes it: float64, in C order."""
    return np.ascontiguousarray(array, dtype=np.float64)


def _group(points: Floats) -> tuple[Indices, Indices]:
    """Group neighbouring points (m, 2), px: return their order (m,), and where each group starts in it, then m."""
    side = max(GROUP_SIDE * float(np.sqrt(np.prod(np.ptp(points, axis=0)) / len(points))), 1e-9)
    cells = np.floor((points - points.min(axis=0)) / side).astype(np.int64)
    order = np.lexsort((cells[:, 0], cells[:, 1]))
    new = (np.diff(cells[order], axis=0) != 0).any(axis=1)
    return order, np.concatenate([[0], np.flatnonzero(new) + 1, [len(points)]])


class CompiledEvaluator:
    """An `Evaluator` on the extension ``_engine``; the head of ``_engine.c`` says how it saves work."""

    def __init__(self, space: GrowthSpace, library: tuple[Subtree, ...], rules: Rules) -> None:
        turned, sections = turn_library(library, rules.angles), space.sections
        self._order = np.zeros(0, dtype=np.int64)
        self._engine = Engine(
            space.mask.shape,
            np.ascontiguousarray(space.mask, dtype=np.uint8),
            _contiguous(sections.middle_px),
            _contiguous(sections.radius_px),
            _contiguous(sections.near_px),
            _contiguous(sections.deep_px),
            tuple(space.foot.tolist()),
            rules.spacing,
            rules.closeness,
            rules.keep,
            rules.inward_cosine,
            turned.counts,
            turned.parents,
            turned.fractions,
            turned.vectors,
        )

    def add_branches(self, bases: Floats, tips: Floats, scales: Floats, steering: Floats) -> None:
        """Add branches, bases and tips (k, 3) px, factors (k, subtrees), steering (k, 2); see `Evaluator`."""
        self._engine.add_branches(*map(_contiguous, (bases, tips, scales, steering)))

    def add_attractors(self, points: Floats) -> None:
        """Add attractors, px, in space (m, 3), or, once at the start, those of the image (m, 2)."""
        if points.shape[1] == 3:
            self._engine.add_attractors(_contiguous(points), True)
        elif len(points):
            self._order, starts = _group(points)
            ordered = points[self._order]
            self._engine.add_attractors(_contiguous(np.column_stack([ordered, np.zeros(len(points))])), False)
            self._engine.group(starts)

    def best(self, candidates: Indices, in_space: bool) -> Choice:
        """Find the best placement on the candidates, branch indices (c,); see `Evaluator`."""
        return Choice(*self._engine.best(np.ascontiguousarray(candidates, dtype=np.int64), in_space))

    def place(self, choice: Choice) -> list[Shoot]:
        """List the shoots that remain; see `Evaluator`."""
        rows = self._engine.place(choice.branch, choice.subtree, choice.angle)
        return [Shoot(row[0], row[1], np.array(row[2:5]), np.array(row[5:8])) for row in rows]

    def image_distances(self) -> Floats:
        """Return each image attractor's distance (m,), px, to the tree's projection."""
        distances = np.empty(len(self._order))
        distances[self._order] = np.frombuffer(self._engine.distances(), dtype=np.float64)
        return distances
