"""Cameras: the only places where pixels become metres and metres pixels.

The world is right-handed, +Y up, metres. Pixels are continuous, x right and y down; (0, 0) is the outer corner of the
top-left one. Depth is measured along the viewing direction, metres, and grows away from the viewer.
"""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from treestroke.core.geometry.vectors import unit
from treestroke.core.types import Floats, Mask

_OUTSIDE_PX = -1.0
"""Coordinate of points behind a perspective camera: outside of every picture."""


class Camera(Protocol):
    """Converts between a picture and the world."""

    @property
    def width(self) -> int:
        """Width of the picture, px."""

    @property
    def height(self) -> int:
        """Height of the picture, px."""

    def pixels_from_world(self, points_world: Floats) -> Floats:
        """Project world points (n, 3), metres, to picture points (n, 2), px."""

    def world_from_pixels(self, points_px: Floats, depth_m: Floats | float = 0.0) -> Floats:
        """Place picture points (n, 2), px, in the world (n, 3), metres, at depths (n,), metres."""

    def depth(self, points_world: Floats) -> Floats:
        """Measure the depth (n,), metres, of world points (n, 3), metres."""

    def toward_viewer(self, points_world: Floats) -> Floats:
        """Return unit directions (n, 3) from world points (n, 3), metres, to the viewer."""

    def right(self) -> Floats:
        """Return the unit world direction (3,) that points to the right in the picture."""

    def pixel_size(self, points_world: Floats) -> Floats:
        """Measure the metres (n,) that a pixel covers at world points (n, 3), metres."""

    def cropped(self, corner_px: tuple[float, float], size: tuple[int, int]) -> "Camera":
        """Return the camera of a part of the picture: its top-left corner (x, y) and its size (width, height), px."""


def in_picture(camera: Camera, points_world: Floats) -> Mask:
    """Tell which world points (n, 3), metres, fall into the camera's picture: flags (n,)."""
    x, y = camera.pixels_from_world(points_world).T
    return np.asarray((x >= 0) & (x < camera.width) & (y >= 0) & (y < camera.height))


