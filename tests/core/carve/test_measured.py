"""Measured crowns of balls and posts from mattes that follow from geometry."""

import numpy as np
import pytest
from tests.core.carve.walk import Ball, ball_points, camera_at, matte, sees, sees_post, shot, walk

from treestroke.core.capture import PointCloud
from treestroke.core.carve.carving import carved, with_points
from treestroke.core.carve.measured import measured_crown
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.geometry.measured_crown import MeasuredCrown
from treestroke.core.progress import silent

CROWN: Ball = ((0.0, 3.0, 0.0), 1.1)
TOP = 4.0


def crown_of(cameras: list[PerspectiveCamera], leaves: list[Ball], wood: list[Ball] | None = None) -> MeasuredCrown:
    mattes = []
    for camera in cameras:
        post = sees_post(camera, TOP) | (sees(camera, wood) if wood else False)
        mattes.append(matte(sees(camera, leaves) if leaves else np.zeros_like(post), post))
    shots = [shot(camera) for camera in cameras]
    return measured_crown(carved(shots, mattes, silent), shots)


def test_leaves_fill_the_crown_and_not_the_trunk() -> None:
    crown = crown_of(walk(12, 360), [CROWN])
    assert crown.inside(ball_points(CROWN, 0.9, np.random.default_rng(0))).mean() > 0.95
    assert not crown.inside(np.array([[0.0, height, 0.0] for height in (0.3, 0.8, 1.4)])).any()
    assert crown.shown(np.array([[0.0, 0.8, 0.0]])).all()
    assert crown.bounds[0, 1] == pytest.approx(1.9, abs=0.2)


def test_what_only_some_lines_of_sight_allow_is_emptied() -> None:
    balls: list[Ball] = [((x, 3.0, z), 0.5) for x, z in ((-1.0, 0.0), (1.0, 0.0), (0.0, -1.1), (0.0, 1.1))]
    crown = crown_of(walk(9, 200), balls)
    places = crown.cells.corner + crown.cells.side * (np.argwhere(crown.hull) + 0.5)
    places = places[places[:, 1] > 2.5]
    beside = np.min([np.linalg.norm(places - middle, axis=1) - radius for middle, radius in balls], axis=0)
    density = crown.density_at(places)
    assert (beside < 0.2).mean() < 0.75
    assert density[beside < 0.2].sum() > 0.85 * density.sum()


def test_a_bare_trees_crown_is_its_twigs_above_the_trunk() -> None:
    crown = crown_of(walk(12, 360), [], wood=[((0.7, 3.0, 0.0), 0.4), ((-0.7, 3.2, 0.3), 0.4)])
    assert crown.bounds[0, 1] > 2.0
    assert crown.inside(np.array([[0.7, 3.0, 0.0], [-0.7, 3.2, 0.3]])).all()


def test_sides_that_no_shot_was_taken_from_are_guessed_and_kept_in_bounds() -> None:
    crown = crown_of([camera_at(azimuth) for azimuth in np.deg2rad([-50, -30, -10, 10, 30, 50])], [CROWN])
    behind, before = np.array([[0.0, 3.0, -0.8]]), np.array([[0.0, 3.0, 0.8]])
    assert crown.guessed_at(behind).all()
    assert not crown.guessed_at(before).any()
    assert crown.bounds[0, 2] > -1.6


def test_lines_of_sight_are_open_up_to_the_points_that_shots_see() -> None:
    cameras = walk(8, 360)
    shots, mattes = [shot(camera) for camera in cameras], [matte(sees(camera, [CROWN])) for camera in cameras]
    carving = carved(shots, mattes, silent)
    outward = np.random.default_rng(2).normal(size=(3000, 3))
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    points = CROWN[0] + 0.5 * outward
    seen = np.stack([(outward * camera.toward_viewer(points)).sum(axis=1) > 0.2 for camera in cameras], axis=1)
    told = with_points(carving, shots, PointCloud(points, np.zeros((3000, 3), np.uint8), seen))
    away = np.linalg.norm(carving.grid.middles - CROWN[0], axis=1)
    level = np.abs(carving.grid.middles[:, 1] - CROWN[0][1]) < 0.2
    before, after = (each.density[level & (away > 0.75) & (away < 1.0)].mean() for each in (carving, told))
    assert after < 0.5 * before
    assert told.density[level & (np.abs(away - 0.5) < 0.1)].mean() > 3 * after
