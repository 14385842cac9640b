import numpy as np
import pytest
from hypothesis import given
from tests.builders import fork, oak, stick
from tests.strategies import skeletons

from treestroke.core.skeleton.measure import edge_lengths, generations, path_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import heaviest_children


def test_a_stick_s_edges_are_equal() -> None:
    assert edge_lengths(stick(5, height=4.0)).tolist() == [0.0, 1.0, 1.0, 1.0, 1.0]


def test_a_way_up_a_fork_is_the_sum_of_its_edges() -> None:
    assert path_lengths(fork()) == pytest.approx([0.0, 1.0, 2.0, 2.8, 3.6, 2.8, 3.6])


@given(skeletons())
def test_a_way_grows_by_its_last_edge(tree: Skeleton) -> None:
    ways, edges = path_lengths(tree), edge_lengths(tree)
    grown = tree.parents >= 0
    assert ways[grown] == pytest.approx((ways[tree.parents] + edges)[grown])
    assert (ways[~grown] == 0).all()


@given(skeletons(dimensions=2))
def test_no_way_is_shorter_than_the_straight_line_to_its_root(tree: Skeleton) -> None:
    root = np.arange(len(tree))
    for joint in range(len(tree)):
        root[joint] = joint if tree.parents[joint] < 0 else root[tree.parents[joint]]
    assert (path_lengths(tree) >= np.linalg.norm(tree.points - tree.points[root], axis=1) - 1e-9).all()


def test_a_fork_s_side_is_of_the_next_generation() -> None:
    tree = fork()
    assert generations(tree, heaviest_children(tree, tree.radii)).tolist() == [0, 0, 0, 0, 0, 1, 1]


@given(skeletons())
def test_a_generation_rises_by_one_off_the_limb_and_not_along_it(tree: Skeleton) -> None:
    successors = heaviest_children(tree, tree.radii)
    order = generations(tree, successors)
    for joint, parent in enumerate(tree.parents.tolist()):
        assert order[joint] == (0 if parent < 0 else order[parent] + (successors[parent] != joint))


def test_an_oak_of_four_orders_has_generations_up_to_three() -> None:
    tree = oak(orders=4)
    order = generations(tree, heaviest_children(tree, tree.radii))
    assert set(order.tolist()) == {0, 1, 2, 3}
