"""A drawn trunk below a crown, on a ground of grass and sky, and a stroke on it or beside it."""

import numpy as np
import pytest
from tests.pictures import noisy

from treestroke.core.trace.trunk_place import ground_before_trunk, way_to_trunk

SIZE, HEIGHT = 400, 360.0
CROWN = np.arange(SIZE)[:, None] < np.full(SIZE, 160)
STROKE = np.array([[200.0, 380.0], [200.0, 270.0], [200.0, 100.0]])


def photo(half: float, middle: float = 200.0, trunk: tuple[int, int, int] = (90, 75, 60)) -> np.ndarray:
    flat = np.zeros((SIZE, SIZE, 3))
    flat[:] = (180, 200, 220)
    flat[300:] = (90, 140, 50)
    flat[:, int(middle - half) : int(middle + half)] = trunk
    flat[CROWN] = (60, 110, 40)
    return noisy(flat)


@pytest.mark.parametrize("half", [3.0, 8.0, 15.0])
@pytest.mark.parametrize("side", [-1, 1], ids=["left", "right"])
def test_a_stroke_beside_its_trunk_by_its_width_finds_it(half: float, side: int) -> None:
    way, is_sure = way_to_trunk(photo(half, 200 + 2 * half * side), STROKE, CROWN, HEIGHT)
    assert is_sure
    assert way == pytest.approx([2 * half * side, 0.0], abs=0.5 * half + 1)


@pytest.mark.parametrize("side", [-1, 1], ids=["left", "right"])
def test_a_trunk_lit_from_one_side_is_found_too(side: int) -> None:
    lit = photo(8, 200 + 16 * side)
    lit[160:, 200 + 16 * side : 208 + 16 * side] += 90
    way, is_sure = way_to_trunk(lit, STROKE, CROWN, HEIGHT)
    assert is_sure
    assert way == pytest.approx([16 * side, 0.0], abs=8)


@pytest.mark.parametrize("half", [3.0, 8.0, 15.0, 40.0])
@pytest.mark.parametrize("aside", [-0.7, 0.0, 0.7])
def test_a_stroke_on_its_trunk_stays(half: float, aside: float) -> None:
    assert not way_to_trunk(photo(half, 200 + aside * half), STROKE, CROWN, HEIGHT)[0].any()


def test_a_stroke_on_the_dark_side_of_a_trunk_stays() -> None:
    striped = photo(15.0)
    striped[160:, 186:192] += 90
    assert not way_to_trunk(striped, STROKE + np.array([4.0, 0.0]), CROWN, HEIGHT)[0].any()


def standing(foot: int, lawn: int) -> np.ndarray:
    """Draw a trunk down to the row ``foot`` on a lawn that begins at the row ``lawn``."""
    flat = photo(8.0).astype(float)
    flat[lawn:], flat[160:lawn] = (90, 140, 50), (180, 200, 220)
    flat[160:foot, 192:208] = (90, 75, 60)
    return noisy(flat)


@pytest.mark.parametrize("before", [15, 30])
def test_a_stroke_that_begins_on_the_ground_before_the_trunk_is_too_long(before: int) -> None:
    length = ground_before_trunk(standing(380 - before, 300), STROKE, CROWN, HEIGHT)
    assert length == pytest.approx(before, abs=6)


def test_a_stroke_from_the_foot_is_not_too_long() -> None:
    assert ground_before_trunk(standing(380, 300), STROKE, CROWN, HEIGHT) == 0


def test_a_foot_that_something_hides_is_none_on_the_ground() -> None:
    assert ground_before_trunk(standing(350, 350), STROKE, CROWN, HEIGHT) == 0


def test_a_pole_far_beside_is_not_taken_for_the_trunk() -> None:
    assert not way_to_trunk(photo(4.0, 230.0), STROKE, CROWN, HEIGHT)[1]


@pytest.mark.parametrize("side", [-1, 1], ids=["left", "right"])
def test_a_stroke_far_beside_what_stands_out_is_doubted(side: int) -> None:
    way, is_sure = way_to_trunk(photo(4.0, 200 + 30 * side), STROKE, CROWN, HEIGHT)
    assert not is_sure
    assert way == pytest.approx([30 * side, 0.0], abs=4)


def test_a_stroke_on_its_trunk_beside_another_one_is_not_doubted() -> None:
    two = photo(8.0)
    two[160:, 228:236] = (20, 20, 20)
    way, is_sure = way_to_trunk(two, STROKE, CROWN, HEIGHT)
    assert is_sure
    assert not way.any()


@pytest.mark.parametrize("stroke", [STROKE[1:] - [0, 150], np.array([[200.0, 200.0], [200.0, 150.0]])[:, :] - [0, 60]])
def test_a_stroke_inside_the_crown_stays(stroke: np.ndarray) -> None:
    assert not way_to_trunk(photo(8.0, 216.0), stroke, CROWN, HEIGHT)[0].any()


def test_where_nothing_stands_out_nothing_moves() -> None:
    assert not way_to_trunk(photo(8.0, 216.0, (180, 200, 220)), STROKE[1:], CROWN, HEIGHT)[0].any()
