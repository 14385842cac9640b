"""The working copy of a photo and its strokes, and its camera."""

from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.imaging.opacity import over_white
from treestroke.core.segment.occluders import Pole
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.stroke_rules import mend_strokes
from treestroke.core.strokes import Length, Stroke, Strokes, StrokeWarning
from treestroke.core.types import Floats, Mask, Opacity, Picture

WORKING_SIDE = 1600
"""Long side, px, to which a larger photo is reduced: the paper's constants are for about 1500."""
LEAST_SIDE, MOST_ENLARGED = 400, 4.0
"""Long side, px, to which a smaller one is enlarged, at most by this factor: the constants in pixels are not for trees
of 60 px. (Front overlap on 4 trees of 80 px: 0.65 becomes 0.73.)"""
SURROUNDINGS, BELOW = 0.5, 1.5
"""How much of the photo a tree is seen with, beside and above its crown and below it, as shares of the crown's size."""
CROPPED_SHARE = 0.6
"""Long side of a tree with its surroundings, as a share of the photo's, up to which the photo is cropped to them: a
small tree in a large photo keeps its detail."""
HALF, LEAST_TRANSPARENT = 128, 0.05
"""Share of the pixels with an alpha under a half, within the bounds of the others, from which on a photo counts as a
tree that was cut out: rounded corners and soft edges have less, and a photo on a larger transparent ground has none."""


@dataclass(frozen=True)
class Frame:
    """The part of a photo that its working copy shows.

    Attributes
    ----------
    corner, size
        Its top-left corner (x, y), and its width and height, px of the photo.
    scale
        Pixels of the copy for one of the photo.
    """

    corner: tuple[int, int]
    size: tuple[int, int]
    scale: float

    @property
    def copy_size(self) -> tuple[int, int]:
        """Width and height of the copy, px."""
        return max(1, round(self.size[0] * self.scale)), max(1, round(self.size[1] * self.scale))

    @property
    def part(self) -> tuple[slice, slice]:
        """Rows and columns of the photo."""
        (x, y), (width, height) = self.corner, self.size
        return slice(y, y + height), slice(x, x + width)


@dataclass(frozen=True, eq=False)
class WorkingCopy:
    """The working copy of a photo, with mended strokes to match.

    Attributes
    ----------
    photo, strokes
        What is worked on, at the copy's scale.
    frame
        The part of the photo that it shows.
    size
        The photo's own width and height, px.
    warnings
        What was mended in the strokes.
    cut_out
        (h, w) opacity of a tree that was cut out; None where the photo is whole.
    corner
        (x, y) of the copy in ``photo``, px, where this is a larger canvas: the crown was completed beyond the edges.
    poles
        Poles and wires before the crown, px of the copy, that were painted over in ``photo``.
    """

    photo: Picture
    strokes: Strokes
    frame: Frame
    size: tuple[int, int]
    warnings: tuple[StrokeWarning, ...]
    cut_out: Opacity | None = None
    corner: tuple[int, int] = (0, 0)
    poles: tuple[Pole, ...] = ()

    def height_px(self, mask: Mask) -> float:
        """Measure the tree, px, from its root to the foliage's top (h, w), or to the crown's where there is no leaf."""
        rows = np.flatnonzero(mask.any(axis=1))
        top = float(rows[0]) if rows.size else float(self.strokes.crown.points[:, 1].min())
        return max(float(self.strokes.branches[0].points[0, 1]) - top, 1.0)

    def camera(self, mask: Mask, height_m: float) -> OrthographicCamera:
        """Return the camera of the copy; its scale follows from the known length, else from the tree's height, metres.

        ``mask`` (h, w) is the foliage.
        """
        root, known = self.strokes.branches[0].points[0], self.strokes.scale
        scale = height_m / self.height_px(mask)
        if known is not None:
            scale = known.metres / float(np.hypot(*(known.points[1] - known.points[0])))
        return OrthographicCamera(self.photo.shape[1], self.photo.shape[0], scale, (float(root[0]), float(root[1])))

    def full_size_camera(self, camera: OrthographicCamera) -> OrthographicCamera:
        """Return the same camera for the photo at its own size."""
        part = camera.cropped(self.corner, self.frame.copy_size).enlarged(self.frame.scale, self.frame.size)
        return part.cropped((-self.frame.corner[0], -self.frame.corner[1]), self.size)

    def full_size_mask(self, mask: Mask) -> Mask:
        """Return a mask of the copy (h, w) at the photo's own size; it is empty where the copy does not show it."""
        whole = np.zeros(self.size[::-1], dtype=np.uint8)
        whole[self.frame.part] = cv2.resize(mask.astype(np.uint8), self.frame.size, interpolation=cv2.INTER_NEAREST)
        return whole.astype(bool)

    def full_size_skeleton(self, skeleton: Skeleton) -> Skeleton:
        """Return a 2D skeleton of the copy, px, in the photo's own pixels."""
        scale = self.frame.scale
        return Skeleton(skeleton.points / scale + self.frame.corner, skeleton.radii / scale, skeleton.parents)

    def on_canvas(self, canvas: Picture, corner: tuple[int, int]) -> "WorkingCopy":
        """Return the copy on a larger ``canvas`` (h, w, 3), which shows it at a ``corner`` (x, y), px."""
        strokes = _moved(self.strokes, 1.0, np.array(corner, dtype=np.float64))
        return replace(self, photo=canvas, strokes=strokes, cut_out=None, corner=corner)

    def in_photo(self, mask: Mask) -> Mask:
        """Return what the photo shows of a mask (h, w) of the copy or its canvas, at the copy's size or smaller."""
        (x, y), (width, height) = self.corner, self.frame.copy_size
        part = mask[y : y + height, x : x + width]
        if self.frame.size == self.size:
            return part
        scale = min(1.0, WORKING_SIDE / max(self.size))
        columns, rows = (
            slice(round(start * scale), round((start + length) * scale))
            for start, length in zip(self.frame.corner, self.frame.size, strict=True)
        )
        shown = np.zeros((round(self.size[1] * scale), round(self.size[0] * scale)), dtype=np.uint8)
        place = shown[rows, columns]
        place[:] = cv2.resize(part.astype(np.uint8), place.shape[::-1], interpolation=cv2.INTER_NEAREST)
        return shown.astype(bool)


