"""A measured crown as a volume: cells by hand."""

import numpy as np
import pytest

from treestroke.core.geometry.clumped_crown import Cells
from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.geometry.measured_crown import MeasuredCrown
from treestroke.core.types import Mask

SIDE = 0.1
CORNER = np.array([-2.0, 1.0, -2.0])


def crown_of(filled: Mask) -> MeasuredCrown:
    around = np.pad(filled, 1)[2:, 1:-1, 1:-1] | filled
    density = np.where(filled, 2.0, 0.0).astype(np.float32)
    guessed = np.zeros_like(filled)
    guessed[:, :, :20] = filled[:, :, :20]
    return MeasuredCrown(Cells(filled, CORNER, SIDE), density, around, around, guessed)


def drum(radius: float, middle_x: float = 0.0) -> MeasuredCrown:
    """An upright drum from 1.5 to 3.5 m about a level place."""
    x, y, z = np.moveaxis(CORNER + SIDE * (np.indices((40, 30, 40)).transpose(1, 2, 3, 0) + 0.5), -1, 0)
    return crown_of((np.hypot(x - middle_x, z) <= radius) & (y > 1.5) & (y < 3.5))


def test_it_is_a_crown_volume_that_was_seen() -> None:
    volume: CrownVolume = drum(1.0)
    assert volume.depth_seen
    assert "10 cm" in volume.shape


def test_a_drum_measures_as_one() -> None:
    crown = drum(1.0)
    np.testing.assert_allclose(crown.bounds, [[-1.0, 1.5, -1.0], [1.0, 3.5, 1.0]], atol=0.06)
    assert crown.widest == pytest.approx(1.0, abs=0.06)
    assert crown.front_area == pytest.approx(4.0, rel=0.06)
    assert crown.cubic_metres == pytest.approx(2 * np.pi, rel=0.05)
    heights = np.array([0.9, 2.5, 3.9])
    np.testing.assert_allclose(crown.half_width(heights), [0.0, 1.0, 0.0], atol=0.06)
    points = np.array([[0.05, 2.5, 0.3], [0.75, 2.5, 0.0], [1.5, 2.5, 0.0], [0.0, 1.2, 0.0], [9.0, 9.0, 9.0]])
    np.testing.assert_allclose(crown.half_depth(points), [1.0, 0.66, 0.0, 0.0, 0.0], atol=0.06)


def test_reach_is_0_on_the_axis_and_1_on_the_surface() -> None:
    crown = drum(0.8, middle_x=0.5)
    np.testing.assert_allclose(crown.axis(np.array([2.0, 9.0])), [[0.5, 2.0, 0.0], [0.5, 9.0, 0.0]], atol=1e-6)
    turn = np.linspace(0, 2 * np.pi, 50)
    around = np.stack([0.5 + 0.8 * np.sin(turn), np.full(50, 2.5), 0.8 * np.cos(turn)], axis=1)
    np.testing.assert_allclose(crown.reach(around), 1.0, atol=0.08)
    assert crown.reach(np.array([[0.5, 2.5, 0.0]]))[0] == pytest.approx(0.0, abs=0.01)
    assert (crown.reach(np.array([[0.5, 1.2, 0.0], [0.5, 4.0, 0.0]])) > 100).all()


def test_reach_follows_a_lobe() -> None:
    x, y, z = np.moveaxis(CORNER + SIDE * (np.indices((40, 30, 40)).transpose(1, 2, 3, 0) + 0.5), -1, 0)
    lobe = (np.abs(z) < 0.4) & (np.abs(x) < 1.6)
    crown = crown_of(((np.hypot(x, z) <= 0.6) | lobe) & (y > 1.5) & (y < 3.5))
    reach = crown.reach(np.array([[1.2, 2.5, 0.0], [0.0, 2.5, 1.2]]))
    assert reach[0] < 1 < reach[1]


def test_cells_tell_what_is_inside_and_how_dense() -> None:
    crown = drum(1.0)
    points = np.array([[0.0, 2.5, 0.0], [0.9, 2.5, 0.0], [-1.05, 2.5, 0.0], [1.05, 2.5, 0.0], [0.0, 50.0, 0.0]])
    assert crown.inside(points).tolist() == [True, True, False, False, False]
    assert crown.admits(points).tolist() == [True, True, True, False, False]
    assert crown.shown(points).tolist() == [True, True, True, False, False]
    assert crown.density_at(points).tolist() == [2.0, 2.0, 0.0, 0.0, 0.0]
    assert crown.guessed_at(np.array([[0.0, 2.5, -0.5], [0.0, 2.5, 0.5]])).tolist() == [True, False]
    assert crown.inside(crown.middles).all()
    assert (crown.densities == 2).all()


def test_an_empty_crown_and_grids_of_other_shapes_are_refused() -> None:
    with pytest.raises(ValueError, match="empty"):
        crown_of(np.zeros((4, 4, 40), dtype=bool))
    crown = drum(1.0)
    with pytest.raises(ValueError, match="shape"):
        MeasuredCrown(crown.cells, crown.density[1:], crown.around, crown.hull, crown.guessed)
