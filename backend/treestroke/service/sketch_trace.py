"""Trace sketches of a tree's front and left side."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from treestroke.codec.skeleton import plain_grown, plain_skeleton
from treestroke.core.pipeline.grown_tree import GrownTree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sketching import SeenSketches, grow_sketches, see_sketches
from treestroke.core.trace.drawing import Drawing
from treestroke.service.inputs import SketchLike, load_sketch
from treestroke.service.threads import one_thread


@dataclass(frozen=True, eq=False)
class SketchTrace:
    """What sketches show, and the tree grown from them by default settings and seed 0 where it was asked for."""

    seen: SeenSketches
    grown: GrownTree | None

    def answer(self) -> dict[str, Any]:
        """Return the trace as plain values: ``front``, ``side`` and ``warnings``.

        With a tree also ``grown``, ``photo`` and ``score``.
        """
        found = {
            "front": _plain(self.seen.front),
            "side": None if self.seen.side is None else _plain(self.seen.side),
            "warnings": [asdict(warning) for warning in self.seen.warnings],
        }
        if self.grown is None:
            return found
        grown = plain_grown(self.grown.live)
        return {**found, "grown": grown, "photo": grown["photo"], "score": self.grown.score}


def trace_sketches(front: SketchLike, side: SketchLike | None = None, grow: bool = False) -> SketchTrace:
    """Find the 2D skeletons of a front sketch and, where there is one, of a left-side sketch.

    ``grow`` asks for the tree, too, that `treestroke.service.model.sketch` would grow.

    Raises
    ------
    StrokesError
        A sketch cannot be used; the message says what, where and how to mend it.
    """
    with one_thread():
        seen = see_sketches(load_sketch(front, "front"), None if side is None else load_sketch(side, "side"))
        return SketchTrace(seen, grow_sketches(seen, ModelSettings(), np.random.default_rng(0)) if grow else None)


def _plain(drawing: Drawing) -> dict[str, Any]:
    return {
        "skeleton": plain_skeleton(drawing.tree.skeleton, drawing.tree.branch),
        "crown": drawing.crown.round(2).tolist(),
        "crown_drawn": drawing.crown_drawn,
        "size": list(drawing.size),
    }
