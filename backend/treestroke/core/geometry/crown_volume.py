"""The crown as a volume in metres, and as silhouettes in pictures."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np

from treestroke.core.geometry.camera import Camera
from treestroke.core.types import Floats, Mask

CameraT = TypeVar("CameraT", bound=Camera, covariant=True)


@dataclass(frozen=True, eq=False)
class Silhouette(Generic[CameraT]):
    """Pixels of a picture that show something.

    Attributes
    ----------
    mask
        (h, w) whether a pixel shows it.
    camera
        The picture's camera, of the same size.
    """

    mask: Mask
    camera: CameraT

    def shows(self, points_world: Floats) -> Mask:
        """Tell which world points (n, 3), metres, project onto the mask; those outside the picture do not: (n,)."""
        column, row = np.floor(self.camera.pixels_from_world(points_world)).astype(np.int64).T
        height, width = self.mask.shape
        seen = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        return np.asarray(seen & self.mask[np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)])


def shown_by_all(silhouettes: Iterable[Silhouette[Camera]], points_world: Floats) -> Mask:
    """Tell which world points (n, 3), metres, project onto every silhouette: flags (n,); all without silhouettes.

    Source: the visual hull (Laurentini 1994).
    """
    left = np.arange(len(points_world))
    for silhouette in silhouettes:
        left = left[silhouette.shows(points_world[left])]
    shown = np.zeros(len(points_world), dtype=np.bool_)
    shown[left] = True
    return shown


class CrownVolume(Protocol):
    """The solid that a crown fills, in the world's frame, metres: level sections about an axis that runs upward."""

    @property
    def bounds(self) -> Floats:
        """(2, 3) least and greatest corner of the box around it, metres."""

    @property
    def widest(self) -> float:
        """Half the width of its widest section from left to right, metres."""

    @property
    def front_area(self) -> float:
        """Area of its outline from the front, square metres."""

    @property
    def cubic_metres(self) -> float:
        """How large it is."""

    @property
    def depth_seen(self) -> bool:
        """Whether a picture shows how deep it is; otherwise that is assumed."""

    @property
    def shape(self) -> str:
        """What its sections are, in words that follow "the solid"."""

    def inside(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie in the volume: flags (n,)."""

    def shown(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie within the crown in all pictures of it: flags (n,).

        Some lie outside the volume, where a limb was seen that reaches beyond the sections.
        """

    def admits(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, no picture excludes: flags (n,); wider than `inside`.

        Where depth is assumed, points near the plane through the root may be admitted too.
        """

    def reach(self, points_world: Floats) -> Floats:
        """Measure how far out points (n, 3), metres, lie: (n,), 0 on the axis, 1 on the surface.

        It is the distance from the axis over the surface's along the same level ray; large above and below the volume.
        """

    def axis(self, heights_m: Floats) -> Floats:
        """Return the centres (n, 3), metres, of the sections at heights (n,), metres.

        Above and below the volume it is the centre of the nearest section.
        """

    def half_width(self, heights_m: Floats) -> Floats:
        """Measure half the width (n,), metres, from left to right at heights (n,), metres; 0 outside."""

    def half_depth(self, points_world: Floats) -> Floats:
        """Measure half the depth (n,), metres, from front to back at points' (n, 3) X and Y, metres; 0 outside."""
