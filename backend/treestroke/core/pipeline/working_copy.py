"""The working copy of a photo and its strokes, and its camera."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.imaging.opacity import over_white
from treestroke.core.stroke_rules import mend_strokes
from treestroke.core.strokes import Length, Stroke, Strokes, StrokeWarning
from treestroke.core.types import Floats, Mask, Opacity, Picture

WORKING_SIDE = 1600
"""Long side, px, to which a larger photo is reduced: the paper's constants are for about 1500."""
HALF, LEAST_TRANSPARENT = 128, 0.05
"""Share of its pixels with an alpha under a half from which on a photo counts as a tree that was cut out: rounded
corners and soft edges have less."""


@dataclass(frozen=True, eq=False)
class WorkingCopy:
    """The working copy of a photo: reduced by ``scale`` (1 or less), with mended strokes to match.

    ``size`` is the photo's own width and height, px, ``cut_out`` the opacity (h, w) of a tree that was cut out. Where
    the crown is completed beyond the photo's edges, ``photo`` is a larger canvas with the photo at ``corner`` (x, y),
    px.
    """

    photo: Picture
    strokes: Strokes
    scale: float
    size: tuple[int, int]
    warnings: tuple[StrokeWarning, ...]
    cut_out: Opacity | None = None
    corner: tuple[int, int] = (0, 0)

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
        return camera.cropped(self.corner, _reduced(self.size, self.scale)).enlarged(self.scale, self.size)

    def on_canvas(self, canvas: Picture, corner: tuple[int, int]) -> "WorkingCopy":
        """Return the copy on a larger ``canvas`` (h, w, 3), which shows it at a ``corner`` (x, y), px."""
        strokes = _moved(self.strokes, 1.0, np.array(corner, dtype=np.float64))
        return replace(self, photo=canvas, strokes=strokes, cut_out=None, corner=corner)

    def in_photo(self, mask: Mask) -> Mask:
        """Return the part of a canvas's mask (h, w) that the photo shows."""
        (x, y), (width, height) = self.corner, _reduced(self.size, self.scale)
        return mask[y : y + height, x : x + width]


def working_copy(photo: Picture, strokes: Strokes) -> WorkingCopy:
    """Mend the strokes (px) and reduce a large photo (h, w, 3 or 4), sRGB, to `WORKING_SIDE` px, with its strokes.

    Transparent pixels are laid over white.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree.
    """
    height, width = photo.shape[:2]
    mended = mend_strokes(strokes, width, height)
    scale = min(1.0, WORKING_SIDE / max(height, width))
    colours, cut_out, fitted = over_white(photo), _cut_out(photo), mended.strokes
    if scale < 1.0:
        size = _reduced((width, height), scale)
        colours = np.asarray(cv2.resize(colours, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
        cut_out = None if cut_out is None else np.asarray(cv2.resize(cut_out, size, interpolation=cv2.INTER_AREA))
        fitted = _moved(mended.strokes, scale, np.zeros(2))
    return WorkingCopy(colours, fitted, scale, (width, height), mended.warnings, cut_out)


def _cut_out(photo: Picture) -> Opacity | None:
    """Return the opacity (h, w) of a tree that was cut out of a photo (h, w, 4); None where next to all is opaque."""
    if photo.shape[2] == 3:
        return None
    alpha = photo[..., 3]
    if np.count_nonzero(alpha < HALF) < LEAST_TRANSPARENT * alpha.size:
        return None
    return np.asarray(alpha * np.float32(1 / 255), dtype=np.float32)


def _reduced(size: tuple[int, int], scale: float) -> tuple[int, int]:
    """Return the width and height, px, of a reduced photo."""
    return max(1, round(size[0] * scale)), max(1, round(size[1] * scale))


def _moved(strokes: Strokes, scale: float, shift: Floats) -> Strokes:
    """Return strokes scaled, and then moved by a ``shift`` (2,), px."""

    def moved(strokes: tuple[Stroke, ...]) -> tuple[Stroke, ...]:
        return tuple(Stroke(s.points * scale + shift, None if s.width is None else s.width * scale) for s in strokes)

    known = strokes.scale
    length = None if known is None else Length(known.points * scale + shift, known.metres)
    return Strokes(moved((strokes.crown,))[0], moved(strokes.branches), moved(strokes.erase), length)
