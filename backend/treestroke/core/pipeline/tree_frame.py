"""The tree's own frame in a capture: the root on the ground is the origin, Y is up, +Z looks at the first camera."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from treestroke.core.capture import PointCloud, Shot
from treestroke.core.errors import StrokesError
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.geometry.polyline import arc_lengths, place_at
from treestroke.core.geometry.similarity import Similarity
from treestroke.core.geometry.vectors import unit
from treestroke.core.strokes import CameraDistance, CaptureStrokes, Length
from treestroke.core.types import Floats, Mask

BESIDE_TRUNK = 0.008
"""Distance from the trunk's stroke, as a share of the picture's height, within which points that the shot sees are the
trunk's: it hides what is behind."""
LOWER_TRUNK = 0.6
"""Share of the trunk's stroke, from the root, that is looked at: further up there are leaves."""
AROUND_TRUNK, LOW, HIGH = 0.07, 0.02, 0.15
"""Distance from the trunk, and least and greatest height above the root, as shares of the tree's height, of points that
its axis is fitted to."""
USUAL_RADIUS, OFF_BARK = 0.02, 0.01
"""Radius of a trunk before it is fitted, and greatest distance from its bark, as shares of the tree's height."""
LARGEST_RADIUS = 0.06
"""Greatest radius of a trunk that is believed."""
ROUNDS = 8
"""Times that the trunk's axis is fitted to the points near its bark."""
FEWEST = 8
"""Fewest points of a trunk by which it is placed."""
GROUND_REACH, GROUND_RANK = 0.15, 0.1
"""Without such points: how far from the root, as a share of its distance, ground tells how high it is, and the rank
among the heights there that is the ground's."""

FROM_ABOVE = -0.8
"""Rise of the line of sight below which a photo shows the ground from above."""
AXIS_POINTS = 20
"""Places along a tree's axis of which a photo of it shows at least one."""


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
    trunk, seen = strokes.branches[0].points, cloud.seen[:, list(cameras).index(drawn.first)]
    top = strokes.crown.points[strokes.crown.points[:, 1].argmin()]
    root = _foot(_Trunk(camera, trunk, top), cloud, seen)
    turn = _facing(camera.centre - root)
    metres = _metres_per_unit(cameras, drawn, root)
    if metres is None:
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


@dataclass(frozen=True, eq=False)
class _Trunk:
    """A trunk as it was drawn in one shot.

    Attributes
    ----------
    camera
        The shot's camera.
    stroke_px
        (n, 2) its stroke, the root first.
    top_px
        (2,) the top of the crown stroke.
    """

    camera: PerspectiveCamera
    stroke_px: Floats
    top_px: Floats

    @property
    def ray(self) -> Floats:
        """(3,) from the camera through the root, as long as its depth is 1."""
        return np.asarray(self.camera.world_from_pixels(self.stroke_px[:1], 1.0)[0] - self.camera.centre)

    def root_at(self, depth: float) -> Floats:
        """(3,) the root, if it is so deep in the shot."""
        return np.asarray(self.camera.centre + depth * self.ray)


def _foot(trunk: _Trunk, cloud: PointCloud, seen: Mask) -> Floats:
    """Return the root (3,) of a trunk: on the ray that shows it, as far away as the trunk's axis.

    ``seen`` (n,) marks the points that the shot sees. Without points on the trunk the ground tells how far the root is.
    """
    bark = cloud.points[seen][_beside(trunk, cloud.points[seen])]
    if len(bark) < FEWEST:
        return _on_ground(trunk, cloud)
    front = trunk.root_at(float(np.median(trunk.camera.depth(bark))))
    height = height_above(trunk.camera, front, trunk.top_px)
    middle = _axis(cloud.points, front, trunk.camera.centre, height)
    level = trunk.ray[[0, 2]]
    return trunk.root_at(float((middle - trunk.camera.centre[[0, 2]]) @ level / max(float(level @ level), 1e-12)))


def _beside(trunk: _Trunk, points: Floats) -> Mask:
    """Tell which points (n, 3) show beside the lower part of a trunk's stroke: flags (n,)."""
    length = arc_lengths(trunk.stroke_px)[-1]
    along = place_at(trunk.stroke_px, np.linspace(0.0, LOWER_TRUNK * length, 100))
    away, _ = cKDTree(along).query(trunk.camera.pixels_from_world(points))
    return np.asarray(away <= BESIDE_TRUNK * trunk.camera.height)


