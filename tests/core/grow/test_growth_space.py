import numpy as np
import pytest
from tests.core.grow.crowns import trunk_case
from tests.core.grow.sketched import CAMERA
from tests.core.grow.sketched import crown as flat_crown

from treestroke.core.grow.growth_space import GrowthSpace, growth_space


@pytest.fixture
def crown() -> GrowthSpace:
    return trunk_case().space()


def test_a_crown_may_be_less_deep_than_wide_and_stand_before_its_stem() -> None:
    volume = flat_crown(off=15.0)
    space, angle = growth_space(volume, volume.silhouettes[0], np.zeros(3)), np.linspace(0, 2 * np.pi, 9)
    surface = volume.axis(np.full(9, 5.6)) + np.stack([1.8 * np.cos(angle), 0 * angle, 1.5 * np.sin(angle)], axis=1)
    assert space.reach(CAMERA.picture_space_from_world(surface)) == pytest.approx(np.full(9, 1.0), rel=0.02)


def test_what_attracts_in_space_is_all_over_the_volume(crown: GrowthSpace) -> None:
    assert crown.inside(crown.depths).mean() > 0.98
    assert np.abs(crown.depths.mean(axis=0) - [160, 160, 0]).max() < 5


def test_the_grid_has_about_the_asked_number_of_points_all_in_the_foliage(crown: GrowthSpace) -> None:
    points = crown.grid(500)
    cells = np.floor(points).astype(int)
    assert 450 <= len(points) <= 550
    assert crown.mask[cells[:, 1], cells[:, 0]].all()


def test_depth_is_bounded_like_width(crown: GrowthSpace) -> None:
    reach = crown.sections.radius_px[160]
    points = np.array([[160.5, 160.5, 0.95 * reach], [160.5, 160.5, 1.05 * reach], [5.0, 160.5, 0.0]])
    assert crown.inside(points).tolist() == [True, False, False]


def test_a_unit_is_a_thousandth_of_the_crowns_width(crown: GrowthSpace) -> None:
    assert crown.unit == pytest.approx(0.28, rel=0.02)
