import numpy as np
from tests.builders import fork, oak, stick

from treestroke.core.mesh.chains import chains_of, missed_without, subset, thinned


def test_limbs_hold_every_edge_once() -> None:
    tree = oak()
    chains = chains_of(tree, 1e-4)
    steps = np.linalg.norm(np.diff(chains.points, axis=0), axis=1)[np.diff(chains.limb) == 0]
    edges = np.linalg.norm(tree.points[1:] - tree.points[tree.parents[1:]], axis=1)
    assert np.allclose(np.sort(steps), np.sort(edges))


def test_a_branch_knows_its_bearer_and_a_stem_has_none() -> None:
    chains = chains_of(fork(trunk_radius=0.2), 1e-4)
    assert chains.bearer.tolist() == [0.0, 0.2]
    assert np.allclose(chains.bearer_direction, [[0, 1, 0], [0, 1, 0]])


def test_a_branch_starts_with_its_own_radius() -> None:
    chains = chains_of(fork(trunk_radius=0.2, child_radius=0.12), 1e-4)
    assert chains.radii[chains.first].tolist() == [0.2, 0.12]


def test_a_straight_stick_thins_to_its_ends() -> None:
    chains = chains_of(stick(joints=40), 1e-4)
    assert thinned(chains, np.full(40, 0.01)).tolist() == [0, 39]


def test_thinned_limbs_stay_within_the_tolerance() -> None:
    t = np.linspace(0, 2, 60)
    arc = stick(joints=60)
    bent = type(arc)(np.stack([np.cos(t), np.sin(t), 0 * t], axis=1), np.full(60, 0.1), arc.parents)
    chains = chains_of(bent, 1e-4)
    left = subset(chains, thinned(chains, np.full(60, 0.02)))
    middles = (left.points[1:] + left.points[:-1]) / 2
    assert len(left.points) < 15
    assert np.abs(np.hypot(middles[:, 0], middles[:, 1]) - 1).max() < 0.02


def test_what_is_missed_without_a_joint_tells_which_to_keep() -> None:
    points = np.array(
        [[0, 0, 0], [0, 1, 0.1], [1, 2, 0], [0, 3, 0.1], [0, 4, 0], [9, 0, 0], [9, 1, 0], [9, 4, 0]], float
    )
    missed = missed_without(points, np.full(8, 0.1), np.array([0, 0, 0, 0, 0, 1, 1, 1]))
    assert np.isinf(missed).tolist() == [True, False, False, False, True, True, False, True]
    assert missed[2] == 1.0
    assert 0.4 < missed[1] < 0.5
    assert missed[6] == 0.0


def test_a_change_of_radius_is_missed_too() -> None:
    points = np.array([[0, 0, 0], [0, 1, 0], [0, 2, 0]], float)
    assert missed_without(points, np.array([0.3, 0.3, 0.1]), np.zeros(3, np.int64))[1].round(6) == 0.1
