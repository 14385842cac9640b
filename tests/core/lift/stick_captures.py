"""Captures of trees made of straight sticks, drawn from all sides; metres, Y up, the root at the origin."""

import cv2
import numpy as np

from treestroke.core.capture import PointCloud, Shot, TreeMatte
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.types import Floats

Stick = tuple[tuple[float, float, float], tuple[float, float, float], float]
"""A stick's two ends and its radius, metres."""
FORK: tuple[Stick, ...] = (
    ((0, -0.2, 0), (0, 1.5, 0), 0.05),
    ((0, 1.4, 0), (0.7, 2.4, 0.2), 0.03),
    ((0, 1.4, 0), (-0.5, 2.3, -0.5), 0.03),
)
SIZE = 320


def ring(count: int) -> list[PerspectiveCamera]:
    """Stand cameras on a circle of 5 m about the tree, each looking at 1.2 m height."""
    cameras = []
    for turn in 2 * np.pi * np.arange(count) / count:
        back = np.array([np.sin(turn), 0, np.cos(turn)])
        rotation = np.stack([[np.cos(turn), 0, -np.sin(turn)], [0, -1, 0], -back])
        centre = 5 * back + [0, 1.2, 0]
        pose = np.column_stack([rotation, -rotation @ centre])
        cameras.append(PerspectiveCamera(SIZE, SIZE, pose, 500.0, (SIZE / 2, SIZE / 2)))
    return cameras


def drawn(camera: PerspectiveCamera, sticks: tuple[Stick, ...]) -> np.ndarray:
    """Draw sticks in a mask."""
    mask = np.zeros((SIZE, SIZE), dtype=np.uint8)
    for start, end, radius in sticks:
        places = np.linspace(start, end, 60)
        pixels = camera.pixels_from_world(places)
        for place, size in zip(pixels, radius / camera.pixel_size(places), strict=True):
            cv2.circle(mask, np.rint(16 * (place - 0.5)).astype(int).tolist(), round(16 * size), 1, -1, cv2.LINE_8, 4)
    return mask > 0


def capture(
    sticks: tuple[Stick, ...], leaves: tuple[Stick, ...] = (), count: int = 10
) -> tuple[list[Shot], list[TreeMatte]]:
    """Take shots of sticks with leaves before them, and their mattes."""
    shots, mattes = [], []
    for number, camera in enumerate(ring(count)):
        wood, leafy = drawn(camera, sticks), drawn(camera, leaves)
        picture = np.zeros((SIZE, SIZE, 3), dtype=np.uint8)
        shots.append(Shot(f"{number}.jpg", picture, camera))
        opacity, woody = (wood | leafy).astype(np.float32), (wood & ~leafy).astype(np.float32)
        mattes.append(TreeMatte(opacity, woody, np.zeros((SIZE, SIZE), dtype=bool)))
    return shots, mattes


def cloud(points: Floats, count: int = 10) -> PointCloud:
    """Make a cloud of points that all shots see."""
    return PointCloud(points, np.zeros((len(points), 3), np.uint8), np.ones((len(points), count), dtype=bool))


def along(stick: Stick) -> Floats:
    """Return places along a stick's middle, above the ground."""
    places = np.linspace(stick[0], stick[1], 25)
    return places[places[:, 1] >= 0]
