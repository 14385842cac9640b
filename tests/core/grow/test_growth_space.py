import numpy as np
import pytest
from tests.core.grow.crowns import trunk_case
from tests.core.grow.sketched import CAMERA
from tests.core.grow.sketched import crown as flat_crown

from treestroke.core.grow.growth_space import GrowthSpace, pixel_frame


@pytest.fixture
def crown() -> GrowthSpace:
    return trunk_case().space()


def test_world_and_crown_frames_are_inverse() -> None:
    frame = trunk_case().frame
    points = np.random.default_rng(0).normal(size=(20, 3))
    np.testing.assert_allclose(frame.world_of(frame.pixels_of(points)), points, atol=1e-12)


def test_a_crown_that_is_not_as_deep_as_wide_is_round_in_the_frame() -> None:
    volume = flat_crown(off=15.0)
    frame, angle = pixel_frame(volume, CAMERA), np.linspace(0, 2 * np.pi, 9)
    centre = volume.axis(np.full(9, 5.6))
    surface = centre + np.stack([1.8 * np.cos(angle), 0 * angle, 1.5 * np.sin(angle)], axis=1)
    in_frame = frame.pixels_of(surface)
    assert np.hypot(in_frame[:, 0] - 160, in_frame[:, 2]) == pytest.approx(np.full(9, 90.0), rel=0.02)
    np.testing.assert_allclose(frame.world_of(in_frame), surface, atol=1e-12)


def test_the_grid_has_about_the_asked_number_of_points_all_in_the_foliage(crown: GrowthSpace) -> None:
    points = crown.grid(500)
    cells = np.floor(points).astype(int)
    assert 450 <= len(points) <= 550
    assert crown.mask[cells[:, 1], cells[:, 0]].all()


def test_depth_is_bounded_like_width(crown: GrowthSpace) -> None:
    reach = crown.radius[160]
    points = np.array([[160.5, 160.5, 0.95 * reach], [160.5, 160.5, 1.05 * reach], [5.0, 160.5, 0.0]])
    assert crown.inside(points).tolist() == [True, False, False]


def test_four_quarter_turns_come_back(crown: GrowthSpace) -> None:
    points = np.array([[200.0, 150.5, 30.0], [120.0, 180.5, -50.0]])
    turned = points
    for _ in range(4):
        turned = crown.turned(turned)
    np.testing.assert_allclose(turned, points, atol=1e-9)


def test_what_turns_out_of_the_foliage_is_dropped(crown: GrowthSpace) -> None:
    assert len(crown.turned(np.array([[160.0, 160.0, 400.0]]))) == 0


def test_a_unit_is_a_thousandth_of_the_crowns_width(crown: GrowthSpace) -> None:
    assert crown.unit == pytest.approx(0.28, rel=0.02)
