import numpy as np
import pytest

from treestroke.core.trace.visible_foot import visible_foot

HEIGHT, RADIUS = 400.0, 8.0


def wood(foot: int, mulch: int = 0) -> np.ndarray:
    """Return the wood (h, w) of a slightly leaning trunk down to its foot, with so many rows of mulch below."""
    shown = np.zeros((520, 300), dtype=bool)
    for row in range(100, foot):
        middle = 150 + 0.05 * (row - 400)
        shown[row, int(middle - RADIUS) : int(middle + RADIUS)] = True
    shown[foot : foot + mulch, 60:240] = True
    return shown


@pytest.mark.parametrize("mulch", [0, 40])
def test_a_stroke_that_begins_above_the_foot_goes_on_to_it(mulch: int) -> None:
    foot = visible_foot(wood(480, mulch), np.array([150.0, 400.0]), RADIUS, HEIGHT)
    assert foot is not None
    assert foot == pytest.approx([154.0, 480.0], abs=3.0)


def test_a_stroke_from_the_foot_stays_before_mulch_of_the_trunk_s_colour() -> None:
    assert visible_foot(wood(480, 40), np.array([154.0, 480.0]), RADIUS, HEIGHT) is None


def test_a_little_that_is_missing_is_left() -> None:
    assert visible_foot(wood(480), np.array([153.0, 468.0]), RADIUS, HEIGHT) is None


def test_a_stroke_in_the_air_stays() -> None:
    assert visible_foot(np.zeros((520, 300), dtype=bool), np.array([150.0, 400.0]), RADIUS, HEIGHT) is None
