"""What a finished tree hides of its photo."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.mesh import ALPHA_CUT, Surface
from treestroke.core.geometry.raster import Floats, Indices, planes, visible_triangles


def silhouette(bark: Surface, leaf: Surface | None, camera: Camera, height: int) -> NDArray[np.bool_]:
    """Draw the front view's silhouette at the photo's framing, ``height`` px tall: (height, width).

    Textures with alpha are cut at `ALPHA_CUT`, as a viewer does.
    """
    scale = height / camera.height
    width = max(1, round(camera.width * scale))
    seen = np.zeros((height, width), dtype=bool)
    for surface in (bark,) if leaf is None else (bark, leaf):
        mesh = surface.mesh
        corners_px = camera.pixels_from_world(mesh.positions.astype(np.float64))[mesh.triangles] * scale
        there = _Opaque(surface, corners_px)
        shown = visible_triangles(corners_px, np.zeros(len(corners_px)), there, height, width)
        seen |= shown >= 0
    return seen


def likeness(seen: NDArray[np.bool_], wanted: NDArray[np.bool_]) -> float:
    """Intersection over union of two masks of one shape; 1 where both are empty."""
    union = int((seen | wanted).sum())
    return float((seen & wanted).sum()) / union if union else 1.0


class _Opaque:
    """Tells where a textured triangle is not cut away."""

    def __init__(self, surface: Surface, corners_px: Floats) -> None:
        self.texture = surface.texture
        self.coordinates = planes(corners_px, surface.mesh.uvs[surface.mesh.triangles].astype(np.float64))

    def __call__(self, triangle: Indices, x: Floats, y: Floats) -> NDArray[np.bool_]:
        """Tell which points (m,), px, of the triangles named are there."""
        height, width, channels = self.texture.shape
        if channels == 3:
            return np.ones(len(triangle), dtype=bool)
        u, v = self.coordinates.at(triangle, x, y)
        column = np.clip((u * width).astype(np.int64), 0, width - 1)
        row = np.clip((v * height).astype(np.int64), 0, height - 1)
        return np.asarray(self.texture[row, column, 3] >= 255 * ALPHA_CUT)
