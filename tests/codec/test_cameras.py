"""Cameras of a capture's photos as plain values."""

import numpy as np

from treestroke.codec.cameras import plain_cameras
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.pipeline.grown_tree import CapturedViews

POSE = np.array([[1.0, 0.0, 0.0, 0.5], [0.0, -1.0, 0.0, 1.5], [0.0, 0.0, -1.0, 9.0]])


def test_each_photo_has_its_camera_by_rows() -> None:
    camera = PerspectiveCamera(640, 480, POSE, 500.0, (320.0, 240.0))
    (row,) = plain_cameras(CapturedViews(("IMG_03.jpg",), (camera,), ()))
    assert row == {
        "photo": "IMG_03.jpg",
        "camera_from_world": POSE.tolist(),
        "focal_px": 500.0,
        "principal_px": [320.0, 240.0],
        "size_px": [640, 480],
    }
