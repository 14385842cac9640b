"""Cameras of a capture's photos as plain values, for reports, responses and files."""

from typing import Any

from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.pipeline.grown_tree import CapturedViews


def plain_photo_camera(name: str, camera: PerspectiveCamera) -> dict[str, Any]:
    """Return the camera of the photo of a ``name`` as plain values: pose by rows, lengths in px."""
    return {
        "photo": name,
        "camera_from_world": camera.camera_from_world.tolist(),
        "focal_px": float(camera.focal_px),
        "principal_px": [float(one) for one in camera.principal_px],
        "size_px": [camera.width, camera.height],
    }


def plain_cameras(captured: CapturedViews) -> list[dict[str, Any]]:
    """Return the cameras of a capture's photos as they stand in reports and in the GLB's ``extras.cameras``."""
    return [plain_photo_camera(*pair) for pair in zip(captured.names, captured.cameras, strict=True)]
