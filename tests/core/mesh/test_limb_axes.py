import numpy as np
from tests.builders import fork, oak, stick

from treestroke.core.mesh.limb_axes import limb_axes, removal_errors, simplified, subset


def test_limbs_contain_every_edge_once() -> None:
    tree = oak()
    axes = limb_axes(tree, 1e-4)
    steps = np.linalg.norm(np.diff(axes.points, axis=0), axis=1)[np.diff(axes.limb) == 0]
    edges = np.linalg.norm(tree.points[1:] - tree.points[tree.parents[1:]], axis=1)
    assert np.allclose(np.sort(steps), np.sort(edges))


def test_a_branch_has_a_parent_radius_and_a_stem_has_none() -> None:
    axes = limb_axes(fork(trunk_radius=0.2), 1e-4)
    assert axes.parent_radius.tolist() == [0.0, 0.2]
    assert np.allclose(axes.parent_direction, [[0, 1, 0], [0, 1, 0]])


def test_a_branch_starts_with_its_own_radius() -> None:
    axes = limb_axes(fork(trunk_radius=0.2, child_radius=0.12), 1e-4)
    assert axes.radii[axes.first].tolist() == [0.2, 0.12]


def test_a_straight_stick_is_simplified_to_its_ends() -> None:
    axes = limb_axes(stick(joints=40), 1e-4)
    assert simplified(axes, np.full(40, 0.01)).tolist() == [0, 39]


def test_simplified_axes_stay_within_the_tolerance() -> None:
    t = np.linspace(0, 2, 60)
    arc = stick(joints=60)
    bent = type(arc)(np.stack([np.cos(t), np.sin(t), 0 * t], axis=1), np.full(60, 0.1), arc.parents)
    axes = limb_axes(bent, 1e-4)
    left = subset(axes, simplified(axes, np.full(60, 0.02)))
    middles = (left.points[1:] + left.points[:-1]) / 2
    assert len(left.points) < 15
    assert np.abs(np.hypot(middles[:, 0], middles[:, 1]) - 1).max() < 0.02


def test_removal_errors_rank_the_points_of_a_limb() -> None:
    points = np.array(
        [[0, 0, 0], [0, 1, 0.1], [1, 2, 0], [0, 3, 0.1], [0, 4, 0], [9, 0, 0], [9, 1, 0], [9, 4, 0]], float
    )
    errors = removal_errors(points, np.full(8, 0.1), np.array([0, 0, 0, 0, 0, 1, 1, 1]))
    assert np.isinf(errors).tolist() == [True, False, False, False, True, True, False, True]
    assert errors[2] == 1.0
    assert 0.4 < errors[1] < 0.5
    assert errors[6] == 0.0


def test_a_change_of_radius_is_an_error_too() -> None:
    points = np.array([[0, 0, 0], [0, 1, 0], [0, 2, 0]], float)
    assert removal_errors(points, np.array([0.3, 0.3, 0.1]), np.zeros(3, np.int64))[1].round(6) == 0.1
