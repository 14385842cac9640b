from itertools import pairwise

import numpy as np
from hypothesis import given
from tests.builders import fork, oak, stick
from tests.strategies import skeletons, weighed_skeletons

from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, child_counts, children, heaviest_children, limbs


@given(skeletons())
def test_each_joint_but_a_root_is_its_parent_s_child_once(tree: Skeleton) -> None:
    listed = [(child, parent) for parent, offspring in enumerate(children(tree)) for child in offspring]
    assert sorted(listed) == [(j, p) for j, p in enumerate(tree.parents.tolist()) if p >= 0]


@given(skeletons())
def test_children_ascend_and_are_counted(tree: Skeleton) -> None:
    listed = children(tree)
    assert all(offspring == sorted(offspring) for offspring in listed)
    assert child_counts(tree).tolist() == [len(offspring) for offspring in listed]


@given(skeletons())
def test_ones_accumulate_to_the_number_of_descendants(tree: Skeleton) -> None:
    listed = children(tree)

    def size(joint: int) -> int:
        return 1 + sum(size(child) for child in listed[joint])

    assert accumulate_to_root(tree, np.ones(len(tree))).tolist() == [size(joint) for joint in range(len(tree))]


@given(weighed_skeletons())
def test_the_roots_hold_the_whole_sum(drawn: tuple[Skeleton, np.ndarray]) -> None:
    tree, weights = drawn
    given = weights.copy()
    total = accumulate_to_root(tree, weights)
    assert total[tree.parents < 0].sum() == weights.sum()
    assert np.array_equal(weights, given)


@given(weighed_skeletons())
def test_the_heaviest_child_is_the_first_of_greatest_weight(drawn: tuple[Skeleton, np.ndarray]) -> None:
    tree, weights = drawn
    best = [max(offspring, key=lambda c: (weights[c], -c)) if offspring else -1 for offspring in children(tree)]
    assert heaviest_children(tree, weights).tolist() == best


@given(weighed_skeletons())
def test_limbs_hold_every_edge_once(drawn: tuple[Skeleton, np.ndarray]) -> None:
    tree, weights = drawn
    found = limbs(tree, heaviest_children(tree, weights))
    edges = [(int(a), int(b)) for limb in found for a, b in pairwise(limb)]
    assert sorted(edges) == sorted((p, j) for j, p in enumerate(tree.parents.tolist()) if p >= 0)


@given(weighed_skeletons())
def test_each_limb_follows_the_successors_to_a_tip(drawn: tuple[Skeleton, np.ndarray]) -> None:
    tree, weights = drawn
    successors = heaviest_children(tree, weights)
    for limb in limbs(tree, successors):
        own = limb if tree.parents[limb[0]] < 0 and (len(limb) == 1 or successors[limb[0]] == limb[1]) else limb[1:]
        assert successors[own].tolist() == [*own[1:].tolist(), -1]


def test_a_stick_is_one_limb() -> None:
    tree = stick()
    assert [limb.tolist() for limb in limbs(tree, heaviest_children(tree, np.ones(5)))] == [[0, 1, 2, 3, 4]]


def test_a_fork_s_second_limb_begins_at_its_bearer() -> None:
    tree = fork()
    found = limbs(tree, heaviest_children(tree, tree.radii))
    assert [limb.tolist() for limb in found] == [[0, 1, 2, 3, 4], [2, 5, 6]]


def test_an_oak_has_a_limb_for_each_tip() -> None:
    tree = oak()
    found = limbs(tree, heaviest_children(tree, tree.radii))
    assert len(found) == np.count_nonzero(child_counts(tree) == 0)


def test_a_lone_joint_is_a_limb_without_edges() -> None:
    tree = Skeleton(np.zeros((1, 3)), np.ones(1), np.array([-1]))
    assert [limb.tolist() for limb in limbs(tree, np.array([-1]))] == [[0]]
