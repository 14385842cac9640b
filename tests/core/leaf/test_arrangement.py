import numpy as np
import pytest

from treestroke.core.leaf.arrangement import seats_along
from treestroke.core.skeleton.skeleton import Skeleton

FORK = Skeleton(np.array([[0.0, 0, 0], [0, 2, 0], [4, 2, 0]]), np.array([0.2, 0.1, 0.1]), np.array([-1, 0, 1]))


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_seats_are_spread_over_a_whole_edge_whatever_its_weight(scale):
    seats = seats_along(FORK, scale * np.array([1.0, 0.0, 1.0]), 400, np.random.default_rng(0))
    assert (seats.joints == 2).all()
    assert np.histogram(seats.points[:, 0], 4, (0, 4))[0].tolist() == pytest.approx([100] * 4, abs=1)


def test_an_edge_has_as_many_seats_as_its_length_times_its_weight_asks():
    seats = seats_along(FORK, np.array([1.0, 3.0, 0.5]), 800, np.random.default_rng(0))
    assert np.bincount(seats.joints).tolist() == pytest.approx([0, 600, 200], abs=1)


def test_no_weight_gives_no_seats():
    assert len(seats_along(FORK, np.zeros(3), 10, np.random.default_rng(0))) == 0