@dataclass(frozen=True)
class OrthographicCamera:
    """Camera of parallel rays, level, tied to the tree's root; a photo of one tree is taken for its picture.

    From the front it looks along -Z: a world point (X, Y, Z) stands at pixel (root_x + X / s, root_y - Y / s), and its
    depth is -Z. From the left it looks along +X: the pixel is (root_x + Z / s, root_y - Y / s), the depth X.

    Attributes
    ----------
    width, height
        Size of the picture, px.
    metres_per_pixel
        The scale s.
    root_px
        (x, y) of the tree's root, the world's origin, px.
    from_left
        Whether it shows the left side, else the front.
    """

    width: int
    height: int
    metres_per_pixel: float
    root_px: tuple[float, float]
    from_left: bool = False

    def __post_init__(self) -> None:
        if self.width < 1 or self.height < 1 or not self.metres_per_pixel > 0:
            raise ValueError(f"a camera needs a size and a positive scale, got {self}")

    def enlarged(self, reduction: float, size: tuple[int, int]) -> "OrthographicCamera":
        """Return the camera of the same picture at its own ``size``, (width, height), px.

        ``reduction`` is how many pixels of this picture stand for one of that.
        """
        root_px = self.root_px[0] / reduction, self.root_px[1] / reduction
        return OrthographicCamera(*size, self.metres_per_pixel * reduction, root_px, self.from_left)

    def to_the_left(self, reach_px: float) -> "OrthographicCamera":
        """Return the camera of the left side at the front's scale and rows, ``reach_px`` to both sides of the root."""
        return replace(self, width=int(np.ceil(2 * reach_px)), root_px=(reach_px, self.root_px[1]), from_left=True)

    def pixels_from_world(self, points_world: Floats) -> Floats:
        """Project world points (n, 3), metres, to picture points (n, 2), px."""
        x = self.root_px[0] + points_world[:, 2 if self.from_left else 0] / self.metres_per_pixel
        return np.stack([x, self.rows_from_heights(points_world[:, 1])]).T

    def world_from_pixels(self, points_px: Floats, depth_m: Floats | float = 0.0) -> Floats:
        """Place picture points (n, 2), px, in the world (n, 3), metres, at depths (n,) from the root's, metres."""
        across = (points_px[:, 0] - self.root_px[0]) * self.metres_per_pixel
        up, depth = self.heights_from_rows(points_px[:, 1]), np.broadcast_to(depth_m, across.shape)
        return np.stack([depth, up, across] if self.from_left else [across, up, 0.0 - depth], axis=1)

    def picture_space_from_world(self, points_world: Floats) -> Floats:
        """Carry world points (n, 3), metres, into picture space (n, 3), px: z is how far before the root they are."""
        near = self.pixels_from_metres(-self.depth(points_world))
        return np.column_stack([self.pixels_from_world(points_world), near])

    def world_from_picture_space(self, points_px: Floats) -> Floats:
        """Carry points (n, 3) of picture space, px, into the world: (n, 3), metres."""
        return self.world_from_pixels(points_px[:, :2], -self.metres_from_pixels(points_px[:, 2]))

    def depth(self, points_world: Floats) -> Floats:
        """Measure the depth (n,), metres, of world points (n, 3), metres; 0 at the root."""
        return np.asarray(points_world[:, 0] if self.from_left else 0.0 - points_world[:, 2])

    def toward_viewer(self, points_world: Floats) -> Floats:
        """Return unit directions (n, 3) from world points (n, 3), metres, to the viewer; all the same."""
        direction = np.array([-1.0, 0.0, 0.0] if self.from_left else [0.0, 0.0, 1.0])
        return np.broadcast_to(direction, points_world.shape)

    def right(self) -> Floats:
        """Return the unit world direction (3,) that points to the right in the picture."""
        return np.array([0.0, 0.0, 1.0] if self.from_left else [1.0, 0.0, 0.0])

    def pixel_size(self, points_world: Floats) -> Floats:
        """Measure the metres (n,) that a pixel covers at world points (n, 3), metres; the same everywhere."""
        return np.full(len(points_world), self.metres_per_pixel)

    def cropped(self, corner_px: tuple[float, float], size: tuple[int, int]) -> "OrthographicCamera":
        """Return the camera of a part of the picture: its top-left corner (x, y) and its size (width, height), px."""
        root_px = self.root_px[0] - corner_px[0], self.root_px[1] - corner_px[1]
        return replace(self, width=size[0], height=size[1], root_px=root_px)

    def row_heights(self) -> Floats:
        """Return the heights (h,), metres above the root, of the middles of the picture's rows."""
        return self.heights_from_rows(np.arange(self.height, dtype=np.float64) + 0.5)

    def heights_from_rows(self, rows_px: Floats) -> Floats:
        """Convert picture rows (n,), px, to heights (n,), metres above the root."""
        return np.asarray((self.root_px[1] - rows_px) * self.metres_per_pixel)

    def rows_from_heights(self, heights_m: Floats) -> Floats:
        """Convert heights (n,), metres above the root, to picture rows (n,), px."""
        return np.asarray(self.root_px[1] - heights_m / self.metres_per_pixel)

    def metres_from_pixels(self, lengths_px: Floats | float) -> Floats:
        """Convert lengths in the picture, px, one or (n,), to metres."""
        return np.asarray(lengths_px * self.metres_per_pixel)

    def pixels_from_metres(self, lengths_m: Floats | float) -> Floats:
        """Convert lengths, metres, one or (n,), to lengths in the picture, px."""
        return np.asarray(lengths_m / self.metres_per_pixel)


