"""Shots of balls and a post, as mattes that follow from geometry, from a walk around them."""

import numpy as np

from treestroke.core.capture import Shot, TreeMatte
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.types import Floats, Mask, Picture

WIDTH, HEIGHT, FOCAL = 160, 200, 190.0
RING = 9.0
POST_RADIUS = 0.15

Ball = tuple[tuple[float, float, float], float]


def camera_at(azimuth_rad: float) -> PerspectiveCamera:
    """A level camera on the ring, 2 m above the ground, that looks at the axis."""
    sine, cosine = np.sin(azimuth_rad), np.cos(azimuth_rad)
    turn = np.array([[cosine, 0.0, -sine], [0.0, -1.0, 0.0], [-sine, 0.0, -cosine]])
    centre = np.array([RING * sine, 2.0, RING * cosine])
    return PerspectiveCamera(WIDTH, HEIGHT, np.column_stack([turn, -turn @ centre]), FOCAL, (WIDTH / 2, HEIGHT / 2))


def walk(count: int, arc_deg: float) -> list[PerspectiveCamera]:
    """Cameras evenly over an arc that begins on +Z; a full circle has no camera twice."""
    return [camera_at(azimuth) for azimuth in np.deg2rad(np.linspace(0, arc_deg, count, endpoint=arc_deg < 360))]


def sees(camera: PerspectiveCamera, balls: list[Ball]) -> Mask:
    """Pixels (h, w) whose line of sight meets a ball."""
    ahead = _ahead(camera)
    away = [np.linalg.norm(np.cross(ahead, np.array(middle) - camera.centre), axis=1) <= r for middle, r in balls]
    return np.asarray(np.any(away, axis=0)).reshape(HEIGHT, WIDTH)


def sees_post(camera: PerspectiveCamera, top: float) -> Mask:
    """Pixels (h, w) whose line of sight passes a post on the root close by, from the ground to its top."""
    ahead = _ahead(camera)
    flat = ahead[:, ::2]
    way = -(flat @ camera.centre[::2]) / (flat**2).sum(axis=1)
    nearest = camera.centre + way[:, None] * ahead
    beside = np.hypot(nearest[:, 0], nearest[:, 2]) <= POST_RADIUS
    return np.asarray(beside & (nearest[:, 1] >= 0) & (nearest[:, 1] <= top)).reshape(HEIGHT, WIDTH)


def painted(camera: PerspectiveCamera, ball: Ball) -> Picture:
    """A picture (h, w, 3) of one ball whose surface is painted with an even pattern that repeats nowhere near."""
    ahead = _ahead(camera)
    to_middle = np.array(ball[0]) - camera.centre
    along = ahead @ to_middle
    chord = np.sqrt(np.maximum(ball[1] ** 2 - (to_middle @ to_middle - along**2), 0.0))
    points = camera.centre + (along - chord)[:, None] * ahead
    waves = np.random.default_rng(5).normal(0, 5.0, (3, 24))
    grey = 120 + 25 * np.sin(points @ waves + np.arange(24)).sum(axis=1) / np.sqrt(12)
    grey = np.where(sees(camera, [ball]).ravel(), np.clip(grey, 0, 255), 200)
    return np.repeat(grey.astype(np.uint8)[:, None], 3, axis=1).reshape(HEIGHT, WIDTH, 3)


def shot(camera: PerspectiveCamera, picture: Picture | None = None) -> Shot:
    """A shot, black if no picture is given."""
    return Shot("shot", np.zeros((HEIGHT, WIDTH, 3), np.uint8) if picture is None else picture, camera)


def matte(leaves: Mask, wood: Mask | None = None) -> TreeMatte:
    """The matte of leaves before wood; nothing stands before the tree."""
    wood = np.zeros_like(leaves) if wood is None else wood & ~leaves
    return TreeMatte((leaves | wood).astype(np.float32), wood.astype(np.float32), np.zeros_like(leaves))


def ball_points(ball: Ball, share: float, rng: np.random.Generator) -> Floats:
    """Places (200, 3) in a ball, within a share of its radius."""
    steps = rng.normal(size=(200, 3))
    steps *= (rng.random(200) ** (1 / 3) / np.linalg.norm(steps, axis=1))[:, None]
    return np.asarray(np.array(ball[0]) + share * ball[1] * steps)


def _ahead(camera: PerspectiveCamera) -> Floats:
    row, column = np.indices((HEIGHT, WIDTH)).reshape(2, -1)
    middles = np.asarray(np.stack([column, row], axis=1) + 0.5, dtype=np.float64)
    ahead = camera.world_from_pixels(middles, 1.0) - camera.centre
    return np.asarray(ahead / np.linalg.norm(ahead, axis=1, keepdims=True))
