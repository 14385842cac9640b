import numpy as np
import pytest
from tests.core.lift.stick_captures import FORK, capture

from treestroke.core.lift.ridge_fit import fitted
from treestroke.core.lift.thin_hull import ShownArea, shown_area
from treestroke.core.skeleton.skeleton import Skeleton


@pytest.fixture(scope="module")
def areas() -> list[ShownArea]:
    pairs = zip(*capture(FORK), strict=True)
    return [shown_area(shot, matte.tree, matte.tree, matte.hidden) for shot, matte in pairs]


def limb(aside: tuple[float, float, float]) -> Skeleton:
    """The trunk, with the fork's first limb moved aside and too thick."""
    trunk, branch = FORK[0], FORK[1]
    lower = np.linspace((0, 0, 0), trunk[1], 12)
    upper = np.linspace(branch[0], branch[1], 12)[2:]
    points = np.concatenate([lower, upper + np.array(aside)])
    return Skeleton(points, np.full(len(points), 0.05), np.arange(len(points)) - 1)


def test_joints_move_to_the_middle_of_the_wood_and_the_root_stays(areas: list[ShownArea]) -> None:
    moved = fitted(limb((0.0, 0.015, 0.015)), areas)[0].points
    start, way = np.array(FORK[1][0]), np.subtract(FORK[1][1], FORK[1][0])
    away = np.linalg.norm(np.cross(moved[14:] - start, way), axis=1) / np.linalg.norm(way)
    assert np.median(away) < 0.005
    assert moved[0].tolist() == [0.0, 0.0, 0.0]


def test_radii_are_half_the_width_that_the_shots_show(areas: list[ShownArea]) -> None:
    radii = fitted(limb((0.0, 0.0, 0.0)), areas)[1]
    assert np.median(radii[2:9]) == pytest.approx(FORK[0][2], rel=0.1)
    assert np.median(radii[16:-1]) == pytest.approx(FORK[1][2], rel=0.15)


def test_where_no_wood_is_seen_nothing_moves_far_and_no_radius_is_known(areas: list[ShownArea]) -> None:
    away = limb((0.0, 0.7, 0.0))
    moved, radii = fitted(away, areas)
    assert (radii[18:] == 0).all()
    assert np.linalg.norm(moved.points - away.points, axis=1)[18:].max() < 0.2
