import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import isotonic_regression
from tests.pictures import disc, wood_mask, wood_photo

from treestroke.core.geometry.polyline import resample
from treestroke.core.trace.thickness import half_widths, non_increasing, to_edges

UPRIGHT = resample(np.array([[100.0, 180.0], [100.0, 20.0]]), 4.0)
ASLANT = resample(np.array([[40.0, 170.0], [150.0, 30.0]]), 4.0)


def bar(line: np.ndarray, thickness: float) -> np.ndarray:
    return wood_mask([(line, thickness)], 200, 200)


def band(line: np.ndarray, thickness: float) -> np.ndarray:
    """Return the pixels whose centres lie in an endless straight band about a line."""
    y, x = np.mgrid[:200, :200] + 0.5
    way = line[-1] - line[0]
    away = (x - line[0, 0]) * -way[1] + (y - line[0, 1]) * way[0]
    return np.abs(away) < thickness / 2 * np.hypot(*way)


@pytest.mark.parametrize("thickness", [4.0, 6.0, 10.0, 17.0, 30.0])
@pytest.mark.parametrize("line", [UPRIGHT, ASLANT], ids=["upright", "aslant"])
def test_a_band_s_half_width_is_measured_without_bias(line: np.ndarray, thickness: float) -> None:
    shifted = [line + np.array([shift, 0.0]) for shift in np.linspace(0.0, 1.0, 11)]
    widths = [np.median(half_widths(moved, band(moved, thickness), 25.0)[0]) for moved in shifted]
    assert np.mean(widths) == pytest.approx(thickness / 2, abs=0.2)


@pytest.mark.parametrize("aside", [-3.0, 2.0, 5.0])
def test_the_offset_leads_to_the_bar_s_middle(aside: float) -> None:
    _, offsets = half_widths(UPRIGHT - np.array([aside, 0.0]), bar(UPRIGHT, 16.0), 20.0)
    assert np.median(offsets[5:-5]) == pytest.approx(aside, abs=0.75)


def test_a_bar_that_tapers_is_measured_along_its_length() -> None:
    y, x = np.mgrid[:200, :200] + 0.5
    wood = np.abs(x - 100) < 4 + 8 * y / 200
    widths, _ = half_widths(UPRIGHT, wood, 20.0)
    assert widths == pytest.approx(4 + 8 * UPRIGHT[:, 1] / 200, abs=1.0)


def test_a_run_wider_than_a_branch_can_be_is_not_seen() -> None:
    widths, offsets = half_widths(UPRIGHT, disc(200, 95), 12.0)
    assert np.isnan(widths).all()
    assert np.isnan(offsets).all()


def test_no_wood_is_not_seen() -> None:
    assert np.isnan(half_widths(UPRIGHT, np.zeros((200, 200), dtype=bool), 12.0)[0]).all()


def test_a_speck_one_pixel_wide_does_not_cut_a_bar() -> None:
    wood = bar(UPRIGHT, 16.0)
    wood[:, 103] = False
    assert np.median(half_widths(UPRIGHT, wood, 20.0)[0]) == pytest.approx(8.0, abs=0.75)


def test_a_single_wrong_measure_is_replaced_by_its_neighbours_median() -> None:
    wood = bar(UPRIGHT, 12.0)
    wood[95:103, :106] = True
    assert np.nanmax(half_widths(UPRIGHT, wood, 30.0)[0][5:-5]) < 7.0


def test_a_long_hidden_part_is_not_measured() -> None:
    wood = bar(UPRIGHT, 12.0)
    wood[20:90] = False
    widths, _ = half_widths(UPRIGHT, wood, 20.0)
    assert np.isnan(widths[UPRIGHT[:, 1] < 60]).all()
    assert not np.isnan(widths[UPRIGHT[:, 1] > 110]).any()


def test_twigs_that_cross_a_limb_on_one_side_or_the_other_do_not_widen_it() -> None:
    twigs = [([(100.0, y), (100.0 + side * 60.0, y - 20.0)], 9.0) for y, side in [(60, 1), (95, -1), (130, 1)]]
    wood = bar(UPRIGHT, 16.0) | wood_mask(twigs, 200, 200)
    assert np.median(half_widths(UPRIGHT, wood, 30.0)[0]) == pytest.approx(8.0, abs=1.0)


@pytest.mark.parametrize("told", [12.0, 20.0])
def test_sides_that_colours_tell_wrongly_move_to_the_edges_in_the_photo(told: float) -> None:
    photo = wood_photo(bar(UPRIGHT, 16.0))
    widths, middles = to_edges(UPRIGHT, half_widths(UPRIGHT, bar(UPRIGHT, told), 20.0), photo, 20.0)
    assert widths == pytest.approx(8.0, abs=0.6)
    assert middles == pytest.approx(0.0, abs=0.6)


def test_where_no_wood_is_seen_no_edge_is() -> None:
    wood = bar(UPRIGHT, 16.0)
    wood[20:120] = False
    widths, _ = to_edges(UPRIGHT, half_widths(UPRIGHT, wood, 20.0), wood_photo(bar(UPRIGHT, 16.0)), 20.0)
    assert np.isnan(widths[UPRIGHT[:, 1] < 60]).all()


@given(st.lists(st.floats(0.5, 60.0), min_size=1, max_size=40))
def test_non_increasing_values_are_those_of_isotonic_regression(values: list[float]) -> None:
    nearest = isotonic_regression(values, increasing=False).x
    assert non_increasing(np.array(values)) == pytest.approx(nearest)
