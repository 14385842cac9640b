"""Photos of a small scene of textured boxes on textured ground, drawn plane by plane, and their true cameras."""

from collections.abc import Iterator, Sequence
from functools import cache

import cv2
import numpy as np

from treestroke.core.capture import CapturedPhoto, Structure
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.types import Floats, Picture

SIZE = 360, 270
FOCAL = 440.0
RING = 8.0
BOXES = [(-1.6, 0.0, -1.2, 1.0, 1.6), (0.0, 0.0, 0.0, 0.8, 2.4), (1.5, 0.0, 0.8, 1.0, 0.9), (1.2, 0.0, -1.8, 1.0, 2.0)]
"""Of each box the middle of its foot, its breadth and its height."""


def camera_at(
    eye: Floats, target: Floats, size: tuple[int, int] = SIZE, roll_rad: float = 0.0, focal: float = FOCAL
) -> PerspectiveCamera:
    """Return a camera that looks from a place at another, turned about its axis by a small angle."""
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    turn = np.array([right, np.cross(ahead, right), ahead])
    c, s = np.cos(roll_rad), np.sin(roll_rad)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ turn
    pose = np.column_stack([turn, -turn @ eye])
    return PerspectiveCamera(*size, pose, focal, (size[0] / 2, size[1] / 2))


def ring(count: int, arc_deg: float, start_deg: float = 0.0) -> list[PerspectiveCamera]:
    """Return cameras around the scene, held nearly level at slightly differing heights."""
    rng = np.random.default_rng(3)
    cameras = []
    for angle in np.radians(start_deg + np.linspace(0, arc_deg, count)):
        eye = np.array([RING * np.sin(angle), 2.0 + 0.3 * rng.standard_normal(), RING * np.cos(angle)])
        cameras.append(camera_at(eye, np.array([0.0, 0.9, 0.0]), roll_rad=0.02 * rng.standard_normal()))
    return cameras


def photos_of(cameras: Sequence[PerspectiveCamera], seed: int = 0, prefix: str = "") -> list[CapturedPhoto]:
    """Take photos of the scene with the textures of a seed."""
    return [CapturedPhoto(f"{prefix}{n:02d}.jpg", picture(camera, seed)) for n, camera in enumerate(cameras)]


def picture(camera: PerspectiveCamera, seed: int = 0) -> Picture:
    """Draw what a camera sees: the farthest plane first."""
    shown = np.full((camera.height, camera.width, 3), 225, np.uint8)
    planes = sorted(_planes(), key=lambda plane: -float(np.linalg.norm(plane[1].mean(axis=0) - camera.centre)))
    planes = [plane for plane in planes if plane[0] == 0] + [plane for plane in planes if plane[0] > 0]
    for number, corners in planes:
        normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
        if normal @ (camera.centre - corners[0]) <= 0 or camera.depth(corners).min() <= 0.1:
            continue
        texture, size = _texture(seed * 100 + number), (camera.width, camera.height)
        side = float(len(texture))
        source = np.array([[0, 0], [side, 0], [side, side], [0, side]], np.float32)
        to_picture = cv2.getPerspectiveTransform(source, camera.pixels_from_world(corners).astype(np.float32) - 0.5)
        fine = cv2.warpPerspective(texture, to_picture, size, flags=cv2.INTER_AREA)
        inside = cv2.warpPerspective(np.full_like(texture, 255), to_picture, size, flags=cv2.INTER_NEAREST)
        shown = np.where(inside > 0, fine, shown)
    return np.asarray(cv2.GaussianBlur(shown, (0, 0), 0.7), np.uint8)


def _planes() -> Iterator[tuple[int, Floats]]:
    """Yield number and corners of the ground and of the boxes' sides, counter-clockwise as seen from outside."""
    yield 0, np.array([[-4.0, 0, 4], [4, 0, 4], [4, 0, -4], [-4, 0, -4]])
    number = 0
    for x, y, z, breadth, height in BOXES:
        r = breadth / 2
        foot = np.array([[x - r, y, z + r], [x + r, y, z + r], [x + r, y, z - r], [x - r, y, z - r]])
        top = foot + np.array([0.0, height, 0.0])
        for side in range(4):
            number += 1
            after = (side + 1) % 4
            yield number, np.array([foot[side], foot[after], top[after], top[side]])
        number += 1
        yield number, top


@cache
def _texture(seed: int) -> Picture:
    """Return a picture (256, 256, 3) of blots of all sizes."""
    rng = np.random.default_rng(seed)
    total = np.zeros((256, 256, 3))
    for cells in (8, 24, 64, 160):
        blots = rng.random((cells, cells, 1)) + 0.3 * rng.random((cells, cells, 3))
        total += cv2.resize(blots.astype(np.float32), (256, 256), interpolation=cv2.INTER_CUBIC) - 0.65
    return np.clip(128 + 150 * total, 0, 255).astype(np.uint8)


def centre_errors(structure: Structure, cameras: dict[str, PerspectiveCamera]) -> Floats:
    """Measure how far cameras' centres are from the true ones after the best similarity, over the ring's radius."""
    found = np.array([photo.camera.centre for photo in structure.photos])
    true = np.array([cameras[photo.name].centre for photo in structure.photos])
    scale, turn, shift = similarity(found, true)
    return np.asarray(np.linalg.norm(scale * found @ turn.T + shift - true, axis=1) / RING)


def similarity(found: Floats, true: Floats) -> tuple[float, Floats, Floats]:
    """Return scale, rotation and shift that best take points to others (Umeyama 1991)."""
    a, b = found - found.mean(axis=0), true - true.mean(axis=0)
    u, d, vt = np.linalg.svd(b.T @ a)
    sign = np.diag([1, 1, np.sign(np.linalg.det(u @ vt))])
    turn = u @ sign @ vt
    scale = float(np.trace(np.diag(d) @ sign) / (a**2).sum())
    return scale, turn, true.mean(axis=0) - scale * turn @ found.mean(axis=0)
