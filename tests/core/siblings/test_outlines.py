"""Tests of the outlines that siblings fill."""

import numpy as np
import pytest

from treestroke.core.siblings.outlines import SHAPES, Envelope, fitted


@pytest.mark.parametrize("name", SHAPES)
def test_a_shape_reaches_from_the_crown_s_foot_to_the_tree_s_top(name: str) -> None:
    line = fitted(Envelope(SHAPES[name]), 10.0, 2.5)
    assert line[:, 1].min() == pytest.approx(2.5)
    assert line[:, 1].max() == pytest.approx(10.0)
    assert abs(line[:, 0].min() + line[:, 0].max()) < 0.2


def test_a_shape_on_the_ground_leaves_no_trunk_below() -> None:
    assert fitted(Envelope(SHAPES["triangle"], on_ground=True), 10.0, 2.5)[:, 1].min() == pytest.approx(0.0)


def test_the_trunk_enters_in_the_middle_of_the_lowest_part() -> None:
    leaning = np.array([[0.0, 0.0], [1.0, 0.0], [6.0, -10.0], [5.0, -10.0]])
    line = fitted(Envelope(leaning), 10.0, 2.0)
    lowest = line[line[:, 1] < 2.01, 0]
    assert lowest.mean() == pytest.approx(0.0, abs=0.3)
