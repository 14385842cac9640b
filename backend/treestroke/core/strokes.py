"""Strokes that a person draws over a photo or on white, as values."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats


@dataclass(frozen=True, eq=False)
class Stroke:
    """One drawn line: points (n, 2), px of the upright photo, n >= 2; width, px, where the person gave one."""

    points: Floats
    width: float | None = None


@dataclass(frozen=True, eq=False)
class Length:
    """A line over something of known length: its two ends (2, 2), px of the upright photo; its length, metres."""

    points: Floats
    metres: float


@dataclass(frozen=True, eq=False)
class Strokes:
    """All strokes of one tree.

    Attributes
    ----------
    crown
        Closed outline around the foliage (its last point joins its first).
    branches
        The first runs from the root up the trunk, each later one outward from its parent.
    erase
        Each drops the traced (not stroked) branches that it crosses.
    scale
        A known length that sets the tree's scale in place of its height; as far from the camera as the tree.
    """

    crown: Stroke
    branches: tuple[Stroke, ...] = ()
    erase: tuple[Stroke, ...] = ()
    scale: Length | None = None


@dataclass(frozen=True, eq=False)
class FrameStrokes:
    """Strokes that were drawn over one frame of a clip, by the frame's index."""

    strokes: Strokes
    frame: int = 0


@dataclass(frozen=True, eq=False)
class LengthInPhoto:
    """A line of known length that was drawn over one photo of a capture, by the photo's file name."""

    photo: str
    length: Length


@dataclass(frozen=True)
class CameraDistance:
    """How far apart the cameras of two photos stood: the photos' file names; metres."""

    photos: tuple[str, str]
    metres: float


@dataclass(frozen=True, eq=False)
class CaptureStrokes:
    """What was drawn over the photos of a capture.

    Attributes
    ----------
    by_photo
        Strokes by the photo's file name, in the order in which they were drawn; those of one photo at least.
    scale
        What sets the tree's scale in place of its height.
    """

    by_photo: Mapping[str, Strokes]
    scale: LengthInPhoto | CameraDistance | None = None

    @property
    def first(self) -> str:
        """The name of the first photo with a branch stroke, else of the first one: the tree's front."""
        return next((name for name, strokes in self.by_photo.items() if strokes.branches), next(iter(self.by_photo)))


@dataclass(frozen=True, eq=False)
class Sketch:
    """One side of a tree, drawn over a photo or on white: as lines, or as a picture of them.

    Attributes
    ----------
    canvas
        Its width and height, px.
    crown
        Closed outline around the foliage; None where none was drawn.
    branches
        The first is the trunk's; empty where there is ``ink``. A width is that of the brush, px.
    ink
        (h, w) bool, true on the strokes of a picture of the canvas's size; None where lines are given.
    """

    canvas: tuple[int, int]
    crown: Stroke | None = None
    branches: tuple[Stroke, ...] = ()
    ink: NDArray[np.bool_] | None = None


def same_stroke(one: Stroke, other: Stroke) -> bool:
    """Tell whether two strokes have the same points and the same width."""
    return one.width == other.width and np.array_equal(one.points, other.points)


def same_strokes(one: Strokes, other: Strokes) -> bool:
    """Tell whether two drawings have the same strokes."""
    if len(one.branches) != len(other.branches) or len(one.erase) != len(other.erase):
        return False
    if not _same_length(one.scale, other.scale):
        return False
    pairs = zip((one.crown, *one.branches, *one.erase), (other.crown, *other.branches, *other.erase), strict=True)
    return all(same_stroke(*pair) for pair in pairs)


def _same_length(one: Length | None, other: Length | None) -> bool:
    if one is None or other is None:
        return one is other
    return one.metres == other.metres and np.array_equal(one.points, other.points)


@dataclass(frozen=True)
class StrokeWarning:
    """Something that was mended in the strokes or in the photo.

    Attributes
    ----------
    code
        What it was, for programs.
    stroke
        Where: a pointer such as ``branches/1``; ``photo`` for the photo itself.
    detail
        What it was, for people.
    """

    code: str
    stroke: str
    detail: str


@dataclass(frozen=True, eq=False)
class MendedStrokes:
    """Strokes that can be used, and warnings of what was mended in them."""

    strokes: Strokes
    warnings: tuple[StrokeWarning, ...] = field(default=())
