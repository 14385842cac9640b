"""The trace of a photo in its own pixels, and the tree that grows from it (Tan et al. 2008)."""

from dataclasses import dataclass, replace

import numpy as np

from treestroke.core.pipeline.evidence import PhotoEvidence, read_photo
from treestroke.core.pipeline.growing import grow_live_tree
from treestroke.core.pipeline.grown_tree import LiveTree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sides import draw_side
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Sketch, Strokes, StrokeWarning
from treestroke.core.types import Indices, Mask, Picture


@dataclass(frozen=True, eq=False)
class PhotoTrace:
    """The foliage and branches of a photo, in photo px.

    Attributes
    ----------
    foliage
        (h, w) leaf pixels.
    evidence
        What both of them show, at the working size.
    skeleton
        The visible branches; None without a branch stroke.
    stroke
        (n,) index of the stroke that each joint follows, -1 where it was found.
    warnings
        What was mended, and what makes the result doubtful.
    """

    foliage: Mask
    evidence: PhotoEvidence
    skeleton: Skeleton | None
    stroke: Indices
    warnings: tuple[StrokeWarning, ...]


def trace_photo(photo: Picture, strokes: Strokes, known: PhotoEvidence | None = None) -> PhotoTrace:
    """Find the foliage and the visible branches of a photo (h, w, 3), sRGB.

    ``known`` is what an earlier trace of the same photo has read in the same crown: its foliage is kept, so that one
    more branch stroke is answered at once.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree.
    """
    return _at_photo_size(read_photo(photo, strokes, known))


def with_side(traced: PhotoTrace, side: Sketch | None) -> PhotoTrace:
    """Return the trace with another sketch of the tree's left side, which gives depth, or without one.

    Raises
    ------
    StrokesError
        The sketch does not describe a tree.
    """
    if side is None and traced.evidence.side is None:
        return traced
    evidence = replace(traced.evidence, side=None if side is None else draw_side(side, "side"))
    return replace(traced, evidence=evidence, warnings=evidence.warnings)


def grow_photo(traced: PhotoTrace, settings: ModelSettings, rng: np.random.Generator) -> LiveTree | None:
    """Return the tree that grows from what was traced; None without a branch stroke."""
    return None if traced.evidence.traced is None else grow_live_tree(traced.evidence, settings, rng)


def _at_photo_size(evidence: PhotoEvidence) -> PhotoTrace:
    """Scale the evidence to the photo's own size."""
    working, traced = evidence.working, evidence.traced
    mask = working.full_size_mask(evidence.foliage.mask)
    if traced is None:
        return PhotoTrace(mask, evidence, None, np.empty(0, dtype=np.int64), evidence.warnings)
    skeleton = working.full_size_skeleton(traced.skeleton)
    return PhotoTrace(mask, evidence, skeleton, traced.stroke, evidence.warnings)
