"""Dense points on a painted ball."""

import numpy as np
import pytest
from tests.core.carve.walk import Ball, matte, painted, sees, shot, walk

from treestroke.core.capture import PointCloud, Shot, TreeMatte
from treestroke.core.carve.carving import carved
from treestroke.core.carve.dense_points import dense_cloud
from treestroke.core.carve.plane_sweep import depth_map, swept_shot
from treestroke.core.progress import silent

CROWN: Ball = ((0.1, 3.0, 0.0), 1.4)


def capture(count: int, arc_deg: float) -> tuple[list[Shot], list[TreeMatte]]:
    cameras = walk(count, arc_deg)
    shots = [shot(camera, painted(camera, CROWN)) for camera in cameras]
    return shots, [matte(sees(camera, [CROWN])) for camera in cameras]


def cloud_of(shots: list[Shot], mattes: list[TreeMatte]) -> PointCloud:
    return dense_cloud(carved(shots, mattes, silent), shots, mattes, silent)


@pytest.fixture(scope="module")
def shots() -> list[Shot]:
    return capture(7, 110)[0]


@pytest.fixture(scope="module")
def cloud(shots: list[Shot]) -> PointCloud:
    return cloud_of(shots, capture(7, 110)[1])


def test_points_lie_on_the_surface_and_cover_it(cloud: PointCloud) -> None:
    off = np.linalg.norm(cloud.points - CROWN[0], axis=1) - CROWN[1]
    assert len(cloud) > 500
    assert np.median(np.abs(off)) < 0.08
    assert (np.abs(off) < 0.2).mean() > 0.9
    facing = np.array(CROWN[0]) + CROWN[1] * np.array([[np.sin(1.0), 0.0, np.cos(1.0)]])
    assert np.linalg.norm(cloud.points - facing, axis=1).min() < 0.15


def test_shots_see_the_points_on_their_side_only(shots: list[Shot], cloud: PointCloud) -> None:
    outward = (cloud.points - CROWN[0]) / CROWN[1]
    toward = outward @ (shots[0].camera.centre / np.linalg.norm(shots[0].camera.centre))
    assert cloud.seen.shape == (len(cloud), 7)
    assert cloud.seen[toward > 0.7, 0].mean() > 0.7
    assert cloud.seen[toward < -0.3, 0].mean() < 0.02


def test_points_have_the_colours_of_the_shots(shots: list[Shot], cloud: PointCloud) -> None:
    x, y = np.floor(shots[3].camera.pixels_from_world(cloud.points)).astype(int).T
    apart = np.abs(cloud.colours[:, 0].astype(int) - shots[3].picture[y, x, 0])[cloud.seen[:, 3]]
    assert np.median(apart) < 12


def test_the_same_shots_give_the_same_points() -> None:
    shots, mattes = capture(4, 60)
    first, second = cloud_of(shots, mattes), cloud_of(shots, mattes)
    assert first.points.tobytes() == second.points.tobytes()
    assert first.seen.tobytes() == second.seen.tobytes()


def test_a_depth_map_holds_depths_of_the_tree_alone() -> None:
    shots, mattes = capture(4, 60)
    carving = carved(shots, mattes, silent)
    ready = [swept for swept in map(swept_shot, shots, mattes) if swept is not None]
    depth = depth_map(ready[2], [ready[1], ready[3]], carving.field)
    assert depth.depth_m.shape == ready[2].tree.shape
    assert not depth.depth_m[~ready[2].tree].any()
    found = depth.depth_m[ready[2].tree]
    assert (found > 0).mean() > 0.95
    assert 7.0 < np.median(found) < 9.0


def test_a_shot_without_the_tree_is_not_swept_and_mattes_must_fit() -> None:
    shots, mattes = capture(4, 60)
    assert swept_shot(shots[0], matte(np.zeros_like(mattes[0].hidden))) is None
    with pytest.raises(ValueError, match="a matte for each shot"):
        dense_cloud(carved(shots, mattes, silent), shots, mattes[1:], silent)
