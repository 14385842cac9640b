import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from treestroke.core.imaging.outline import fill_outline, filled_and_crossing, rings_of_mask, winding_numbers

SQUARE = np.array([[10.0, 10.0], [30.0, 10.0], [30.0, 30.0], [10.0, 30.0]])
EIGHT = np.array([[10.0, 10.0], [30.0, 30.0], [30.0, 10.0], [10.0, 30.0]])


def disc(radius: float, size: int = 80) -> np.ndarray:
    y, x = np.mgrid[:size, :size] + 0.5
    return np.hypot(x - size / 2, y - size / 2) < radius


def even_odd(rings: list[np.ndarray], height: int, width: int) -> np.ndarray:
    return sum((winding_numbers(r, height, width) for r in rings), np.zeros((height, width), int)) % 2 == 1


def test_a_square_fills_the_pixels_whose_centres_it_holds() -> None:
    mask = fill_outline(SQUARE, 40, 50)
    assert mask.sum() == 400
    assert mask[10:30, 10:30].all()


@given(st.permutations(range(4)))
def test_the_fill_does_not_depend_on_where_a_loop_begins(order: list[int]) -> None:
    start = order[0]
    assert np.array_equal(fill_outline(np.roll(SQUARE, start, axis=0), 40, 40), fill_outline(SQUARE[::-1], 40, 40))


def test_both_loops_of_an_eight_are_filled() -> None:
    mask = fill_outline(EIGHT, 40, 40)
    assert mask[20, 12]
    assert mask[20, 28]
    assert not mask[12, 20]


def test_two_laps_fill_what_one_does() -> None:
    assert np.array_equal(fill_outline(np.vstack([SQUARE, SQUARE]), 40, 40), fill_outline(SQUARE, 40, 40))


def test_loops_that_turn_against_each_other_are_one_union() -> None:
    other = np.array([[20.0, 20.0], [20.0, 38.0], [38.0, 38.0], [38.0, 20.0]])
    joined = np.vstack([SQUARE, SQUARE[:1], other, other[:1]])
    union = fill_outline(SQUARE, 40, 40) | fill_outline(other, 40, 40)
    assert fill_outline(joined, 40, 40)[union].all()


@pytest.mark.parametrize(
    ("points", "crosses"), [(SQUARE, False), (SQUARE[::-1], False), (EIGHT, True), (np.vstack([SQUARE, SQUARE]), True)]
)
def test_crossing_is_found(points: np.ndarray, crosses: bool) -> None:
    assert filled_and_crossing(points, 40, 40)[1] is crosses


def test_a_point_outside_the_picture_does_no_harm() -> None:
    assert fill_outline(SQUARE - 20, 40, 40).sum() == 100


def test_rings_follow_a_mask_with_a_hole_by_the_even_odd_rule() -> None:
    mask = disc(30) & ~disc(12)
    rings = rings_of_mask(mask)
    filled = even_odd(rings, *mask.shape)
    assert len(rings) == 2
    assert (filled & mask).sum() / (filled | mask).sum() > 0.95


def test_an_empty_mask_has_no_rings() -> None:
    assert rings_of_mask(np.zeros((20, 20), dtype=bool)) == []
