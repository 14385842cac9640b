"""Sketches of a tree's front and left side: traced, and turned into a 3D tree."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from treestroke.codec.skeleton import plain_grown, plain_skeleton
from treestroke.core.pipeline.dressing import OwnPictures
from treestroke.core.pipeline.finishing import OnGrown, unseen
from treestroke.core.pipeline.grown_tree import GrownTree
from treestroke.core.pipeline.settings import ModelSettings, check_seed
from treestroke.core.pipeline.sketching import SketchEvidence, grow_sketches, model_sketches, read_sketches
from treestroke.core.progress import Report, silent
from treestroke.core.strokes import StrokeWarning
from treestroke.core.trace.drawing import Drawing
from treestroke.service.clock import Stopwatch
from treestroke.service.files import check_files
from treestroke.service.inputs import (
    FruitLike,
    LeafLike,
    PhotoLike,
    SettingsLike,
    SketchLike,
    load_fruit,
    load_leaf,
    load_photo,
    load_settings,
    load_sketch,
)
from treestroke.service.making import Model, make
from treestroke.service.threads import one_thread


@dataclass(frozen=True, eq=False)
class SketchTrace:
    """What sketches show, and the tree that default settings and seed 0 let grow of them, where it was asked for."""

    seen: SketchEvidence
    grown: GrownTree | None

    def answer(self) -> dict[str, Any]:
        """Give the trace as plain values: ``front``, ``side`` and ``warnings``.

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

    ``grow`` asks for the tree, too, that `sketch` would grow of them.

    Raises
    ------
    StrokesError
        A sketch cannot be used; the message says what, where and how to mend it.
    """
    with one_thread():
        seen = read_sketches(load_sketch(front, "front"), None if side is None else load_sketch(side, "side"))
        return SketchTrace(seen, grow_sketches(seen, ModelSettings(), np.random.default_rng(0)) if grow else None)


def sketch(
    front: SketchLike,
    side: SketchLike | None = None,
    settings: SettingsLike = None,
    seed: int = 0,
    report: Report = silent,
    on_grown: OnGrown = unseen,
    *,
    photo: PhotoLike | None = None,
    leaf: LeafLike = None,
    fruit: FruitLike = None,
    name: str = "tree",
) -> Model:
    """Turn a sketch of a tree's front, and perhaps one of its left side, into a 3D tree.

    A sketch is a path or the bytes of stroke JSON or of a PNG, a plain mapping, or values. Without a side the limbs'
    depth is assumed, which a warning says. ``photo`` is what the front was drawn over, as `model` takes it: it lends
    the tree its colours. All else is as for `model`.

    Raises
    ------
    PhotoError, StrokesError, LeafError, FruitError, SettingsError
        An input cannot be used; the message says what, where and how to mend it.
    """
    chosen, seed = load_settings(settings), check_seed(seed)
    pictures = OwnPictures(load_leaf(leaf), load_fruit(fruit))
    check_files(chosen)
    watch, mended = Stopwatch(report), list[StrokeWarning]()
    with one_thread():
        with watch.stage("decode"):
            drawn, beside = load_sketch(front, "front"), None if side is None else load_sketch(side, "side")
            picture = None if photo is None else load_photo(photo, watch, mended.append)
        seen = read_sketches(drawn, beside, picture, watch)
        made = make(
            lambda rng, show: model_sketches(seen, chosen, rng, watch, show, pictures),
            chosen,
            seed,
            watch,
            on_grown,
            name,
        )
    return made.with_warnings(asdict(warning) for warning in mended)


def _plain(drawing: Drawing) -> dict[str, Any]:
    return {
        "skeleton": plain_skeleton(drawing.tree.skeleton, drawing.tree.branch),
        "crown": drawing.crown.round(2).tolist(),
        "crown_drawn": drawing.crown_drawn,
        "size": list(drawing.size),
    }