@dataclass(frozen=True, eq=False)
class PerspectiveCamera:
    """Pinhole camera: x right, y down, z forward in its own frame.

    Source: Hartley and Zisserman 2004, "Multiple View Geometry in Computer Vision", section 6.1.

    Attributes
    ----------
    width, height
        Size of the picture, px.
    camera_from_world
        (3, 4) rotation and translation, metres.
    focal_px
        Focal length, px.
    principal_px
        (x, y) of the principal point, px.
    """

    width: int
    height: int
    camera_from_world: Floats
    focal_px: float
    principal_px: tuple[float, float]

    def __post_init__(self) -> None:
        turn = self.camera_from_world[:, :3] if self.camera_from_world.shape == (3, 4) else np.zeros((3, 3))
        if not np.allclose(turn @ turn.T, np.eye(3), atol=1e-6) or np.linalg.det(turn) < 0:
            raise ValueError(
                f"camera_from_world must be (3, 4) and begin with a rotation, got {self.camera_from_world}"
            )
        if self.width < 1 or self.height < 1 or not self.focal_px > 0:
            raise ValueError(f"a camera needs a size and a positive focal length, got {self}")

    @property
    def centre(self) -> Floats:
        """Where the camera stands: world point (3,), metres."""
        return np.asarray(-self.camera_from_world[:, :3].T @ self.camera_from_world[:, 3])

    @property
    def ahead(self) -> Floats:
        """Unit world direction (3,) in which it looks."""
        return np.asarray(self.camera_from_world[2, :3])

    def pixels_from_world(self, points_world: Floats) -> Floats:
        """Project world points (n, 3), metres, to picture points (n, 2), px; (-1, -1) for points behind the camera."""
        # Row by row of (3, n): numpy is slow along short rows.
        right, down, depth = self.camera_from_world[:, :3] @ points_world.T + self.camera_from_world[:, 3:]
        ahead = depth > 0
        per_metre = self.focal_px / np.where(ahead, depth, 1.0)
        found = np.empty((len(points_world), 2))
        for column, offset, middle in ((0, right, self.principal_px[0]), (1, down, self.principal_px[1])):
            found[:, column] = np.where(ahead, offset * per_metre + middle, _OUTSIDE_PX)
        return found

    def world_from_pixels(self, points_px: Floats, depth_m: Floats | float = 0.0) -> Floats:
        """Place picture points (n, 2), px, in the world (n, 3), metres, at depths (n,) from the camera, metres."""
        depth = np.broadcast_to(depth_m, (len(points_px),))[:, None]
        on_plane = (points_px - np.array(self.principal_px)) / self.focal_px
        points = np.concatenate([on_plane * depth, depth], axis=1) - self.camera_from_world[:, 3]
        return np.asarray(points @ self.camera_from_world[:, :3])

    def depth(self, points_world: Floats) -> Floats:
        """Measure the depth (n,), metres, of world points (n, 3), metres, along the optical axis; 0 at the camera."""
        return np.asarray(points_world @ self.camera_from_world[2, :3] + self.camera_from_world[2, 3])

    def toward_viewer(self, points_world: Floats) -> Floats:
        """Return unit directions (n, 3) from world points (n, 3), metres, to the camera's centre."""
        return unit(self.centre - points_world)

    def right(self) -> Floats:
        """Return the unit world direction (3,) that points to the right in the picture."""
        return np.asarray(self.camera_from_world[0, :3])

    def pixel_size(self, points_world: Floats) -> Floats:
        """Measure the metres (n,) that a pixel covers at world points (n, 3), metres, square to the optical axis."""
        return np.asarray(np.maximum(self.depth(points_world), 0.0) / self.focal_px)

    def cropped(self, corner_px: tuple[float, float], size: tuple[int, int]) -> "PerspectiveCamera":
        """Return the camera of a part of the picture: its top-left corner (x, y) and its size (width, height), px."""
        principal_px = self.principal_px[0] - corner_px[0], self.principal_px[1] - corner_px[1]
        return replace(self, width=size[0], height=size[1], principal_px=principal_px)

    def resized(self, width: int, height: int) -> "PerspectiveCamera":
        """Return the camera of the same picture at another size, px; its sides keep their ratio but for rounding."""
        scale = width / self.width
        principal_px = self.principal_px[0] * scale, self.principal_px[1] * height / self.height
        return replace(self, width=width, height=height, focal_px=self.focal_px * scale, principal_px=principal_px)
