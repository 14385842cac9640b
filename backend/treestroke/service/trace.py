"""Trace a photo: its foliage and its visible branches."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from treestroke.codec.overlay import draw_overlay
from treestroke.codec.skeleton import plain_skeleton
from treestroke.core.imaging.outline import rings_of_mask
from treestroke.core.pipeline.photo import trace_photo
from treestroke.core.segment.foliage import Foliage
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import StrokeWarning
from treestroke.service.inputs import PhotoLike, StrokesLike, load_photo, load_strokes
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
    crown
        (n, 2) the crown stroke's points, px.
    found
        The foliage with its colour models.
    skeleton
        The visible branches; None where there was no branch stroke.
    stroke
        (n,) index of the stroke that each joint lies under, -1 where it was found by itself.
    warnings
        What was mended in the strokes.
    """

    photo: NDArray[np.uint8]
    foliage: NDArray[np.bool_]
    crown: NDArray[np.float64]
    found: Foliage
    skeleton: Skeleton | None
    stroke: NDArray[np.int64]
    warnings: tuple[StrokeWarning, ...]

    def answer(self) -> dict[str, Any]:
        """Give the trace as plain values: ``foliage`` rings (even-odd), ``skeleton`` and ``warnings``."""
        return {
            "foliage": [ring.tolist() for ring in rings_of_mask(self.foliage)],
            "skeleton": plain_skeleton(self.skeleton, self.stroke),
            "warnings": [asdict(warning) for warning in self.warnings],
        }

    def overlay(self) -> NDArray[np.uint8]:
        """Draw foliage and skeleton over the photo (h, w, 3)."""
        return draw_overlay(self.photo, self.foliage, self.skeleton, self.stroke)


def trace(photo: PhotoLike, strokes: StrokesLike, after: Trace | None = None) -> Trace:
    """Find the foliage inside the crown stroke and the branches near the branch strokes.

    ``photo`` is a path, encoded bytes or upright sRGB pixels (h, w, 3) uint8; ``strokes`` a path, JSON bytes, a plain
    mapping or values. Without branch strokes the foliage alone is found. ``after`` is the last trace of the same photo:
    its foliage is kept while the crown stays the same, so that one more branch stroke is answered at once.

    Raises
    ------
    PhotoError, StrokesError
        The photo or the strokes cannot be used; the message says what, where and how to mend it.
    """
    given = load_strokes(strokes)
    picture = load_photo(photo)
    with one_thread():
        kept = after is not None and np.array_equal(after.crown, given.crown.points)
        traced = trace_photo(picture, given, after.found if after is not None and kept else None)
    return Trace(
        picture, traced.foliage, given.crown.points, traced.found, traced.skeleton, traced.stroke, traced.warnings
    )
