"""Maps from one picture to another by planes of space: what a plane through the scene would look like from elsewhere.

Source: Hartley and Zisserman 2004, "Multiple View Geometry in Computer Vision", section 13.1.
"""

import numpy as np

from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.types import Floats


def plane_map(camera: PerspectiveCamera, other: PerspectiveCamera, normal: Floats, distance_m: float) -> Floats:
    """Return the matrix (3, 3) that carries array columns and rows of one picture to another's, for points of a plane.

    The plane has the unit ``normal`` (3,), world, and lies so far from the camera along it; infinity is allowed. The
    coordinates are whole in pixels' middles, as OpenCV's.
    """
    turn = other.camera_from_world[:, :3] @ camera.camera_from_world[:, :3].T
    shift = other.camera_from_world[:, 3] - turn @ camera.camera_from_world[:, 3]
    through = turn + np.outer(shift, camera.camera_from_world[:, :3] @ normal) / distance_m
    return np.asarray(_from_rays(other) @ through @ np.linalg.inv(_from_rays(camera)))


def parallax_px(camera: PerspectiveCamera, other: PerspectiveCamera, depth_m: float) -> float:
    """Return how far, px, a point so deep is shifted between two pictures that look alike, against a far one."""
    return float(camera.focal_px * np.linalg.norm(other.centre - camera.centre) / depth_m)


def _from_rays(camera: PerspectiveCamera) -> Floats:
    """Matrix (3, 3) from rays in the camera's frame to array columns and rows."""
    x, y = camera.principal_px
    return np.array([[camera.focal_px, 0.0, x - 0.5], [0.0, camera.focal_px, y - 0.5], [0.0, 0.0, 1.0]])
