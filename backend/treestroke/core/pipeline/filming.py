"""A clip's recipe (Li et al. 2011): the tree of the frame that was drawn on, and how it moves in all frames."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from treestroke.core.errors import ClipError
from treestroke.core.film.shake import camera_motion, without_camera
from treestroke.core.film.tracks import Tracks, follow
from treestroke.core.pipeline.assumed_trunk import with_trunk
from treestroke.core.pipeline.crowns import drawn
from treestroke.core.pipeline.evidence import PhotoEvidence, read_photo
from treestroke.core.pipeline.growing import grow_tree
from treestroke.core.pipeline.grown_tree import Filmed, GrownTree
from treestroke.core.pipeline.photo import PhotoTrace, trace_photo
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.swaying_limbs import with_swaying_limbs
from treestroke.core.progress import Report, silent
from treestroke.core.strokes import Strokes, StrokeWarning
from treestroke.core.types import Mask
from treestroke.core.video import Video

FEWEST_TRACKS = 24
"""Points that must be found on a tree to follow it."""
MOST_SHIFT = 0.12
"""Greatest motion of the camera, over the picture's width, that is taken out."""
BACKGROUND_TRACKS = 250
_BESIDE = 0.04  # over the picture's width: what is so near the tree is not background
_LOST = 0.15  # share of the points that are followed at once, below which a warning says so


@dataclass(frozen=True, eq=False)
class ClipTrace:
    """What the chosen frame shows as a photo, and the tracks through all frames, px of the picture."""

    photo: PhotoTrace
    tracks: Tracks


@dataclass(frozen=True, eq=False)
class ClipEvidence:
    """What a clip and its strokes show."""

    photo: PhotoEvidence
    filmed: Filmed
    warnings: tuple[StrokeWarning, ...]


def read_clip(video: Video, strokes: Strokes, report: Report = silent) -> ClipEvidence:
    """Read a clip by the strokes over its chosen frame; without a trunk stroke its place is assumed.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree.
    ClipError
        The tree cannot be followed, or the camera moves too much.
    """
    strokes, assumed = with_trunk(video.picture, strokes)
    evidence = read_photo(video.picture, strokes, None, report)
    report("follow", 0.0)
    tracks = _followed(video, _tree_of(evidence), report)
    filmed = Filmed(tracks, video.frames_per_second, video.chosen)
    return ClipEvidence(with_swaying_limbs(evidence, tracks), filmed, (*assumed, *_doubts(tracks)))


def trace_clip(video: Video, strokes: Strokes, known: ClipTrace | None = None) -> ClipTrace:
    """Trace a clip; ``known`` is an earlier trace by the same crown, whose tracks are kept.

    Raises
    ------
    StrokesError, ClipError
        As `read_clip`.
    """
    photo = trace_photo(video.picture, strokes, None if known is None else known.photo.evidence)
    return ClipTrace(photo, _followed(video, _tree_of(photo.evidence), silent) if known is None else known.tracks)


def grow_clip(
    evidence: ClipEvidence, settings: ModelSettings, rng: np.random.Generator, report: Report = silent
) -> GrownTree:
    """Grow the tree of a clip."""
    tree = grow_tree(evidence.photo, settings, rng, report)
    return replace(tree, filmed=evidence.filmed, warnings=(*tree.warnings, *evidence.warnings))


def _tree_of(evidence: PhotoEvidence) -> Mask:
    """Return where the picture (h, w) shows the tree: its foliage and traced wood."""
    mask = evidence.foliage.mask
    if evidence.traced is not None:
        mask = mask | drawn(evidence.traced.skeleton, mask.shape)
    return evidence.working.full_size_mask(mask)


def _followed(video: Video, tree: Mask, report: Report) -> Tracks:
    """Follow the tree, px of the picture, without the camera's own motion."""
    height, width = video.frames.shape[1:]
    region = cv2.resize(tree.astype(np.uint8), (width, height), interpolation=cv2.INTER_AREA) > 0
    tracks = follow(video.frames, video.chosen, region, report)
    if tracks.seen[video.chosen].sum() < FEWEST_TRACKS:
        fault = "the tree has no texture that could be followed"
        raise ClipError(f"clip: {fault}; outline its foliage, or film it nearer and sharper", code="clip_plain")
    around = cv2.dilate(region.astype(np.uint8), np.ones((3, 3)), iterations=max(1, round(_BESIDE * width))) == 0
    motion = camera_motion(follow(video.frames, video.chosen, around, most=BACKGROUND_TRACKS), (width, height))
    shift = float(motion.shift_px.max()) / width
    if shift > MOST_SHIFT:
        fault = f"the camera moves by {shift:.0%} of the picture's width"
        raise ClipError(f"clip: {fault}; film from one place, with the camera held still", code="clip_shaken")
    return without_camera(tracks, motion).enlarged(video.enlarged)


def _doubts(tracks: Tracks) -> tuple[StrokeWarning, ...]:
    """Say where only few points could be followed."""
    share = float(tracks.seen.sum(axis=1).min() / max(tracks.seen.sum(axis=1).max(), 1))
    if share >= _LOST:
        return ()
    detail = f"at times only {share:.0%} of the points are followed; the motion there is guessed from the others"
    return (StrokeWarning("tracks_lost", "clip", detail),)
