"""Trace a photo: its foliage and its visible branches."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from treestroke.codec.overlay import draw_overlay
from treestroke.codec.skeleton import plain_grown, plain_skeleton
from treestroke.core.imaging.outline import rings_of_mask
from treestroke.core.pipeline.grown_tree import LiveTree
from treestroke.core.pipeline.photo import PhotoTrace, beside, grow_photo, trace_photo
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Strokes, StrokeWarning, same_stroke, same_strokes
from treestroke.service.inputs import PhotoLike, SketchLike, StrokesLike, load_photo, load_sketch, load_strokes
from treestroke.service.threads import one_thread


@dataclass(frozen=True, eq=False)
class Trace:
    """What was found in a photo, in its pixels.

    Attributes
    ----------
    photo
        (h, w, 3) uint8 sRGB, upright.
    foliage
        (h, w), true on leaves (on a bare tree, on twigs).
    rings
        The same as closed outlines, each (n, 2), px, by the even-odd rule.
    given
        The strokes that it was found by.
    found
        The same with what it was found from.
    skeleton
        The visible branches; None where there was no branch stroke.
    stroke
        (n,) index of the stroke that each joint lies under, -1 where it was found by itself.
    warnings
        What was mended in the photo and in the strokes.
    grow
        Whether a grown tree was asked for.
    grown
        The tree that default settings and seed 0 let grow; None where it was not asked for or has no branch stroke.
    """

    photo: NDArray[np.uint8]
    foliage: NDArray[np.bool_]
    rings: list[NDArray[np.float64]]
    given: Strokes
    found: PhotoTrace
    skeleton: Skeleton | None
    stroke: NDArray[np.int64]
    warnings: tuple[StrokeWarning, ...]
    grow: bool = False
    grown: LiveTree | None = None

    def answer(self) -> dict[str, Any]:
        """Give the trace as plain values: ``foliage`` rings (even-odd), ``skeleton`` and ``warnings``.

        Where a grown tree was asked for, also ``grown`` and ``photo``, null without a branch stroke.
        """
        found = {
            "foliage": [ring.tolist() for ring in self.rings],
            "skeleton": plain_skeleton(self.skeleton, self.stroke),
            "warnings": [asdict(warning) for warning in self.warnings],
        }
        if not self.grow:
            return found
        grown = None if self.grown is None else plain_grown(self.grown)
        return {**found, "grown": grown, "photo": None if grown is None else grown["photo"]}

    def overlay(self) -> NDArray[np.uint8]:
        """Draw foliage and skeleton over the photo (h, w, 3)."""
        return draw_overlay(self.photo, self.foliage, self.skeleton, self.stroke)


def trace(
    photo: PhotoLike,
    strokes: StrokesLike,
    after: Trace | None = None,
    grow: bool = False,
    side: SketchLike | None = None,
) -> Trace:
    """Find the foliage inside the crown stroke and the branches near the branch strokes.

    ``photo`` is a path, encoded bytes or upright sRGB pixels (h, w, 3) uint8; ``strokes`` a path, JSON bytes, a plain
    mapping or values. Without branch strokes the foliage alone is found. ``after`` is the last trace of the same photo:
    its foliage is kept while the crown stays the same, so that one more branch stroke is answered at once, and
    everything while all strokes do. ``grow`` asks for the tree, too, that `model` would grow of them, and of the sketch
    of its left ``side`` where there is one.

    Raises
    ------
    PhotoError, StrokesError
        The photo or the strokes cannot be used; the message says what, where and how to mend it.
    """
    given, mended = load_strokes(strokes), list[StrokeWarning]()
    picture = load_photo(photo, warn=mended.append)
    last = after if after is not None and same_stroke(after.given.crown, given.crown) else None
    with one_thread():
        if last is not None and same_strokes(last.given, given):
            found = last.found
        else:
            found = trace_photo(picture, given, None if last is None else last.found.evidence.foliage)
        found = beside(found, None if side is None else load_sketch(side, "side"))
        grown = grow_photo(found, ModelSettings(), np.random.default_rng(0)) if grow else None
    rings = rings_of_mask(found.foliage) if last is None else last.rings
    what = found.foliage, rings, given, found, found.skeleton, found.stroke, (*mended, *found.warnings)
    return Trace(picture, *what, grow=grow, grown=grown)
