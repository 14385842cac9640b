import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.builders import fork, oak, stick

from treestroke.core.grow.radii import pipe_counts, pipe_radii, radii_of_pipes
from treestroke.core.skeleton.skeleton import Skeleton


def bare(skeleton: Skeleton) -> np.ndarray:
    return np.where(np.arange(len(skeleton)) == 0, skeleton.radii[0], 0.0)


def test_pipes_at_a_joint_are_those_of_its_children_and_their_edges() -> None:
    tree = fork()
    pipes = pipe_counts(tree, twig=2.0)
    assert pipes[[4, 6]] == pytest.approx(1.0)
    assert pipes[2] == pytest.approx(2 + 4 * 0.8 / 2)


def test_radii_to_the_exponent_sum_up_at_a_fork() -> None:
    tree = oak()
    pipes = pipe_counts(tree, twig=1e9)
    radii = radii_of_pipes(pipes, 0.25, 0.01)
    exponent = np.log(pipes[0]) / np.log(0.25 / 0.01)
    exponent = np.clip(exponent, 1.8, 3.0)
    total = np.zeros(len(tree))
    np.add.at(total, tree.parents[1:], radii[1:] ** exponent)
    inner = total > 0
    np.testing.assert_allclose(radii[inner] ** exponent, total[inner], rtol=1e-6)


@given(st.floats(0.05, 2.0), st.floats(0.001, 0.04), st.integers(2, 4), st.integers(0, 20))
def test_no_child_is_thicker_than_its_parent(base: float, tip: float, orders: int, seed: int) -> None:
    tree = oak(orders, seed)
    measured = np.where(np.arange(len(tree)) < 20, np.linspace(base, base / 4, len(tree)), 0.0)
    radii = pipe_radii(tree.points, tree.parents, measured, tip)
    assert (radii[1:] <= radii[tree.parents[1:]]).all()
    assert (radii > 0).all()


def test_the_base_keeps_its_measured_radius() -> None:
    tree = oak()
    assert pipe_radii(tree.points, tree.parents, bare(tree), 0.004)[0] == pytest.approx(0.25)


def test_twigs_end_in_the_asked_radius() -> None:
    tree = oak(5)
    measured = bare(tree) * 0.4
    radii = pipe_radii(tree.points, tree.parents, measured, 0.01)
    assert radii.min() == pytest.approx(0.01, rel=0.01)


def test_measured_radii_are_kept_away_from_a_limbs_end() -> None:
    tree = stick(joints=41)
    radii = pipe_radii(tree.points, tree.parents, tree.radii, 0.01)
    np.testing.assert_allclose(radii[:26], tree.radii[:26])
    assert radii[-1] < 0.6 * tree.radii[-1]
