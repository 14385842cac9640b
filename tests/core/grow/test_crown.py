import numpy as np
import pytest
from tests.core.grow.crowns import trunk_case

from treestroke.core.grow.crown import Crown, crown_of, pixels_of, world_of


@pytest.fixture
def crown() -> Crown:
    case = trunk_case()
    return crown_of(case.mask, case.envelope, np.array([160.0, 275.0, 0.0]))


def test_world_and_crown_frames_are_inverse() -> None:
    case = trunk_case()
    points = np.random.default_rng(0).normal(size=(20, 3))
    np.testing.assert_allclose(world_of(pixels_of(points, case.camera), case.camera), points, atol=1e-12)


def test_the_grid_has_about_the_asked_number_of_points_all_in_the_foliage(crown: Crown) -> None:
    points = crown.grid(500)
    cells = np.floor(points).astype(int)
    assert 450 <= len(points) <= 550
    assert crown.mask[cells[:, 1], cells[:, 0]].all()


def test_depth_is_bounded_like_width(crown: Crown) -> None:
    reach = crown.radius[160]
    points = np.array([[160.5, 160.5, 0.95 * reach], [160.5, 160.5, 1.05 * reach], [5.0, 160.5, 0.0]])
    assert crown.inside(points).tolist() == [True, False, False]


def test_four_quarter_turns_come_back(crown: Crown) -> None:
    points = np.array([[200.0, 150.5, 30.0], [120.0, 180.5, -50.0]])
    turned = points
    for _ in range(4):
        turned = crown.turned(turned)
    np.testing.assert_allclose(turned, points, atol=1e-9)


def test_what_turns_out_of_the_foliage_is_dropped(crown: Crown) -> None:
    assert len(crown.turned(np.array([[160.0, 160.0, 400.0]]))) == 0


def test_a_unit_is_a_thousandth_of_the_crowns_width(crown: Crown) -> None:
    assert crown.unit == pytest.approx(0.28, rel=0.02)
