"""The working copy of a photo and its strokes, and its camera."""

from dataclasses import dataclass

import cv2
import numpy as np

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.stroke_rules import mend_strokes
from treestroke.core.strokes import Length, Stroke, Strokes, StrokeWarning
from treestroke.core.types import Mask, Picture

WORKING_SIDE = 1600
"""Long side, px, to which a larger photo is reduced: the paper's constants are for about 1500."""


@dataclass(frozen=True, eq=False)
class WorkingCopy:
    """The working copy of a photo: reduced by ``scale`` (1 or less), with mended strokes to match.

    ``size`` is the photo's own width and height, px.
    """

    photo: Picture
    strokes: Strokes
    scale: float
    size: tuple[int, int]
    warnings: tuple[StrokeWarning, ...]

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
        return camera.enlarged(self.scale, self.size)


def working_copy(photo: Picture, strokes: Strokes) -> WorkingCopy:
    """Mend the strokes (px) and reduce a large photo (h, w, 3), sRGB, to `WORKING_SIDE` px, with its strokes.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree.
    """
    height, width = photo.shape[:2]
    mended = mend_strokes(strokes, width, height)
    scale = min(1.0, WORKING_SIDE / max(height, width))
    if scale == 1.0:
        return WorkingCopy(photo, mended.strokes, 1.0, (width, height), mended.warnings)
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    small = np.asarray(cv2.resize(photo, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)

    def reduced(strokes: tuple[Stroke, ...]) -> tuple[Stroke, ...]:
        return tuple(Stroke(s.points * scale, None if s.width is None else s.width * scale) for s in strokes)

    full = mended.strokes
    known = None if full.scale is None else Length(full.scale.points * scale, full.scale.metres)
    fitted = Strokes(reduced((full.crown,))[0], reduced(full.branches), reduced(full.erase), known)
    return WorkingCopy(small, fitted, scale, (width, height), mended.warnings)
