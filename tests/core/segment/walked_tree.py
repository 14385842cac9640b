"""A small tree photographed from all around: a crown of leafy balls on a trunk, before sky, lawn and far bushes."""

import cv2
import numpy as np

from treestroke.core.capture import PointCloud, Shot
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.strokes import Stroke, Strokes
from treestroke.core.types import Mask

WIDTH, HEIGHT, FOCAL, RING = 200, 150, 190.0, 10.0
BALLS = [((0.0, 3.6, 0.0), 0.9), ((0.9, 3.0, 0.3), 0.6), ((-0.7, 2.9, -0.6), 0.6), ((0.2, 2.8, 0.9), 0.5)]
TRUNK_TOP, TRUNK_HALF = 3.2, 0.12
NO_POINTS = PointCloud(np.zeros((0, 3)), np.zeros((0, 3), np.uint8), np.zeros((0, 8), np.bool_))


def camera_at(azimuth: float) -> PerspectiveCamera:
    """Return a level camera on a ring, 0 at +Z, that looks at the tree."""
    centre = RING * np.array([np.sin(azimuth), 0.0, np.cos(azimuth)]) + (0.0, 1.6, 0.0)
    ahead = -np.array([np.sin(azimuth), 0.0, np.cos(azimuth)])
    turn = np.stack([np.cross(ahead, (0.0, 1.0, 0.0)), (0.0, -1.0, 0.0), ahead])
    matrix = np.column_stack([turn, -turn @ centre])
    return PerspectiveCamera(WIDTH, HEIGHT, matrix, FOCAL, (WIDTH / 2, 0.6 * HEIGHT))


def cover(camera: PerspectiveCamera) -> tuple[Mask, Mask]:
    """Return where a camera sees the leaves and where it sees the trunk."""
    leaves, wood = (np.zeros((HEIGHT, WIDTH), np.uint8) for _ in range(2))
    for centre, radius in BALLS:
        place = np.array([centre])
        x, y = np.rint(camera.pixels_from_world(place)[0]).astype(int).tolist()
        cv2.circle(leaves, (x, y), round(float(radius / camera.pixel_size(place)[0])), 1, -1)
    foot, top = np.rint(camera.pixels_from_world(np.array([[0.0, 0.0, 0.0], [0.0, TRUNK_TOP, 0.0]]))).astype(int)
    breadth = round(float(2 * TRUNK_HALF / camera.pixel_size(np.zeros((1, 3)))[0]))
    cv2.rectangle(wood, (int(foot[0]) - breadth // 2, int(top[1])), (int(foot[0]) + breadth // 2, int(foot[1])), 1, -1)
    return leaves > 0, (wood > 0) & (leaves == 0)


def shot_at(azimuth: float, rng: np.random.Generator, bushes: bool = True) -> Shot:
    """Take a photo from an azimuth; the bushes have the leaves' colours and stand far away all around."""
    camera = camera_at(azimuth)
    leaves, wood = cover(camera)
    rows = np.arange(HEIGHT)[:, None, None] / HEIGHT
    picture = np.broadcast_to((120, 170, 230) + 40 * rows, (HEIGHT, WIDTH, 3)).copy()
    picture[int(0.6 * HEIGHT) :] = (140, 150, 70)
    if bushes:
        far = np.random.default_rng(7)
        for turn in np.arange(0, 2 * np.pi, 0.08):
            place = np.array([[60 * np.sin(turn), far.uniform(0.5, 4.0), 60 * np.cos(turn)]])
            shade = far.integers(-25, 40, 3)
            if camera.depth(place)[0] > 1:
                x, y = camera.pixels_from_world(place)[0].astype(int).tolist()
                cv2.circle(picture, (x, y), 4, (np.array([60, 95, 40]) + shade).tolist(), -1)
    speckle = rng.integers(-25, 25, (HEIGHT, WIDTH, 1))
    picture[leaves] = (np.array((60, 95, 40)) + speckle)[leaves]
    picture[wood] = (np.array((85, 65, 50)) + speckle // 3)[wood]
    noisy = picture + rng.normal(0, 3, picture.shape)
    return Shot(f"{np.degrees(azimuth):.0f}.jpg", np.clip(noisy, 0, 255).astype(np.uint8), camera)


def walk(count: int) -> tuple[tuple[Shot, ...], list[Mask]]:
    """Return shots from all around, and where each shows the tree."""
    rng = np.random.default_rng(0)
    shots = tuple(shot_at(azimuth, rng) for azimuth in np.linspace(0, 2 * np.pi, count, endpoint=False))
    return shots, [np.logical_or(*cover(shot.camera)) for shot in shots]


def strokes_on(shot: Shot, erase: tuple[Stroke, ...] = ()) -> Strokes:
    """Draw around the crown, a little loosely, and up the trunk."""
    leaves, _ = cover(shot.camera)
    loose = cv2.dilate(leaves.astype(np.uint8), np.ones((5, 5), np.uint8))
    outline = max(cv2.findContours(loose, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0], key=len)[::4, 0].astype(float)
    up = np.linspace(0.03, 2.4, 6)
    trunk = shot.camera.pixels_from_world(np.column_stack([0 * up, up, 0 * up]))
    return Strokes(Stroke(outline), (Stroke(trunk),), erase)
