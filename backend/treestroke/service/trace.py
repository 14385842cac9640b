"""Trace a photo (its foliage and its visible branches) or sketches (their branches)."""

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from treestroke.codec.overlay import draw_overlay
from treestroke.codec.skeleton import plain_grown, plain_skeleton
from treestroke.core.imaging.opacity import over_white
from treestroke.core.imaging.outline import rings_of_mask
from treestroke.core.pipeline.grown_tree import GrownTree, LiveTree
from treestroke.core.pipeline.photo import PhotoTrace, grow_photo, trace_photo, with_side
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sketching import SketchEvidence, grow_sketches, read_sketches
from treestroke.core.pipeline.taken import Taken
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Strokes, StrokeWarning, same_stroke, same_strokes
from treestroke.core.trace.drawing import Drawing
from treestroke.core.types import Picture
from treestroke.service.execution import one_thread
from treestroke.service.loading import (
    PhotoLike,
    SettingsLike,
    SketchLike,
    StrokesLike,
    load_photo,
    load_settings,
    load_sketch,
    load_strokes,
)
from treestroke.service.report import plain_taken


@dataclass(frozen=True, eq=False)
class Trace:
    """Foliage and branches found in a photo, in its pixels.

    Attributes
    ----------
    photo
        (h, w, 3) uint8 sRGB, upright.
    foliage
        (h, w) bool, true on leaves (on a bare tree, on twigs).
    rings
        The foliage as closed outlines, each (n, 2), px, by the even-odd rule.
    strokes
        The strokes as they were drawn.
    photo_trace
        The recipe's own result, from which another trace of the same photo goes on.
    skeleton
        The visible branches; None where there was no branch stroke.
    stroke
        (n,) index of the stroke that each joint lies under; -1 where it was found without one.
    warnings
        What was mended in the photo and in the strokes.
    grow
        Whether a grown tree was asked for.
    grown
        The tree grown by the given settings and seed 0; None where it was not asked for or there is no branch stroke.
    """

    photo: NDArray[np.uint8]
    foliage: NDArray[np.bool_]
    rings: list[NDArray[np.float64]]
    strokes: Strokes
    photo_trace: PhotoTrace
    skeleton: Skeleton | None
    stroke: NDArray[np.int64]
    warnings: tuple[StrokeWarning, ...]
    grow: bool = False
    grown: LiveTree | None = None

    def as_dict(self) -> dict[str, Any]:
        """Return the trace as plain values: ``foliage`` rings (even-odd), ``skeleton``, ``taken`` and ``warnings``.

        Where a grown tree was asked for, also ``grown`` and ``photo``, null without a branch stroke.
        """
        values = {
            "foliage": [ring.tolist() for ring in self.rings],
            "skeleton": plain_skeleton(self.skeleton, self.stroke),
            "taken": None if self.taken is None else plain_taken(self.taken),
            "warnings": [asdict(warning) for warning in self.warnings],
        }
        if not self.grow:
            return values
        grown = None if self.grown is None else plain_grown(self.grown)
        return {**values, "grown": grown, "photo": None if grown is None else grown["photo"]}

    @property
    def taken(self) -> Taken | None:
        """What the photo's tree is taken for, whatever the settings say; None without a branch stroke."""
        return None if self.skeleton is None else self.photo_trace.evidence.taken(ModelSettings())

    def overlay(self) -> NDArray[np.uint8]:
        """Return the photo (h, w, 3) uint8 with foliage and skeleton drawn over it."""
        return draw_overlay(self.photo, self.foliage, self.skeleton, self.stroke)