def working_copy(photo: Picture, strokes: Strokes) -> WorkingCopy:
    """Mend the strokes (px) and bring the tree in a photo (h, w, 3 or 4), sRGB, to the working size, with its strokes.

    A photo much larger than the tree is cropped to its surroundings. Transparent pixels are laid over white.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree.
    """
    height, width = photo.shape[:2]
    mended = mend_strokes(strokes, width, height)
    frame = _frame(mended.strokes, width, height)
    part = photo[frame.part]
    opacity = _cut_out(part)
    copy = _resized(over_white(part), frame).astype(np.uint8, copy=False)
    fitted = _moved(mended.strokes, frame.scale, -frame.scale * np.array(frame.corner, dtype=np.float64))
    cut_out = None if opacity is None else np.clip(_resized(opacity, frame), 0, 1).astype(np.float32)
    return WorkingCopy(np.ascontiguousarray(copy), fitted, frame, (width, height), mended.warnings, cut_out)


def _resized(part: NDArray[Any], frame: Frame) -> NDArray[Any]:
    """Return a part of a photo (h, w, ...) at the size of its working copy."""
    if frame.scale == 1.0:
        return part
    method = cv2.INTER_AREA if frame.scale < 1.0 else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(part, frame.copy_size, interpolation=method))


def _frame(strokes: Strokes, width: int, height: int) -> Frame:
    """Return the part of a photo of this size, px, that shows a tree with its surroundings, and its scale."""
    crown = strokes.crown.points
    drawn = np.vstack([stroke.points for stroke in (strokes.crown, *strokes.branches, *strokes.erase)])
    if strokes.scale is not None:
        drawn = np.vstack([drawn, strokes.scale.points])
    room = SURROUNDINGS * float(np.ptp(crown, axis=0).max())
    below = crown.max(axis=0) + BELOW / SURROUNDINGS * np.array([0.0, room])
    low = np.maximum(np.floor(drawn.min(axis=0) - room), 0).astype(int)
    high = np.ceil(np.maximum(drawn.max(axis=0) + room, below)).astype(int)
    high = np.minimum(high, (width, height))
    corner, size = (int(low[0]), int(low[1])), (int(high[0] - low[0]), int(high[1] - low[1]))
    if max(size) > CROPPED_SHARE * max(width, height):
        corner, size = (0, 0), (width, height)
    return Frame(corner, size, _scale(max(size)))


def _scale(side: int) -> float:
    """Return the scale of the working copy of a picture with this long side, px."""
    if side > WORKING_SIDE:
        return WORKING_SIDE / side
    return min(max(LEAST_SIDE / side, 1.0), MOST_ENLARGED)


def _cut_out(photo: Picture) -> Opacity | None:
    """Return the opacity (h, w) of a tree that was cut out of a photo (h, w, 4); None where next to all is opaque."""
    if photo.shape[2] == 3:
        return None
    alpha = photo[..., 3]
    left, top, width, height = cv2.boundingRect((alpha >= HALF).astype(np.uint8))
    within = alpha[top : top + height, left : left + width]
    if np.count_nonzero(within < HALF) < LEAST_TRANSPARENT * within.size:
        return None
    return np.asarray(alpha * np.float32(1 / 255), dtype=np.float32)


def _moved(strokes: Strokes, scale: float, shift: Floats) -> Strokes:
    """Return strokes scaled, and then moved by a ``shift`` (2,), px."""

    def moved(strokes: tuple[Stroke, ...]) -> tuple[Stroke, ...]:
        return tuple(Stroke(s.points * scale + shift, None if s.width is None else s.width * scale) for s in strokes)

    known = strokes.scale
    length = None if known is None else Length(known.points * scale + shift, known.metres)
    return Strokes(moved((strokes.crown,))[0], moved(strokes.branches), moved(strokes.erase), length)
