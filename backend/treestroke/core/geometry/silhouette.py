"""What a finished tree hides of its background: in its photo, and from all around."""

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
"""From where a tree is looked at: 0 is the photo's side (+Z), a quarter turn +X."""
HALF_AZIMUTHS_RAD = AZIMUTHS_RAD[:4]
"""Seen from behind, a silhouette is the mirror image of that from the front: four stand for eight."""
FINER = 3
"""Samples a side of a pixel."""
_MARGIN_PX = 2


@dataclass(frozen=True, eq=False)
class Framing:
    """Pictures of one size and scale that hold a tree from any azimuth; the world's axis +Y stands in their middle.

    Attributes
    ----------
    px_per_m
        Scale.
    bottom_px
        Row of the height 0.
    height, width
        Size, px.
    """

    px_per_m: float
    bottom_px: float
    height: int
    width: int

    def project(self, points: Floats, azimuth_rad: float) -> Floats:
        """Give pixels (..., 2) of world points (..., 3), seen level and orthographic from the azimuth."""
        across = points[..., 0] * np.cos(azimuth_rad) - points[..., 2] * np.sin(azimuth_rad)
        x, y = 0.5 * self.width + across * self.px_per_m, self.bottom_px - points[..., 1] * self.px_per_m
        return np.stack([x, y], axis=-1)

    def finer(self, factor: int) -> "Framing":
        """Frame the same with ``factor`` pixels a side for each."""
        return Framing(self.px_per_m * factor, self.bottom_px * factor, self.height * factor, self.width * factor)


def framing(surfaces: Sequence[Surface], height_px: int) -> Framing:
    """Frame surfaces (one vertex at least) so that they stand ``height_px`` tall."""
    points = np.concatenate([surface.mesh.positions for surface in surfaces]).astype(np.float64)
    low, high = float(points[:, 1].min()), float(points[:, 1].max())
    px_per_m = height_px / max(high - low, 1e-9)
    reach = int(np.ceil(float(np.hypot(points[:, 0], points[:, 2]).max()) * px_per_m)) + _MARGIN_PX
    return Framing(px_per_m, _MARGIN_PX + high * px_per_m, height_px + 2 * _MARGIN_PX, 2 * reach)


def silhouette(bark: Surface, leaf: Surface | None, camera: Camera, height: int) -> Mask:
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


def silhouette_from(surfaces: Sequence[Surface], view: Framing, azimuth_rad: float) -> Mask:
    """Draw the silhouette from an azimuth as a viewer that smooths edges shows it: (height, width).

    A pixel counts where half of its samples hit something. Textures with alpha are averaged to the size at which
    each triangle shows them, then cut at `ALPHA_CUT`.
    """
    fine = view.finer(FINER)
    seen = np.zeros((fine.height, fine.width), dtype=bool)
    for surface in surfaces:
        corners_px = fine.project(surface.mesh.positions.astype(np.float64), azimuth_rad)[surface.mesh.triangles]
        covered_pixels(corners_px, Cutout(surface, corners_px), seen)
    share = cv2.resize(seen.astype(np.float32), (view.width, view.height), interpolation=cv2.INTER_AREA)
    return np.asarray(share >= 0.5)


def silhouettes(surfaces: Sequence[Surface], view: Framing) -> Mask:
    """Draw the silhouettes (4, height, width) from `HALF_AZIMUTHS_RAD`."""
    return np.stack([silhouette_from(surfaces, view, azimuth) for azimuth in HALF_AZIMUTHS_RAD.tolist()])


def likeness(seen: Mask, wanted: Mask) -> float:
    """Intersection over union of two masks of one shape; 1 where both are empty."""
    union = int((seen | wanted).sum())
    return float((seen & wanted).sum()) / union if union else 1.0


class _Opaque:
    """Tells where a textured triangle is not cut away."""

    def __init__(self, surface: Surface, corners_px: Floats) -> None:
        self.texture = surface.texture
        self.coordinates = planes(corners_px, surface.mesh.uvs[surface.mesh.triangles].astype(np.float64))

    def __call__(self, triangle: Indices, x: Floats, y: Floats) -> Mask:
        """Tell which points (m,), px, of the triangles named are there."""
        height, width, channels = self.texture.shape
        if channels == 3:
            return np.ones(len(triangle), dtype=bool)
        u, v = self.coordinates.at(triangle, x, y)
        column = np.clip((u * width).astype(np.int64), 0, width - 1)
        row = np.clip((v * height).astype(np.int64), 0, height - 1)
        return np.asarray(self.texture[row, column, 3] >= 255 * ALPHA_CUT)