def trace(
    photo: PhotoLike,
    strokes: StrokesLike,
    after: Trace | None = None,
    grow: bool = False,
    *,
    side: SketchLike | None = None,
    settings: SettingsLike = None,
) -> Trace:
    """Return the foliage inside the crown stroke and the branches near the branch strokes.

    ``photo`` is as `model` takes it; ``strokes`` are a path, JSON bytes, a plain mapping or values. Without branch
    strokes only the foliage is found. ``after`` is the last trace of the same photo: its foliage is kept while the
    crown stays the same, so that one more branch stroke is answered at once; all of it is kept while all strokes do.
    With ``grow`` the tree that `model` would grow by the same ``settings`` is added; a sketch of its left ``side``
    gives that tree its depth.

    Raises
    ------
    PhotoError, StrokesError, SettingsError
        The photo, the strokes or a setting cannot be used; the message says what, where and how to mend it.
    """
    drawn, chosen, mended = load_strokes(strokes), load_settings(settings), list[StrokeWarning]()
    picture = load_photo(photo, warn=mended.append)
    last = after if after is not None and same_stroke(after.strokes.crown, drawn.crown) else None
    with one_thread():
        if last is not None and same_strokes(last.strokes, drawn):
            traced = last.photo_trace
        else:
            traced = trace_photo(picture, drawn, None if last is None else last.photo_trace.evidence)
        traced = with_side(traced, None if side is None else load_sketch(side, "side"))
    rings = None if last is None else last.rings
    found = _trace_of(over_white(picture), drawn, traced, chosen if grow else None, rings)
    return replace(found, warnings=(*mended, *found.warnings))


def trace_values(photo: Picture, drawn: Strokes, traced: PhotoTrace, growing: ModelSettings | None) -> dict[str, Any]:
    """Return what was traced in a photo (h, w, 3) as plain values, as `Trace.as_dict` does.

    With settings also the skeleton that is ``growing`` by them and seed 0.
    """
    return _trace_of(photo, drawn, traced, growing).as_dict()


def _trace_of(
    photo: Picture,
    drawn: Strokes,
    traced: PhotoTrace,
    growing: ModelSettings | None,
    rings: list[NDArray[np.float64]] | None = None,
) -> Trace:
    """Return a trace with the tree that grows by settings, where some are given; ``rings`` where they are known."""
    with one_thread():
        grown = None if growing is None else grow_photo(traced, growing, np.random.default_rng(0))
    return Trace(
        photo=photo,
        foliage=traced.foliage,
        rings=rings_of_mask(traced.foliage) if rings is None else rings,
        strokes=drawn,
        photo_trace=traced,
        skeleton=traced.skeleton,
        stroke=traced.stroke,
        warnings=traced.warnings,
        grow=growing is not None,
        grown=grown,
    )


@dataclass(frozen=True, eq=False)
class SketchTrace:
    """The branches that sketches show and, where asked for, the tree grown of them by default settings and seed 0."""

    evidence: SketchEvidence
    grown: GrownTree | None

    def as_dict(self) -> dict[str, Any]:
        """Return the trace as plain values: ``front``, ``side`` and ``warnings``.

        With a tree also ``grown``, ``photo`` and ``score``.
        """
        values = {
            "front": _plain(self.evidence.front),
            "side": None if self.evidence.side is None else _plain(self.evidence.side),
            "warnings": [asdict(warning) for warning in self.evidence.warnings],
        }
        if self.grown is None:
            return values
        grown = plain_grown(self.grown.live)
        return {**values, "grown": grown, "photo": grown["photo"], "score": self.grown.score}


def trace_sketches(front: SketchLike, side: SketchLike | None = None, grow: bool = False) -> SketchTrace:
    """Return the 2D skeletons of a front sketch and, where there is one, of a left-side sketch.

    ``grow`` asks for the tree, too, that `sketch` would grow of them.

    Raises
    ------
    StrokesError
        A sketch cannot be used; the message says what, where and how to mend it.
    """
    with one_thread():
        evidence = read_sketches(load_sketch(front, "front"), None if side is None else load_sketch(side, "side"))
        return SketchTrace(
            evidence, grow_sketches(evidence, ModelSettings(), np.random.default_rng(0)) if grow else None
        )


def _plain(drawing: Drawing) -> dict[str, Any]:
    return {
        "skeleton": plain_skeleton(drawing.tree.skeleton, drawing.tree.branch),
        "crown": drawing.crown.round(2).tolist(),
        "crown_drawn": drawing.crown_drawn,
        "size": list(drawing.size),
    }
