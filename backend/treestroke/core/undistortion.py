"""Photos, and points drawn on them, without the distortion of their lens."""

import cv2
import numpy as np

from treestroke.core.capture import Shot, SolvedPhoto
from treestroke.core.types import Floats, Picture


def undistorted(picture: Picture, photo: SolvedPhoto) -> Shot:
    """Return a captured picture (h, w, 3) without lens distortion.

    The shot shows what the photo shows but for its rim: where the photo does not reach, its edge is repeated.
    """
    camera = photo.camera
    if picture.shape != (camera.height, camera.width, 3):
        raise ValueError(f"{photo.name}: the picture {picture.shape} does not fit its camera {camera}")
    if photo.radial:
        # OpenCV's pixels have their middles at whole numbers.
        matrix = _matrix(camera.focal_px, (camera.principal_px[0] - 0.5, camera.principal_px[1] - 0.5))
        distortion = np.array([photo.radial, 0.0, 0.0, 0.0])
        size = camera.width, camera.height
        maps = cv2.initUndistortRectifyMap(matrix, distortion, np.eye(3), matrix, size, cv2.CV_32FC1)
        picture = np.asarray(
            cv2.remap(picture, *maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), dtype=np.uint8
        )
    return Shot(photo.name, picture, camera)


def undistorted_points(points_px: Floats, photo: SolvedPhoto) -> Floats:
    """Carry points (n, 2), px, drawn on a captured picture to where its undistorted shot shows the same, px."""
    if not len(points_px):
        return np.zeros((0, 2))
    camera = photo.camera
    on_plane = cv2.undistortPoints(
        np.asarray(points_px, np.float64)[:, None],
        _matrix(camera.focal_px, camera.principal_px),
        np.array([photo.radial, 0.0, 0.0, 0.0]),
        criteria=(cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-9),
    )[:, 0]
    return np.asarray(on_plane * camera.focal_px + np.array(camera.principal_px))


def distorted_points(points_px: Floats, photo: SolvedPhoto) -> Floats:
    """Carry points (n, 2), px, of an undistorted shot to where the captured picture shows the same, px."""
    camera = photo.camera
    on_plane = (points_px - np.array(camera.principal_px)) / camera.focal_px
    bent = on_plane * (1 + photo.radial * (on_plane**2).sum(axis=1, keepdims=True))
    return np.asarray(bent * camera.focal_px + np.array(camera.principal_px))


def _matrix(focal_px: float, principal_px: tuple[float, float]) -> Floats:
    """Return OpenCV's camera matrix (3, 3)."""
    x, y = principal_px
    return np.array([[focal_px, 0.0, x], [0.0, focal_px, y], [0.0, 0.0, 1.0]])
