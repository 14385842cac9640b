"""A trunk before a ground of two colours, one of them much like its own."""

import cv2
import numpy as np
import pytest

from treestroke.core.geometry.polyline import resample
from treestroke.core.trace.stem_sides import bare_stem, joined, sides_seen

TRUNK = resample(np.array([[100.0, 390.0], [110.0, 200.0], [112.0, 40.0]]), 2.5)
RADIUS, SHARED, SKY, BARK = 8.0, (78, 74, 66), (150, 180, 220), (70, 60, 50)


def photo(trunk: bool = True) -> np.ndarray:
    """Sky above, and below it a wood with nearly the colours of the bark and a darker stem beside the trunk."""
    picture = np.full((400, 240, 3), SKY, dtype=np.uint8)
    picture[220:] = SHARED
    if trunk:
        cv2.polylines(picture, [TRUNK.astype(np.int32)], False, BARK, int(2 * RADIUS))
    noise = np.random.default_rng(1).normal(0, 3, picture.shape)
    return np.clip(picture + noise, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("wave", [0.0, 4.0])
@pytest.mark.parametrize("beside", [-4.0, 0.0, 4.0])
def test_the_line_is_in_the_middle_of_the_trunk_however_the_hand_shook(beside: float, wave: float) -> None:
    hand = TRUNK + np.outer(beside + wave * np.sin(np.arange(len(TRUNK)) / 9), [1.0, 0.0])
    line, halves = bare_stem(hand, photo(), RADIUS, RADIUS + 6)
    assert np.abs(line - TRUNK)[4:-4, 0].max() < 1.5
    assert np.nanmedian(halves) == pytest.approx(RADIUS, abs=0.8)


def test_a_wrong_guess_of_the_width_is_put_right() -> None:
    for guess in (0.7 * RADIUS, 1.5 * RADIUS):
        _, halves = bare_stem(TRUNK, photo(), guess, 2 * RADIUS)
        assert np.nanmedian(halves) == pytest.approx(RADIUS, abs=0.8)


def test_a_stroke_over_nothing_stays_nearly_where_it_was_drawn() -> None:
    line, _ = bare_stem(TRUNK, photo(trunk=False), RADIUS, RADIUS + 6)
    assert np.abs(line - TRUNK)[:, 0].max() < 0.75 * RADIUS


def test_widths_are_unknown_where_a_hedge_stands_before_the_trunk() -> None:
    hidden = photo()
    hidden[300:] = SHARED
    _, halves = bare_stem(TRUNK, hidden, RADIUS, RADIUS + 6)
    low = TRUNK[:, 1] > 320
    assert np.isnan(halves[low]).all()
    assert not np.isnan(halves[TRUNK[:, 1] < 200]).any()


def test_both_sides_are_clear_where_a_trunk_stands_before_the_sky() -> None:
    above = TRUNK[TRUNK[:, 1] < 200]
    assert sides_seen(above, photo(), RADIUS, RADIUS + 6) > 0.9
    assert sides_seen(above, photo(trunk=False), RADIUS, RADIUS + 6) < 0.1


def test_a_line_turns_into_another_one_without_a_jump() -> None:
    line = np.column_stack([np.zeros(40), -np.arange(40.0)])
    both = joined(line[:20] + np.array([6.0, 0.0]), line)
    assert both[0, 0] == 6.0
    assert np.array_equal(both[20:], line[20:])
    assert np.abs(np.diff(both[:, 0])).max() < 2.0
