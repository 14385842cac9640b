"""Photos, and points drawn on them, without the distortion of their lens."""

from dataclasses import replace

import cv2
import numpy as np

from treestroke.core.capture import Shot, SolvedPhoto
from treestroke.core.types import Floats, Picture


def undistorted(picture: Picture, photo: SolvedPhoto, longest_side: int) -> Shot:
    """Return an upright photo (h, w, 3) without lens distortion, made smaller to at most ``longest_side`` px.

    The shot shows what the photo shows but for its rim: where the photo does not reach, its edge is repeated.
    """
    camera = photo.camera
    if picture.shape != (camera.height, camera.width, 3):
        raise ValueError(f"{photo.name}: the picture {picture.shape} does not fit its camera {camera}")
    scale = min(longest_side / max(camera.width, camera.height), 1.0)
    width, height = max(round(camera.width * scale), 1), max(round(camera.height * scale), 1)
    principal = camera.principal_px[0] * width / camera.width, camera.principal_px[1] * height / camera.height
    new = replace(
        camera, width=width, height=height, focal_px=camera.focal_px * width / camera.width, principal_px=principal
    )
    small = cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA) if scale < 1 else picture
    if photo.radial:
        # OpenCV's pixels have their middles at whole numbers.
        matrix = _matrix(new.focal_px, (principal[0] - 0.5, principal[1] - 0.5))
        distortion = np.array([photo.radial, 0.0, 0.0, 0.0])
        maps = cv2.initUndistortRectifyMap(matrix, distortion, np.eye(3), matrix, (width, height), cv2.CV_32FC1)
        small = cv2.remap(small, maps[0], maps[1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return Shot(photo.name, np.asarray(small, np.uint8), new)


def undistorted_points(points_px: Floats, photo: SolvedPhoto, shot: Shot) -> Floats:
    """Carry points (n, 2) drawn on an upright photo, its px, to where its undistorted shot shows the same, px."""
    if not len(points_px):
        return np.zeros((0, 2))
    camera = photo.camera
    on_plane = cv2.undistortPoints(
        np.asarray(points_px, np.float64)[:, None],
        _matrix(camera.focal_px, camera.principal_px),
        np.array([photo.radial, 0.0, 0.0, 0.0]),
        criteria=(cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-9),
    )[:, 0]
    return np.asarray(on_plane * shot.camera.focal_px + np.array(shot.camera.principal_px))


def _matrix(focal_px: float, principal_px: tuple[float, float]) -> Floats:
    """Return OpenCV's camera matrix (3, 3)."""
    x, y = principal_px
    return np.array([[focal_px, 0.0, x], [0.0, focal_px, y], [0.0, 0.0, 1.0]])
