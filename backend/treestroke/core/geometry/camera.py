"""The orthographic camera that took the photo."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.types import Floats


@dataclass(frozen=True)
class Camera:
    """Orthographic view along -Z, tied to the tree's root.

    A world point (X, Y, Z), in metres, right-handed, +Y up, +Z towards the viewer, stands at pixel
    (root_x + X / s, root_y - Y / s); pixels are continuous, (0, 0) the outer corner of the top-left one.

    Attributes
    ----------
    width, height
        Size of the photo, px.
    metres_per_pixel
        The scale s, metres per photo pixel.
    root_px
        The root's (x, y), px; the world's origin.
    """

    width: int
    height: int
    metres_per_pixel: float
    root_px: tuple[float, float]

    def __post_init__(self) -> None:
        if self.width < 1 or self.height < 1 or not self.metres_per_pixel > 0:
            raise ValueError(f"a camera needs a size and a positive scale, got {self}")

    def pixels_from_world(self, points_world: Floats) -> Floats:
        """Project world points (n, 3), metres, to photo points (n, 2), px."""
        root_x, root_y = self.root_px
        x = root_x + points_world[:, 0] / self.metres_per_pixel
        y = root_y - points_world[:, 1] / self.metres_per_pixel
        return np.stack([x, y], axis=1)

    def world_from_pixels(self, points_px: Floats, depth_m: Floats | float = 0.0) -> Floats:
        """Place photo points (n, 2), px, in the world (n, 3) at the given depth Z, metres."""
        root_x, root_y = self.root_px
        x = (points_px[:, 0] - root_x) * self.metres_per_pixel
        y = (root_y - points_px[:, 1]) * self.metres_per_pixel
        return np.stack([x, y, np.broadcast_to(depth_m, x.shape)], axis=1)
