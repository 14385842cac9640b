"""Photos of one tree from several places, with their cameras, and what they show together."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.types import Floats, Mask, Opacity, Picture


@dataclass(frozen=True, eq=False)
class CapturedPhoto:
    """One photo of a capture, as it is read.

    Attributes
    ----------
    name
        Its file name.
    picture
        (h, w, 3) sRGB, upright, perhaps smaller than the photo.
    focal_px
        Its lens's focal length, px of the picture, where the file tells.
    photo_px
        (width, height) of the upright photo, where the picture is smaller.
    """

    name: str
    picture: Picture
    focal_px: float | None = None
    photo_px: tuple[int, int] | None = None

    @property
    def size_px(self) -> tuple[int, int]:
        """(width, height) of the upright photo."""
        return self.photo_px or (self.picture.shape[1], self.picture.shape[0])

    @property
    def reduction(self) -> float:
        """Pixels of the picture for one of the photo, at most 1."""
        return float(self.picture.shape[1] / self.size_px[0])


@dataclass(frozen=True, eq=False)
class Shot:
    """One photo of a capture and the camera that took it.

    Attributes
    ----------
    name
        The photo's file name.
    picture
        (h, w, 3) sRGB, upright, free of lens distortion.
    camera
        Its camera, of the picture's size, in the frame that all shots share.
    """

    name: str
    picture: Picture
    camera: PerspectiveCamera

    def __post_init__(self) -> None:
        if self.picture.shape != (self.camera.height, self.camera.width, 3):
            raise ValueError(f"{self.name}: the picture {self.picture.shape} does not fit its camera {self.camera}")


@dataclass(frozen=True, eq=False)
class PointCloud:
    """Points that several shots see, in the shots' frame.

    Attributes
    ----------
    points
        (n, 3) where they are.
    colours
        (n, 3) sRGB.
    seen
        (n, shots) which shots see each, in the order of the shots.
    """

    points: Floats
    colours: NDArray[np.uint8]
    seen: Mask

    def __post_init__(self) -> None:
        count = len(self.points)
        if self.points.shape != (count, 3) or self.colours.shape != (count, 3) or len(self.seen) != count:
            shapes = self.points.shape, self.colours.shape, self.seen.shape
            raise ValueError(f"a point cloud needs (n, 3), (n, 3) and (n, shots), got {shapes}")

    def __len__(self) -> int:
        return len(self.points)

    def select(self, chosen: Mask) -> "PointCloud":
        """Return the points of which ``chosen`` (n,) is true."""
        return PointCloud(self.points[chosen], self.colours[chosen], self.seen[chosen])


@dataclass(frozen=True, eq=False)
class SolvedPhoto:
    """A photo whose camera was found.

    Attributes
    ----------
    name
        Its file name.
    camera
        Its camera, of the size of the captured picture, in the structure's frame.
    radial
        Radial distortion k of its lens: a ray at (x, y), both over the depth, is seen at (x, y) (1 + k (x^2 + y^2))
        times the focal length from the principal point.
    """

    name: str
    camera: PerspectiveCamera
    radial: float


@dataclass(frozen=True)
class UnusedPhoto:
    """A photo whose camera was not found: its file name, a code for programs, and the reason for people."""

    name: str
    code: str
    detail: str


@dataclass(frozen=True, eq=False)
class Structure:
    """Where a capture's photos were taken and points that several of them see: structure from motion.

    The frame is right-handed with Y up; its origin, its turn about Y and its scale are chosen freely.

    Attributes
    ----------
    photos
        Those used, in the order in which they were given.
    cloud
        Points; ``seen`` is in the order of ``photos``.
    unused
        Those left out, in the order in which they were given.
    """

    photos: tuple[SolvedPhoto, ...]
    cloud: PointCloud
    unused: tuple[UnusedPhoto, ...]


@dataclass(frozen=True, eq=False)
class TreeMatte:
    """Where a shot (h, w) shows the tree.

    Attributes
    ----------
    opacity
        (h, w) share of each pixel that leaves and wood of the tree cover.
    wood
        (h, w) how likely what is seen of the tree there is wood, 0 to 1; 0 beside the tree.
    hidden
        (h, w) where something stands before the tree, so that the shot does not tell.
    """

    opacity: Opacity
    wood: Opacity
    hidden: Mask

    @property
    def tree(self) -> Mask:
        """(h, w) pixels that the tree covers by half or more."""
        return np.asarray(self.opacity >= 0.5)


def evenly(count: int, most: int) -> list[int]:
    """Return the numbers of at most ``most`` of ``count`` shots, evenly spread, ascending; all if there are fewer."""
    chosen = np.linspace(0, count - 1, min(count, most)).round().astype(np.int64)
    return [int(number) for number in chosen]
