"""A tree that has grown and is not dressed yet: what every recipe's first half ends in."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.envelope import Envelope
from treestroke.core.grow.grown import Grown
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import StrokeWarning
from treestroke.core.survey.measures import Scale
from treestroke.core.types import Floats, FoliageKind, Indices, Mask, Picture


@dataclass(frozen=True, eq=False)
class LiveTree:
    """A grown tree before it has leaves and bark.

    Attributes
    ----------
    skeleton
        The whole tree, metres, world frame.
    born
        (n,) iteration at which each joint appeared, from 1; 0 for those of the visible tree.
    camera
        That of the picture at its own size.
    """

    skeleton: Skeleton
    born: Indices
    camera: Camera


@dataclass(frozen=True, eq=False)
class Portrait:
    """The picture that a tree is dressed after, at the working size; blank where it was drawn on white.

    Attributes
    ----------
    photo
        (h, w, 3), sRGB.
    shows_leaves
        Whether it shows leaves, in their colours.
    leaves
        (h, w) pixels that by their own colour are leaves.
    front
        (h, w) world Z, metres, behind which leaves may lie: infinite in the foliage, that of the wood where it is seen.
    stem, stem_radii
        (m, 2) and (m,) places along the first stem, root first, px, and its radius where it is seen, else 0.
    """

    photo: Picture
    shows_leaves: bool
    leaves: Mask
    front: NDArray[np.float32]
    stem: Floats
    stem_radii: Floats


@dataclass(frozen=True, eq=False)
class Stature:
    """How large a tree is, and how that is known.

    Attributes
    ----------
    height
        From its root to the top of its foliage, metres.
    scale
        What metres rest on.
    trunk_seen
        Whether it is seen how thick the trunk is at breast height.
    crown
        The crown's solid as wide as it is seen.
    """

    height: float
    scale: Scale
    trunk_seen: bool
    crown: Envelope


@dataclass(frozen=True)
class Reading:
    """What a tree's likeness is measured against, and how far that is to be trusted.

    Attributes
    ----------
    against
        What was read, in words.
    kind_sureness
        How sure it is that the tree bears leaves, or none, 0 to 1; 1 where it was said.
    doubts
        Codes of what makes the reading doubtful.
    """

    against: str
    kind_sureness: float
    doubts: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class GrownTree:
    """A tree that has grown.

    Attributes
    ----------
    kind
        What the twigs bear.
    grown
        The whole tree.
    envelope
        The crown's solid, in the frame of the working size.
    camera
        That of the picture at its own size.
    portrait
        What it is dressed after.
    stature
        What it is measured by.
    likeness
        (h, w), at the working size, what the front view should cover: foliage and branches that were seen.
    score
        How well it does what it was grown for, by name.
    reading
        What that is measured against.
    warnings
        What was mended or assumed.
    """

    kind: FoliageKind
    grown: Grown
    envelope: Envelope
    camera: Camera
    portrait: Portrait
    stature: Stature
    likeness: Mask
    score: dict[str, float]
    reading: Reading
    warnings: tuple[StrokeWarning, ...]

    @property
    def live(self) -> LiveTree:
        """The tree as it may be shown before it is finished."""
        return LiveTree(self.grown.skeleton, self.grown.born, self.camera)
