"""A clip's recipe: for now its tree is that of the frame that was drawn on, and stands still."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.pipeline.evidence import PhotoEvidence, read_photo
from treestroke.core.pipeline.growing import grow_tree
from treestroke.core.pipeline.grown_tree import GrownTree
from treestroke.core.pipeline.photo import PhotoTrace, trace_photo
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.progress import Report, silent
from treestroke.core.stroke_rules import require_trunk
from treestroke.core.strokes import Strokes
from treestroke.core.types import Floats, Mask
from treestroke.core.video import Video


@dataclass(frozen=True, eq=False)
class Tracks:
    """Points of a tree that are followed: (f, k, 2), px of the picture, and in which frames (f, k) they are seen."""

    points: Floats
    seen: Mask


@dataclass(frozen=True, eq=False)
class ClipTrace:
    """What the chosen frame shows as a photo, and the tracks through all frames."""

    photo: PhotoTrace
    tracks: Tracks


@dataclass(frozen=True, eq=False)
class ClipEvidence:
    """What a clip and its strokes show."""

    photo: PhotoEvidence
    video: Video


def read_clip(video: Video, strokes: Strokes, report: Report = silent) -> ClipEvidence:
    """Read a clip by the strokes over its chosen frame.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree.
    """
    require_trunk(strokes)
    return ClipEvidence(read_photo(video.picture, strokes, None, report), video)


def trace_clip(video: Video, strokes: Strokes, known: ClipTrace | None = None) -> ClipTrace:
    """Trace a clip; ``known`` is its last trace by the same crown.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree.
    """
    photo = trace_photo(video.picture, strokes, None if known is None else known.photo.evidence)
    empty = np.zeros((len(video.frames), 0, 2))
    return ClipTrace(photo, Tracks(empty, np.zeros(empty.shape[:2], dtype=bool)))


def grow_clip(
    evidence: ClipEvidence, settings: ModelSettings, rng: np.random.Generator, report: Report = silent
) -> GrownTree:
    """Grow the tree of a clip."""
    return grow_tree(evidence.photo, settings, rng, report)
