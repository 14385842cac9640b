import numpy as np
import pytest

from treestroke.core.geometry.outline_volume import TurnedOutline
from treestroke.core.leaf.daylight import daylight


def column(volume: TurnedOutline, heights: list[float]) -> np.ndarray:
    """Places on the crown's axis at shares of its height."""
    low, high = volume.bounds
    return volume.axis(low[1] + np.array(heights) * (high[1] - low[1]))


def test_light_falls_with_the_foliage_above(volume):
    light = daylight(volume).at(column(volume, [0.02, 0.25, 0.5, 0.75, 0.98]))
    assert (np.diff(light) > 0).all()
    assert light[0] < 0.15
    assert light[-1] > 0.8


def test_the_outside_gets_more_light_than_the_axis_and_all_sides_get_as_much(volume):
    light, middle = daylight(volume), column(volume, [0.5])
    out = 0.9 * float(volume.half_width(middle[:, 1])[0])
    sides = light.at(middle + out * np.array([[1, 0, 0], [-1, 0, 0], [0, 0, 1], [0, 0, -1]]))
    assert sides.min() > light.at(middle)[0] + 0.1
    assert sides == pytest.approx(np.full(4, sides.mean()), abs=0.05)


def test_foliage_to_one_side_above_hides_that_side_alone(volume):
    low, high = volume.bounds
    beneath = np.array([[0.5 * (low[0] + high[0]), low[1] + 0.1, high[2]]])
    edge = daylight(volume).at(beneath)[0]
    assert daylight(volume).at(column(volume, [0.05]))[0] < edge < 0.9
