"""The tree's own frame in a capture: the root on the ground is the origin, Y is up, +Z looks at the first camera."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from treestroke.core.capture import PointCloud, Shot
from treestroke.core.errors import StrokesError
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.geometry.similarity import Similarity
from treestroke.core.geometry.vectors import unit
from treestroke.core.strokes import CameraDistance, CaptureStrokes, Length
from treestroke.core.types import Floats

GROUND_REACH = 0.15
"""Ground within this share of the root's distance from the camera tells how high the ground is at the root."""
GROUND_RANK = 0.3
"""Rank, 0 to 1, among the heights of points near the root that is the ground's: stones, tufts and trunk lie above."""
ROUNDS = 6
"""Times that the ground's height is looked up where the ray meets it."""
FEWEST = 8
"""Points near the root below which the nearest ones in the picture tell its depth."""


def tree_frame(
    cameras: Mapping[str, PerspectiveCamera], cloud: PointCloud, drawn: CaptureStrokes, height_m: float
) -> Similarity:
    """Return the change from a structure's frame to the tree's, in metres.

    Strokes are in px of the cameras' pictures, by the photos' names. The root is where the ray through the first trunk
    point meets the ground; the crown stroke's top, as far away as the root, is ``height_m`` above it, unless the
    strokes hold a scale.

    Raises
    ------
    StrokesError
        The strokes lie on a photo that is not used, or there is no trunk stroke.
    """
    strokes, camera = drawn.by_photo[drawn.first], _camera(cameras, drawn.first, ("views",))
    root = _on_ground(camera, strokes.branches[0].points[0], cloud)
    turn = _facing(camera.centre - root)
    metres = _metres_per_unit(cameras, drawn, root)
    if metres is None:
        top = strokes.crown.points[strokes.crown.points[:, 1].argmin()]
        metres = height_m / max(height_above(camera, root, top), 1e-9)
    return Similarity(root, turn, metres)


def in_frame(shot: Shot, frame: Similarity) -> Shot:
    """Return the shot with its camera carried into another frame."""
    return replace(shot, camera=frame.camera(shot.camera))


def cloud_in_frame(cloud: PointCloud, frame: Similarity) -> PointCloud:
    """Return the points carried into another frame."""
    return replace(cloud, points=frame.points(cloud.points))


def _camera(cameras: Mapping[str, PerspectiveCamera], name: str, place: tuple[str | int, ...]) -> PerspectiveCamera:
    """Return a photo's camera.

    Raises
    ------
    StrokesError
        The photo has none.
    """
    if name not in cameras:
        fault = f"no camera was found for {name}; draw on a photo that is used: {', '.join(sorted(cameras)[:5])}"
        raise StrokesError.at(place, fault, "photo_not_used")
    return cameras[name]


def _facing(toward: Floats) -> Floats:
    """Return the turn (3, 3) about Y after which a level direction near ``toward`` (3,) is +Z."""
    ahead = unit(np.array([toward[0], 0.0, toward[2]]))
    return np.stack([np.cross([0.0, 1.0, 0.0], ahead), [0.0, 1.0, 0.0], ahead])


def _on_ground(camera: PerspectiveCamera, root_px: Floats, cloud: PointCloud) -> Floats:
    """Return the point (3,) of the ground that a camera shows at ``root_px`` (2,)."""
    ray = camera.world_from_pixels(root_px[None], 1.0)[0] - camera.centre
    away = np.linalg.norm(camera.pixels_from_world(cloud.points) - root_px, axis=1)
    depth = camera.depth(cloud.points)
    near = np.argsort(np.where(depth > 0, away, np.inf), kind="stable")[:FEWEST]
    found = camera.centre + float(np.median(depth[near])) * ray
    for _ in range(ROUNDS if ray[1] < 0 else 0):
        reach = GROUND_REACH * float(np.linalg.norm(found - camera.centre))
        around = np.hypot(*(cloud.points - found)[:, [0, 2]].T) <= reach
        below = around & (cloud.points[:, 1] < camera.centre[1])
        if np.count_nonzero(below) < FEWEST:
            break
        level = float(np.quantile(cloud.points[below, 1], GROUND_RANK))
        found = camera.centre + (level - camera.centre[1]) / ray[1] * ray
    return np.asarray(found)


def height_above(camera: PerspectiveCamera, root: Floats, top_px: Floats) -> float:
    """Height of a picture point above the root, in the upright plane through the root that faces the camera."""
    ray = camera.world_from_pixels(top_px[None], 1.0)[0] - camera.centre
    ahead = unit((root - camera.centre) * [1.0, 0.0, 1.0])
    return float(camera.centre[1] + (root - camera.centre) @ ahead / max(ray @ ahead, 1e-9) * ray[1] - root[1])


def _metres_per_unit(cameras: Mapping[str, PerspectiveCamera], drawn: CaptureStrokes, root: Floats) -> float | None:
    """Return the metres of a structure's unit by the strokes' scale; None without one."""
    if drawn.scale is None:
        return None
    if isinstance(drawn.scale, CameraDistance):
        first, second = (_camera(cameras, name, ("scale", "photos")).centre for name in drawn.scale.photos)
        apart = float(np.linalg.norm(first - second))
        if not apart > 0:
            raise StrokesError.at(("scale",), "both photos are the same; name two photos", "scale_invalid")
        return drawn.scale.metres / apart
    camera = _camera(cameras, drawn.scale.photo, ("scale", "photo"))
    return _metres_by_line(camera, drawn.scale.length, root)


def _metres_by_line(camera: PerspectiveCamera, line: Length, root: Floats) -> float:
    """Metres of a unit by a drawn line as far away as the root."""
    ends = camera.world_from_pixels(line.points, float(camera.depth(root[None])[0]))
    return line.metres / max(float(np.linalg.norm(ends[1] - ends[0])), 1e-9)
