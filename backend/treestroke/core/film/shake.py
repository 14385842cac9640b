"""The camera's own motion, seen in the background, is taken out of a tree's tracks."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from treestroke.core.film.tracks import Tracks
from treestroke.core.types import Floats

FEWEST = 12
"""Tracks of the background that must be seen in a frame for the camera's motion to be known there."""
STEADY_PX = 0.3
"""Greatest motion of the background, px of the frames, for which the camera counts as standing still."""
_REACH_PX = 1.5  # distance within which a track agrees with the motion of the others
_MOST_AGREE = 0.4  # least share of the tracks that must agree: clouds and other trees move on their own


@dataclass(frozen=True, eq=False)
class CameraMotion:
    """Where the camera looks in each frame.

    Attributes
    ----------
    to_frame
        (f, 2, 3) from px of the chosen frame to px of each frame, for what stands still.
    shift_px
        (f,) how far the picture's middle moves.
    """

    to_frame: Floats
    shift_px: Floats


def camera_motion(background: Tracks, size_px: tuple[int, int]) -> CameraMotion:
    """Find turns, shifts and zooms of the camera by tracks of the background in frames of such a size (w, h).

    Where too few tracks agree, it is taken to stand as in the frame before.
    """
    matrices = np.tile(np.eye(2, 3), (len(background.points), 1, 1))
    for index, (points, seen) in enumerate(zip(background.points, background.seen, strict=True)):
        matrix = _similarity(background.rest[seen], points[seen])
        if matrix is not None:
            matrices[index] = matrix
        elif index:
            matrices[index] = matrices[index - 1]
    middle = np.array([*size_px, 2.0]) / 2.0
    shift = np.linalg.norm(matrices @ middle - middle[:2], axis=1)
    if shift.max(initial=0.0) < STEADY_PX:
        matrices[:] = np.eye(2, 3)
    return CameraMotion(matrices, shift)


def without_camera(tracks: Tracks, motion: CameraMotion) -> Tracks:
    """Return tracks as a camera would see them that stands as it stood in the chosen frame."""
    linear, shift = motion.to_frame[:, :, :2], motion.to_frame[:, :, 2]
    return replace(tracks, points=np.einsum("fij,fkj->fki", np.linalg.inv(linear), tracks.points - shift[:, None]))


def _similarity(rest: Floats, points: Floats) -> Floats | None:
    """Return the similarity (2, 3) that most points follow; None where too few do."""
    if len(rest) < FEWEST:
        return None
    matrix, agree = cv2.estimateAffinePartial2D(rest, points, method=cv2.RANSAC, ransacReprojThreshold=_REACH_PX)
    if matrix is None or agree.mean() < _MOST_AGREE:
        return None
    return np.asarray(matrix, dtype=np.float64)
