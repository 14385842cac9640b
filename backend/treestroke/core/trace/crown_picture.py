"""The part of a photo in which limbs are looked for, and what it shows of them whatever strokes are drawn."""

from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.trace.appearance import Surroundings
from treestroke.core.trace.limb_lines import CONTRAST, Lines, find_lines, pieces, reduction
from treestroke.core.trace.ribbons import Ribbons
from treestroke.core.types import Floats, Mask, Picture

FINEST_SIDE = 800
"""Long side, px, to which a larger crown is reduced: a stroke is answered at once."""
BELOW = 0.12
"""How far below the crown its picture reaches, as a share of the tree's height: as far as a limb may be hidden."""
AROUND, AMONG = 0.03, 0.75
"""How far around a line, in tree heights, foliage is looked for, and which share of it tells that the line lies among
leaves: elsewhere hedges and shadows behind the tree are lines, too, and only what has the colours of wood is a limb."""
SURE = 1.0
"""Log odds of wood of what has its colours."""
MOST_ODDS = 2.0
"""Log odds of wood beyond which colour tells nothing more about a line."""

Kind = TypeVar("Kind", bound=np.generic)


@dataclass(frozen=True, eq=False)
class Window:
    """A part of a photo: where it begins, and its size, in px (2,) as x and y, and by how much it is reduced."""

    corner: tuple[int, int]
    extent: tuple[int, int]
    scale: float

    @property
    def size(self) -> tuple[int, int]:
        """Its width and height, px, reduced."""
        width, height = self.extent
        return max(1, round(width * self.scale)), max(1, round(height * self.scale))

    def cut(self, photo: NDArray[Kind]) -> NDArray[Kind]:
        """Return the part of a picture (h, w) of the photo, not reduced."""
        (x, y), (width, height) = self.corner, self.extent
        return photo[y : y + height, x : x + width]

    def reduced(self, photo: NDArray[Kind]) -> NDArray[np.float32]:
        """Return the part of a picture (h, w) of the photo, reduced."""
        return _resized(self.cut(photo).astype(np.float32), self.size)

    def inside(self, points: Floats) -> Floats:
        """Return points (n, 2) of the photo, px, in the window's px."""
        return np.asarray((points - self.corner) * self.scale)

    def outside(self, points: Floats) -> Floats:
        """Return points (n, 2) of the window, px, in the photo's px."""
        return np.asarray(points / self.scale + self.corner)


@dataclass(frozen=True, eq=False)
class CrownPicture:
    """What a photo shows of a crown and its limbs, whatever strokes are drawn.

    Attributes
    ----------
    window
        The part around the crown, in whose px all else is.
    crown
        (h, w) where limbs are looked for.
    foliage
        (h, w) where leaves may hide a limb.
    tree_px
        The tree's height, px of the photo.
    lightness
        (h, w) 0 to 255; None where shade tells nothing: between sprays of needles or scales it makes lines like limbs.
    """

    window: Window
    crown: Mask
    foliage: Mask
    tree_px: float
    lightness: NDArray[np.float32] | None

    @property
    def height_px(self) -> float:
        """The tree's height."""
        return self.tree_px * self.window.scale

    @cached_property
    def shade(self) -> Lines | None:
        """Dark lines in the lightness.

        What is lighter than most leaves is taken to be as light as they: no leaf is a dark line before the sky.
        """
        if self.lightness is None:
            return None
        scale = reduction(self.crown.shape)
        size = _reduced(self.crown.shape)
        usual = float(np.median(self.lightness[self.foliage]))
        dark = _resized(np.float32(usual) - np.minimum(self.lightness, np.float32(usual)), size)
        inside = cv2.resize(self.crown.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST) > 0
        contrast = max(float(np.std(dark[inside])), 1.0)
        picture = np.clip(255 - CONTRAST / contrast * dark, 0, 255).astype(np.uint8)
        return find_lines(picture, inside, self.height_px * scale)

    def pieces(self, smooth: NDArray[np.float32]) -> Ribbons | None:
        """Return the pieces of limbs by shade and by log odds of wood (h, w); None where shade tells nothing."""
        if self.shade is None:
            return None
        small = _resized(smooth, self.shade.rarity.shape[::-1])
        colour = np.clip(128 - CONTRAST * np.clip(small, -MOST_ODDS, MOST_ODDS), 0, 255).astype(np.uint8)
        lines = find_lines(colour, self.shade.inside, self.height_px * reduction(self.crown.shape))
        return pieces((self.shade, lines), self._among_leaves | (small > SURE), self.crown.shape, self.height_px)

    @cached_property
    def _among_leaves(self) -> Mask:
        """Where (h, w), at the size of lines, there are leaves on all sides."""
        scale = reduction(self.crown.shape)
        foliage = _resized(self.foliage.astype(np.float32), _reduced(self.crown.shape))
        reach = 2 * round(AROUND * self.height_px * scale) + 1
        return np.asarray(cv2.blur(foliage, (reach, reach)) > AMONG)


def see_crown(photo: Picture, surroundings: Surroundings, height_px: float) -> CrownPicture:
    """Look at the crown of a tree ``height_px`` high in a photo (h, w, 3), sRGB."""
    window = _around(surroundings.crown, round(BELOW * height_px))
    crown, foliage = window.reduced(surroundings.crown) > 0.5, window.reduced(surroundings.foliage) > 0.5
    lightness = None
    if surroundings.broad and foliage.any():
        lab = cv2.cvtColor(np.ascontiguousarray(window.cut(photo)), cv2.COLOR_RGB2LAB)
        lightness = _resized(lab[..., 0].astype(np.float32), window.size)
    return CrownPicture(window, crown, foliage, height_px, lightness)


def _around(crown: Mask, below_px: int) -> Window:
    """Return the part of a photo around a crown (h, w) and below it."""
    x, y, width, height = cv2.boundingRect(crown.astype(np.uint8))
    height = min(height + below_px, crown.shape[0] - y)
    return Window((x, y), (width, height), min(1.0, FINEST_SIDE / max(width, height, 1)))


def _reduced(shape: tuple[int, ...]) -> tuple[int, int]:
    """Return the size (width, height) at which lines are looked for in a picture (h, w)."""
    scale = reduction(shape)
    return max(1, round(shape[1] * scale)), max(1, round(shape[0] * scale))


def _resized(picture: NDArray[np.float32], size: tuple[int, int]) -> NDArray[np.float32]:
    """Return a picture (h, w) at a smaller size (width, height), or as it is."""
    if size == picture.shape[::-1]:
        return picture
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.float32)
