"""Tests of the bifurcations that a tree is split into."""

import numpy as np
import pytest
from tests.builders import fork, oak, stick

from treestroke.core.siblings.bifurcations import bifurcations


def test_a_fork_is_one_bifurcation_with_its_angles_lengths_and_radii() -> None:
    found = bifurcations(fork(angle_rad=0.7))
    assert found.order.tolist() == [1]
    assert found.angles_rad[0] == pytest.approx([np.pi, 0.7, np.pi - 0.7], abs=1e-6)
    assert found.lengths[0] == pytest.approx([2.0, 1.6, 1.6])
    assert found.rise[0] == pytest.approx(np.cos(0.7))
    assert found.radius_ratio[0] == pytest.approx(0.12 / 0.2)


def test_a_stick_has_a_stem_and_no_bifurcation() -> None:
    found = bifurcations(stick())
    assert len(found.order) == 0
    assert [limb.order for limb in found.limbs] == [0]


def test_each_fork_of_three_is_two_bifurcations() -> None:
    found = bifurcations(oak(orders=2))
    assert np.bincount(found.order).tolist() == [0, 2]


def test_short_limbs_are_left_to_growth() -> None:
    tree = oak(orders=4)
    limbs = bifurcations(tree).limbs
    height = float(np.ptp(tree.points[:, 1]))
    lengths = [np.linalg.norm(np.diff(limb.points, axis=0), axis=1).sum() for limb in limbs if limb.order]
    assert min(lengths) >= 0.04 * height
