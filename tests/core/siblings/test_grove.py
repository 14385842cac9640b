"""Tests of where the trees of a grove stand."""

import numpy as np
import pytest

from treestroke.core.siblings.grove import crown_radius, plant


def test_no_crown_reaches_into_another() -> None:
    radii = np.array([3.0, 2.0, 4.5])
    grove = plant(radii, 40, np.random.default_rng(0))
    apart = np.hypot(*(grove.places[:, None] - grove.places).transpose(2, 0, 1))
    least = radii[grove.tree][:, None] + radii[grove.tree]
    assert (apart + np.where(np.eye(40) > 0, np.inf, 0) >= least - 1e-9).all()


def test_a_grove_is_dense() -> None:
    radii = np.full(5, 2.0)
    grove = plant(radii, 60, np.random.default_rng(0))
    reach = float(np.hypot(*grove.places.T).max()) + 2.0
    assert 60 * 2.0**2 / reach**2 > 0.45


def test_every_tree_stands_once_before_one_stands_again_turned() -> None:
    grove = plant(np.full(4, 1.0), 10, np.random.default_rng(0))
    assert grove.tree.tolist() == [0, 1, 2, 3, 0, 1, 2, 3, 0, 1]
    assert (grove.turns_rad[:4] == 0).all()
    assert (grove.turns_rad[4:] != 0).all()


def test_two_hundred_trees_find_a_place() -> None:
    assert len(plant(np.array([1.0, 6.0]), 200, np.random.default_rng(1)).places) == 200


def test_a_grove_needs_trees() -> None:
    with pytest.raises(ValueError, match="needs trees"):
        plant(np.array([]), 3, np.random.default_rng(0))


def test_a_single_twig_does_not_widen_a_crown() -> None:
    points = np.zeros((1000, 3))
    points[:, 0] = 2.0
    points[0, 0] = 9.0
    assert crown_radius(points) == pytest.approx(2.0)
