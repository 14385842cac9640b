"""A grown tree without leaves and bark: the result of every recipe's first half."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from treestroke.core.appearance import Appearance
from treestroke.core.capture import UnusedPhoto
from treestroke.core.geometry.camera import Camera, OrthographicCamera, PerspectiveCamera
from treestroke.core.geometry.crown_volume import CrownVolume, Silhouette
from treestroke.core.grow.grown import Grown
from treestroke.core.pipeline.taken import Taken
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import StrokeWarning
from treestroke.core.survey.measures import Stature
from treestroke.core.types import FoliageKind, Indices

if TYPE_CHECKING:  # with scipy, slow to import, and of no use for one photo
    from treestroke.core.film.tracks import Tracks
    from treestroke.core.siblings.motion_model import MotionModel


@dataclass(frozen=True, eq=False)
class LiveTree:
    """A grown tree before it has leaves and bark.

    Attributes
    ----------
    skeleton
        The whole tree, metres, world frame.
    born
        (n,) iteration at which each joint appeared, from 1; 0 in the visible tree.
    camera
        Camera of the picture at its own size.
    """

    skeleton: Skeleton
    born: Indices
    camera: OrthographicCamera


@dataclass(frozen=True)
class Reading:
    """The target of a tree's front view, and how reliable it is.

    Attributes
    ----------
    against
        The target in words, for the report.
    doubts
        Codes of what makes the reading doubtful.
    completed
        What was completed: the crown beyond the photo's left, right or top edge, the trunk's hidden foot.
    """

    against: str
    doubts: tuple[str, ...]
    completed: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class CapturedViews:
    """Where the photos of a capture were taken.

    Attributes
    ----------
    names
        File names of those that were used.
    cameras
        Their cameras, of the upright photos' own sizes, in the same order.
    unused
        Those that were left out.
    """

    names: tuple[str, ...]
    cameras: tuple[PerspectiveCamera, ...]
    unused: tuple[UnusedPhoto, ...]


@dataclass(frozen=True, eq=False)
class Filmed:
    """How a clip shows a tree move.

    Attributes
    ----------
    tracks
        Points of the tree in all frames, px of the chosen frame's picture at its own size.
    frames_per_second
        Of the frames.
    chosen
        Index of the frame that was drawn on, in which the tree is as it was grown.
    """

    tracks: "Tracks"
    frames_per_second: float
    chosen: int


@dataclass(frozen=True, eq=False)
class LearntMotion:
    """How a sibling moves, as was learnt of its example.

    Attributes
    ----------
    model
        How branches turn.
    frames_per_second
        Of the series.
    sway
        How far the example's branches sway in the median, over its extent.
    """

    model: "MotionModel"
    frames_per_second: float
    sway: float


@dataclass(frozen=True, eq=False)
class GrownTree:
    """A grown tree, whatever its source.

    Attributes
    ----------
    taken
        What the tree is taken for.
    grown
        The whole tree.
    volume
        The crown.
    appearance
        What its leaves, fruit and bark are made to look like.
    camera
        Camera of the front picture at its own size, which files name and previews use.
    expected
        What its views should cover, each mask (h, w) at any size of its camera's picture: visible foliage and branches.
    stature
        Its size, and how that is known.
    score
        How well it does what it was grown for, by name.
    reading
        What the score is measured against.
    warnings
        What was mended or assumed.
    captured
        Where its photos were taken, of a tree that was measured from several.
    moves
        How it moves: as it was filmed, or as was learnt of a filmed example.
    """

    taken: Taken
    grown: Grown
    volume: CrownVolume
    appearance: Appearance
    camera: OrthographicCamera
    expected: tuple[Silhouette[Camera], ...]
    stature: Stature
    score: dict[str, float]
    reading: Reading
    warnings: tuple[StrokeWarning, ...]
    captured: CapturedViews | None = None
    moves: Filmed | LearntMotion | None = None

    @property
    def kind(self) -> FoliageKind:
        """What the twigs bear."""
        return self.taken.foliage

    @property
    def live(self) -> LiveTree:
        """The tree as it is shown before it is finished."""
        return LiveTree(self.grown.skeleton, self.grown.born, self.camera)
