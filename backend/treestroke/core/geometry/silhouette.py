"""Silhouettes of a finished tree: in its photo, and from all around."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.mesh import ALPHA_CUT, Surface
from treestroke.core.geometry.mipmaps import Cutout
from treestroke.core.geometry.raster import covered_pixels, planes, visible_triangles
from treestroke.core.types import Floats, Indices, Mask

AZIMUTHS_RAD = np.radians(np.arange(0.0, 360.0, 45.0))
"""Directions from which a tree is seen: 0 is the photo's side (+Z), a quarter turn is +X."""
HALF_AZIMUTHS_RAD = AZIMUTHS_RAD[:4]
"""Seen from behind, a silhouette is the mirror image of that from the front: four stand for eight."""
FINER = 3
"""Supersampling: samples along each side of a pixel."""
_MARGIN_PX = 2


@dataclass(frozen=True, eq=False)
class Framing:
    """Size and scale of pictures that hold a tree from any azimuth; the world's +Y axis stands in their middle.

    Attributes
    ----------
    px_per_m
        Scale, pixels per metre.
    bottom_px
        Row of the world's height 0.
    height, width
        Size, px.
    """

    px_per_m: float
    bottom_px: float
    height: int
    width: int

    def project(self, points: Floats, azimuth_rad: float) -> Floats:
        """Project world points (..., 3), metres, to pixels (..., 2) of an orthographic, level view from an azimuth."""
        across = points[..., 0] * np.cos(azimuth_rad) - points[..., 2] * np.sin(azimuth_rad)
        x, y = 0.5 * self.width + across * self.px_per_m, self.bottom_px - points[..., 1] * self.px_per_m
        return np.stack([x, y], axis=-1)

    def finer(self, factor: int) -> "Framing":
        """Return the same framing at ``factor`` times the resolution."""
        return Framing(self.px_per_m * factor, self.bottom_px * factor, self.height * factor, self.width * factor)


def framing(surfaces: Sequence[Surface], height_px: int) -> Framing:
    """Frame surfaces with at least one vertex so that they stand ``height_px`` pixels tall."""
    points = np.concatenate([surface.mesh.positions for surface in surfaces]).astype(np.float64)
    low, high = float(points[:, 1].min()), float(points[:, 1].max())
    px_per_m = height_px / max(high - low, 1e-9)
    reach = int(np.ceil(float(np.hypot(points[:, 0], points[:, 2]).max()) * px_per_m)) + _MARGIN_PX
    return Framing(px_per_m, _MARGIN_PX + high * px_per_m, height_px + 2 * _MARGIN_PX, 2 * reach)


def silhouette(bark: Surface, leaf: Surface | None, camera: Camera, height: int) -> Mask:
    """Draw the silhouette mask (height, width) in the photo's framing, scaled to ``height`` px.

    Textures with alpha are cut at `ALPHA_CUT`, as a viewer does.
    """
    scale = height / camera.height
    width = max(1, round(camera.width * scale))
    seen = np.zeros((height, width), dtype=bool)
    for surface in (bark,) if leaf is None else (bark, leaf):
        mesh = surface.mesh
        corners_px = camera.pixels_from_world(mesh.positions.astype(np.float64))[mesh.triangles] * scale
        opaque = _Opaque(surface, corners_px)
        shown = visible_triangles(corners_px, np.zeros(len(corners_px)), opaque, height, width)
        seen |= shown >= 0
    return seen


def silhouette_from(surfaces: Sequence[Surface], view: Framing, azimuth_rad: float) -> Mask:
    """Draw the antialiased silhouette mask (height, width) from an azimuth, radians.

    A pixel counts where half of its samples hit the tree. Textures with alpha are read at the mipmap level that fits
    each triangle's size on the picture, then cut at `ALPHA_CUT`.
    """
    fine = view.finer(FINER)
    seen = np.zeros((fine.height, fine.width), dtype=bool)
    for surface in surfaces:
        corners_px = fine.project(surface.mesh.positions.astype(np.float64), azimuth_rad)[surface.mesh.triangles]
        covered_pixels(corners_px, Cutout(surface, corners_px), seen)
    share = cv2.resize(seen.astype(np.float32), (view.width, view.height), interpolation=cv2.INTER_AREA)
    return np.asarray(share >= 0.5)


def silhouettes(surfaces: Sequence[Surface], view: Framing) -> Mask:
    """Draw the silhouette masks (4, height, width), px, from `HALF_AZIMUTHS_RAD` (docs/decisions/0013)."""
    return np.stack([silhouette_from(surfaces, view, azimuth) for azimuth in HALF_AZIMUTHS_RAD.tolist()])


def overlap(seen: Mask, wanted: Mask) -> float:
    """Return the intersection over union, 0 to 1, of two masks (h, w) of one shape; 1 if both are empty."""
    union = int((seen | wanted).sum())
    return float((seen & wanted).sum()) / union if union else 1.0


class _Opaque:
    """Alpha test at `ALPHA_CUT` on a texture at full size."""

    def __init__(self, surface: Surface, corners_px: Floats) -> None:
        self.texture = surface.texture
        self.coordinates = planes(corners_px, surface.mesh.uvs[surface.mesh.triangles].astype(np.float64))

    def __call__(self, triangle: Indices, x: Floats, y: Floats) -> Mask:
        """Return the mask (m,) of the points x, y, px, of triangles with index (m,) that pass."""
        height, width, channels = self.texture.shape
        if channels == 3:
            return np.ones(len(triangle), dtype=bool)
        u, v = self.coordinates.at(triangle, x, y)
        column = np.clip((u * width).astype(np.int64), 0, width - 1)
        row = np.clip((v * height).astype(np.int64), 0, height - 1)
        return np.asarray(self.texture[row, column, 3] >= 255 * ALPHA_CUT)
