"""What pictures show of a tree: where its leaves and wood are, and which colours they have."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.types import Floats, Mask, Opacity, Picture


@dataclass(frozen=True, eq=False)
class StemPixels:
    """Where a picture shows the first stem.

    Attributes
    ----------
    points_px
        (m, 2) points along its axis, root first, px; two or more.
    radii_px
        (m,) its radius there, px; 0 where it is hidden.
    """

    points_px: Floats
    radii_px: Floats


OWN_COLOUR_SHARE = 0.1
"""Share of the foliage's pixels above which colours are taken only from those that are leaves by their own colour."""


@dataclass(frozen=True, eq=False)
class View:
    """What one picture (h, w) shows of a tree; blank where it was drawn on white.

    Attributes
    ----------
    camera
        The picture's camera.
    picture
        (h, w, 3) sRGB.
    leaves_from
        (h, w) depth in this camera, metres, from which on leaves may lie: minus infinity in the foliage, the wood's
        depth where wood is seen, infinity elsewhere.
    opacity
        (h, w) share of each pixel that foliage covers.
    leaf_coloured
        (h, w) pixels that by their own colour are leaves.
    tree
        (h, w) foliage and wood that are seen.
    stem
        Where bark is read.
    """

    camera: Camera
    picture: Picture
    leaves_from: NDArray[np.float32]
    opacity: Opacity
    leaf_coloured: Mask
    tree: Mask
    stem: StemPixels

    def __post_init__(self) -> None:
        shape = (self.camera.height, self.camera.width)
        maps = (self.picture, self.leaves_from, self.opacity, self.leaf_coloured, self.tree)
        sizes = [found.shape[:2] for found in maps]
        if any(size != shape for size in sizes):
            raise ValueError(f"a view's maps must be of its camera's size {shape}, got {sizes}")

    @cached_property
    def foliage(self) -> Mask:
        """(h, w) pixels of the foliage."""
        return np.isneginf(self.leaves_from)

    @cached_property
    def own_colour(self) -> Opacity:
        """(h, w) share of each pixel that shows a leaf in its own colour."""
        own = self.leaf_coloured & self.foliage
        most = np.count_nonzero(own) > OWN_COLOUR_SHARE * np.count_nonzero(self.foliage)
        leaves = own if most else self.foliage
        return np.where(leaves, self.opacity, np.float32(0))


@dataclass(frozen=True, eq=False)
class Appearance:
    """What leaves, fruit and bark are made to look like.

    Attributes
    ----------
    views
        One or more; the first sets the sizes of leaves.
    shows_leaves
        Whether they show leaves in their colours.
    imagined_sides
        Where foliage is imagined to be from sides that no view shows.
    """

    views: tuple[View, ...]
    shows_leaves: bool
    imagined_sides: tuple[Silhouette[Camera], ...] = ()

    def __post_init__(self) -> None:
        if not self.views:
            raise ValueError("an appearance needs a view")

    @property
    def bark_view(self) -> View:
        """The view that shows the stem largest."""
        return max(self.views, key=lambda view: float(view.stem.radii_px.sum()))