def _axis(points: Floats, front: Floats, eye: Floats, height: float) -> Floats:
    """Fit a circle to the bark around a trunk: its middle (2,), x and z; ``front`` (3,) is its side towards the eye."""
    near = np.hypot(*(points - front)[:, [0, 2]].T) <= AROUND_TRUNK * height
    above = (points[:, 1] - front[1]) / height
    near &= (above >= LOW) & (above <= HIGH)
    bark, ahead = points[near][:, [0, 2]], unit((front - eye)[[0, 2]])
    radius = USUAL_RADIUS * height
    start = middle = front[[0, 2]] + radius * ahead
    for _ in range(ROUNDS):
        on = bark[np.abs(np.hypot(*(bark - middle).T) - radius) <= OFF_BARK * height]
        if len(on) < FEWEST:
            return start
        # x^2 + z^2 = 2 a x + 2 b z + c (Kasa 1976)
        terms = np.column_stack([2 * (on - start), np.ones(len(on))])
        (a, b, c), *_ = np.linalg.lstsq(terms, ((on - start) ** 2).sum(axis=1), rcond=None)
        middle, radius = start + np.array([a, b]), float(np.sqrt(max(c + a * a + b * b, 0.0)))
    believed = radius <= LARGEST_RADIUS * height and np.hypot(*(middle - start)) <= AROUND_TRUNK * height
    return np.asarray(middle if believed else start)


def _on_ground(trunk: _Trunk, cloud: PointCloud) -> Floats:
    """Return the point (3,) of the ground that the shot shows at the root."""
    camera, ray = trunk.camera, trunk.ray
    away = np.linalg.norm(camera.pixels_from_world(cloud.points) - trunk.stroke_px[0], axis=1)
    depth = camera.depth(cloud.points)
    near = np.argsort(np.where(depth > 0, away, np.inf), kind="stable")[:FEWEST]
    found = trunk.root_at(float(np.median(depth[near])))
    for _ in range(ROUNDS if ray[1] < 0 else 0):
        reach = GROUND_REACH * float(np.linalg.norm(found - camera.centre))
        around = np.hypot(*(cloud.points - found)[:, [0, 2]].T) <= reach
        below = around & (cloud.points[:, 1] < camera.centre[1])
        if np.count_nonzero(below) < FEWEST:
            break
        found = trunk.root_at(float((np.quantile(cloud.points[below, 1], GROUND_RANK) - camera.centre[1]) / ray[1]))
    return np.asarray(found)


def height_above(camera: PerspectiveCamera, root: Floats, top_px: Floats) -> float:
    """Height of a picture point above the root, in the upright plane through the root that faces the camera."""
    return float(_upright(camera, root, top_px[None])[0, 1] - root[1])


def _upright(camera: PerspectiveCamera, root: Floats, points_px: Floats) -> Floats:
    """Lay picture points (n, 2) on the upright plane through the root that faces the camera: (n, 3)."""
    rays = camera.world_from_pixels(points_px, 1.0) - camera.centre
    ahead = unit((root - camera.centre) * [1.0, 0.0, 1.0])
    along = ((root - camera.centre) @ ahead) / np.maximum(rays @ ahead, 1e-9)
    return np.asarray(camera.centre + along[:, None] * rays)


def shows_tree(camera: PerspectiveCamera, height_m: float) -> bool:
    """Tell whether some of the tree's axis, from the root at the origin to ``height_m`` above, is in a picture."""
    axis = np.linspace(0.0, height_m, AXIS_POINTS)[:, None] * [0.0, 1.0, 0.0]
    x, y = camera.pixels_from_world(axis).T
    inside = (x >= 0) & (x <= camera.width) & (y >= 0) & (y <= camera.height)
    return bool((inside & (camera.depth(axis) > 0)).any())


def _metres_per_unit(cameras: Mapping[str, PerspectiveCamera], drawn: CaptureStrokes, root: Floats) -> float | None:
    """Return the metres of a structure's unit by the strokes' scale; None without one."""
    if drawn.scale is None:
        return None
    if isinstance(drawn.scale, CameraDistance):
        first, second = (_camera(cameras, name, ("scale", "photos")).centre for name in drawn.scale.photos)
        return drawn.scale.metres / max(float(np.linalg.norm(first - second)), 1e-9)
    camera = _camera(cameras, drawn.scale.photo, ("scale", "photo"))
    return _metres_by_line(camera, drawn.scale.length, root)


def _metres_by_line(camera: PerspectiveCamera, line: Length, root: Floats) -> float:
    """Metres of a unit by a drawn line beside the root: an upright one, but in a photo taken from above."""
    above = camera.ahead[1] < FROM_ABOVE
    depth = float(camera.depth(root[None])[0])
    ends = camera.world_from_pixels(line.points, depth) if above else _upright(camera, root, line.points)
    return line.metres / max(float(np.linalg.norm(ends[1] - ends[0])), 1e-9)
