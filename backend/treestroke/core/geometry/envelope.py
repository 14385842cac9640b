"""The crown turned about its own middle: how far a tree may reach in depth."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.polyline import smoothed
from treestroke.core.types import Floats

MOST_STRETCH = 4.0
"""Width over depth, or depth over width, beyond which a section is not made round."""


@dataclass(frozen=True, eq=False)
class Depth:
    """The crown as the left side shows it, for each row (height,) of the front: middle and radius, px of the front.

    The middle counts from the root's plane, Z = 0, towards the viewer.
    """

    middle_px: Floats
    radius_px: Floats


@dataclass(frozen=True, eq=False)
class Envelope:
    """A solid of level sections, one a photo row, each spanning its row of the crown.

    Sections are circles, or ellipses where a second side is known.

    Attributes
    ----------
    camera
        The photo's camera.
    middle_px
        (height,) column of each section's centre, px.
    radius_px
        (height,) radius of each section, px; 0 where the row holds no crown.
    depth
        What a second side shows; None: as deep as wide.
    """

    camera: Camera
    middle_px: Floats
    radius_px: Floats
    depth: Depth | None = None

    def reach(self, points_world: Floats) -> Floats:
        """Distance of points (n, 3), metres, from their section's centre over its radius; 1 is the surface."""
        points_px = self.camera.pixels_from_world(points_world)
        row = self._rows(points_px)
        x = points_px[:, 0] - self.middle_px[row]
        z = points_world[:, 2] / self.camera.metres_per_pixel
        if self.depth is None:
            return np.hypot(x, z) / np.maximum(self.radius_px[row], 1e-9)
        z = (z - self.depth.middle_px[row]) / np.maximum(self.depth.radius_px[row], 1e-9)
        return np.hypot(x / np.maximum(self.radius_px[row], 1e-9), z)

    def shown_from_side(self, points_world: Floats) -> NDArray[np.bool_]:
        """Tell which points (n, 3), metres, lie in the rows of the crown's left side; all without a second side."""
        if self.depth is None:
            return np.ones(len(points_world), dtype=np.bool_)
        row = self._rows(self.camera.pixels_from_world(points_world))
        away_px = points_world[:, 2] / self.camera.metres_per_pixel - self.depth.middle_px[row]
        return np.asarray(np.abs(away_px) <= self.depth.radius_px[row])

    def middles(self, points_world: Floats) -> Floats:
        """Centres (n, 3), metres, of the sections at the points' heights; at Z = 0 without a second side."""
        points_px = self.camera.pixels_from_world(points_world)
        row = self._rows(points_px)
        depth_px = np.zeros(len(row)) if self.depth is None else self.depth.middle_px[row]
        centres_px = np.stack([self.middle_px[row], points_px[:, 1]], axis=1)
        return self.camera.world_from_pixels(centres_px, depth_px * self.camera.metres_per_pixel)

    def half_depth(self, points_world: Floats) -> Floats:
        """Half the envelope's depth (n,), metres, at the points' X and Y (0 outside it)."""
        points_px = self.camera.pixels_from_world(points_world)
        row = self._rows(points_px)
        x = points_px[:, 0] - self.middle_px[row]
        half_px = np.sqrt(np.maximum(self.radius_px[row] ** 2 - x**2, 0.0))
        if self.depth is not None:
            half_px = half_px * self.depth.radius_px[row] / np.maximum(self.radius_px[row], 1e-9)
        return half_px * self.camera.metres_per_pixel

    def widened(self, factor: float) -> "Envelope":
        """Give the solid whose sections have so many times the radius."""
        depth = None if self.depth is None else replace(self.depth, radius_px=factor * self.depth.radius_px)
        return replace(self, radius_px=factor * self.radius_px, depth=depth)

    def with_side(self, mask: NDArray[np.bool_], side: Camera) -> "Envelope":
        """Take the depth from the crown's mask (h, w) on the left side, seen by a camera of that side.

        Rows above and below that crown are as deep as its top and bottom rows.
        """
        seen, scale = envelope_of_mask(mask, side), side.metres_per_pixel / self.camera.metres_per_pixel
        rows = np.flatnonzero(seen.radius_px > 0)
        y_m = (self.camera.root_px[1] - np.arange(self.camera.height) - 0.5) * self.camera.metres_per_pixel
        row = np.clip(side.root_px[1] - y_m / side.metres_per_pixel - 0.5, rows[0], rows[-1])
        middle, radius = (np.interp(row, rows, column[rows]) for column in (seen.middle_px, seen.radius_px))
        return replace(self, depth=Depth((middle - side.root_px[0]) * scale, radius * scale))

    def rounded(self, points_world: Floats) -> Floats:
        """Carry points (n, 3), metres, to where all sections are circles about Z = 0, as without a depth."""
        middle_m, ratio = self._stretch(points_world)
        return np.column_stack([points_world[:, :2], (points_world[:, 2] - middle_m) * ratio])

    def unrounded(self, points_world: Floats) -> Floats:
        """Carry points (n, 3), metres, back from where `rounded` puts them."""
        middle_m, ratio = self._stretch(points_world)
        return np.column_stack([points_world[:, :2], points_world[:, 2] / ratio + middle_m])

    def _stretch(self, points_world: Floats) -> tuple[Floats, Floats]:
        """Give the middle (n,), metres, and the width over the depth (n,) at the points' rows, within bounds."""
        if self.depth is None:
            return np.zeros(len(points_world)), np.ones(len(points_world))
        rows = np.flatnonzero(self.radius_px > 0)
        row = np.clip(self._rows(self.camera.pixels_from_world(points_world)), rows[0], rows[-1])
        ratio = self.radius_px[row] / np.maximum(self.depth.radius_px[row], 1e-9)
        return self.depth.middle_px[row] * self.camera.metres_per_pixel, np.clip(ratio, 1 / MOST_STRETCH, MOST_STRETCH)

    def _rows(self, points_px: Floats) -> NDArray[np.int64]:
        return np.clip(np.floor(points_px[:, 1]).astype(np.int64), 0, self.camera.height - 1)


def envelope_of_mask(mask: NDArray[np.bool_], camera: Camera) -> Envelope:
    """Turn a crown mask (height, width) about the middle of its rows.

    A row's span is its first to last crown pixel; spans are smoothed over 2 % of the crown's height so
    that one stray twig gives no disc. Rows above and below the crown have radius 0.

    Raises
    ------
    ValueError
        The mask is empty or not of the camera's size.
    """
    if mask.shape != (camera.height, camera.width):
        raise ValueError(f"mask {mask.shape} does not fit the camera {camera}")
    rows = np.flatnonzero(mask.any(axis=1))
    if rows.size == 0:
        raise ValueError("an empty crown has no envelope")
    top, bottom = int(rows[0]), int(rows[-1])
    left = np.interp(np.arange(top, bottom + 1), rows, mask.argmax(axis=1)[rows])
    right = np.interp(np.arange(top, bottom + 1), rows, mask.shape[1] - mask[:, ::-1].argmax(axis=1)[rows])
    sigma = 0.02 * (bottom - top + 1)
    left, right = (smoothed(side, sigma) for side in (left, right))
    middle, radius = np.zeros(camera.height), np.zeros(camera.height)
    middle[:top], middle[bottom + 1 :] = (left[0] + right[0]) / 2, (left[-1] + right[-1]) / 2
    middle[top : bottom + 1], radius[top : bottom + 1] = (left + right) / 2, (right - left) / 2
    return Envelope(camera, middle, radius)
