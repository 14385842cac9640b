"""The tree's frame: a post on the ground, photographed from all around in a frame of any scale, turn and origin."""

from dataclasses import replace

import numpy as np
import pytest
from tests.core.carve.walk import walk

from treestroke.core.capture import PointCloud
from treestroke.core.errors import StrokesError
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.geometry.similarity import Similarity
from treestroke.core.pipeline.tree_frame import height_above, shows_tree, tree_frame
from treestroke.core.strokes import CameraDistance, CaptureStrokes, Length, LengthInPhoto, Stroke, Strokes
from treestroke.core.types import Floats

ROOT, RADIUS, HEIGHT = np.array([0.4, 0.0, -0.3]), 0.12, 4.0
TURNED = np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]])
SOLVED = Similarity(np.array([2.0, -1.0, 0.5]), TURNED, 0.25)
"""From metres to the frame in which the cameras were found."""
WALK = walk(8, 360.0)
CAMERAS = {f"{n}.jpg": SOLVED.camera(camera) for n, camera in enumerate(WALK)}


def cloud(trunk: bool = True) -> PointCloud:
    """Points on the ground, seen from everywhere, and on the post's bark, each seen from its side."""
    rng = np.random.default_rng(4)
    x, z = rng.uniform(-3, 3, (2, 400))
    ground = np.column_stack([x, rng.normal(0, 0.01, 400), z])
    angle, height = rng.uniform(0, 2 * np.pi, 600), rng.uniform(0, 3, 600)
    outward = np.column_stack([np.sin(angle), 0 * angle, np.cos(angle)])
    bark = ROOT + RADIUS * outward + height[:, None] * [0.0, 1.0, 0.0]
    facing = [((camera.centre - bark) * outward).sum(axis=1) > 0 for camera in WALK]
    points, seen = ground, np.ones((400, 8), bool)
    if trunk:
        points, seen = np.concatenate([ground, bark]), np.concatenate([seen, np.column_stack(facing)])
    return PointCloud(SOLVED.points(points), np.zeros((len(points), 3), np.uint8), seen)


def drawn_on(camera: PerspectiveCamera) -> Strokes:
    trunk = camera.pixels_from_world(ROOT + np.array([[0.0, 0, 0], [0, 1.5, 0], [0, 3, 0]]))
    crown = camera.pixels_from_world(ROOT + np.array([[-1.0, 2, 0], [0, HEIGHT, 0], [1, 2, 0]]))
    return Strokes(Stroke(crown), (Stroke(trunk),), ())


DRAWN = CaptureStrokes({"2.jpg": drawn_on(WALK[2])}, None)


def carried(frame: Similarity, point: Floats) -> Floats:
    """Carry a place in metres to the tree's frame."""
    return frame.points(SOLVED.points(point[None]))[0]


@pytest.mark.parametrize(("trunk", "off_m"), [(True, 0.02), (False, 0.15)])
def test_the_root_is_the_trunks_foot(trunk: bool, off_m: float) -> None:
    frame = tree_frame(CAMERAS, cloud(trunk), DRAWN, HEIGHT)
    assert np.linalg.norm(carried(frame, ROOT)) < off_m


def test_z_looks_at_the_camera_of_the_trunk_stroke() -> None:
    frame = tree_frame(CAMERAS, cloud(), DRAWN, HEIGHT)
    x, _, z = frame.camera(CAMERAS["2.jpg"]).centre
    assert z > 8
    assert abs(x) < 0.1
    above = carried(frame, ROOT + np.array([0.0, 1.0, 0.0])) - carried(frame, ROOT)
    assert above == pytest.approx([0.0, 1.0, 0.0], abs=0.02)


def test_the_height_sets_the_scale() -> None:
    frame = tree_frame(CAMERAS, cloud(), DRAWN, 2 * HEIGHT)
    assert frame.scale == pytest.approx(2 / SOLVED.scale, rel=0.02)
    top = DRAWN.by_photo["2.jpg"].crown.points[1]
    assert height_above(frame.camera(CAMERAS["2.jpg"]), np.zeros(3), top) == pytest.approx(2 * HEIGHT, rel=0.01)


def test_the_distance_of_two_photos_sets_the_scale() -> None:
    apart = float(np.linalg.norm(WALK[0].centre - WALK[3].centre))
    drawn = replace(DRAWN, scale=CameraDistance(("0.jpg", "3.jpg"), apart))
    assert tree_frame(CAMERAS, cloud(), drawn, 1.0).scale == pytest.approx(1 / SOLVED.scale)


def test_a_drawn_length_beside_the_tree_sets_the_scale() -> None:
    ends = WALK[5].pixels_from_world(ROOT + np.array([[0.0, 0.5, 0.0], [0.0, 2.5, 0.0]]))
    drawn = replace(DRAWN, scale=LengthInPhoto("5.jpg", Length(ends, 2.0)))
    assert tree_frame(CAMERAS, cloud(), drawn, 1.0).scale == pytest.approx(1 / SOLVED.scale, rel=0.01)


def test_an_upright_length_is_right_in_a_photo_that_looks_up() -> None:
    pitch, level = np.radians(8.0), WALK[2].camera_from_world
    up = np.array([[1, 0, 0], [0, np.cos(pitch), np.sin(pitch)], [0, -np.sin(pitch), np.cos(pitch)]]) @ level
    camera = replace(WALK[2], camera_from_world=up)
    ends = camera.pixels_from_world(ROOT + np.array([[0.0, 0.0, 0.0], [0.0, 3.0, 0.0]]))
    cameras = {**CAMERAS, "2.jpg": SOLVED.camera(camera)}
    drawn = CaptureStrokes({"2.jpg": drawn_on(camera)}, LengthInPhoto("2.jpg", Length(ends, 3.0)))
    assert tree_frame(cameras, cloud(), drawn, 1.0).scale == pytest.approx(1 / SOLVED.scale, rel=0.002)


@pytest.mark.parametrize(
    ("drawn", "pointer"),
    [
        (CaptureStrokes({"9.jpg": drawn_on(WALK[2])}, None), "/views"),
        (replace(DRAWN, scale=CameraDistance(("0.jpg", "9.jpg"), 1.0)), "/scale/photos"),
        (replace(DRAWN, scale=LengthInPhoto("9.jpg", Length(np.eye(2), 1.0))), "/scale/photo"),
    ],
)
def test_photos_without_a_camera_are_refused(drawn: CaptureStrokes, pointer: str) -> None:
    with pytest.raises(StrokesError, match=r"9\.jpg") as refused:
        tree_frame(CAMERAS, cloud(), drawn, HEIGHT)
    assert (refused.value.code, refused.value.pointer) == ("photo_not_used", pointer)


def test_a_photo_shows_the_tree_where_some_of_it_is_inside() -> None:
    ahead = WALK[0]
    aside = Similarity(np.array([12.0, 0.0, 0.0]), np.eye(3), 1.0).camera(ahead)
    behind = Similarity(np.array([0.0, 0.0, 12.0]), np.eye(3), 1.0).camera(ahead)
    above = Similarity(np.array([0.0, -8.0, 0.0]), np.eye(3), 1.0).camera(ahead)
    assert [shows_tree(camera, HEIGHT) for camera in (ahead, aside, behind, above)] == [True, False, False, False]
    assert shows_tree(above, 3 * HEIGHT)
