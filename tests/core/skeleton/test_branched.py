from itertools import pairwise

import numpy as np
import pytest
from tests.builders import fork, oak

from treestroke.core.skeleton.branched import Branched, branched
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import heaviest_children


def split(tree: Skeleton) -> Branched:
    return branched(tree, heaviest_children(tree, tree.radii))


def test_a_fork_is_a_stem_and_one_branch_with_its_bud() -> None:
    tree = split(fork())
    assert [chain.tolist() for chain in tree.chains()] == [[0, 1, 2, 3, 4], [2, 5, 6]]
    assert tree.levels().tolist() == [0, 1]


def test_chains_hold_every_edge_once() -> None:
    tree = split(oak())
    edges = [(a, b) for chain in tree.chains() for a, b in pairwise(chain.tolist())]
    assert sorted(b for _, b in edges) == list(range(1, len(tree)))
    assert all(tree.skeleton.parents[b] == a for a, b in edges)


def test_a_path_leads_from_the_root_without_a_gap() -> None:
    tree = split(oak())
    path = tree.path(len(tree) - 1)
    assert path[0] == 0
    assert tree.skeleton.parents[path[1:]].tolist() == path[:-1].tolist()


def test_a_further_stem_becomes_a_branch_of_the_root() -> None:
    points = np.array([[0.0, 0.0], [0.0, 1.0], [0.2, 0.0], [0.3, 1.0]])
    tree = split(Skeleton(points, np.full(4, 0.1), np.array([-1, 0, -1, 2])))
    assert tree.skeleton.parents.tolist() == [-1, 0, 0, 2]
    assert tree.branch.tolist() == [0, 0, 1, 1]
    assert edge_lengths(tree.skeleton)[2] == pytest.approx(0.2)


def test_a_limb_may_leave_at_the_root_itself() -> None:
    points = np.array([[0.0, 0.0], [0.0, 1.0], [0.2, 0.3], [0.4, 0.5]])
    tree = split(Skeleton(points, np.array([0.2, 0.1, 0.1, 0.05]), np.array([-1, 0, 0, 2])))
    assert sorted(len(chain) for chain in tree.chains()) == [2, 3]
    assert tree.branch[0] == 0
    assert tree.levels().tolist() == [0, 1]


@pytest.mark.parametrize("branch", [[0, 0, 1, 1], [1, 1, 1, 1], [0, 0, 0, 0], [0, 0, 2, 2]])
def test_branches_that_are_no_chains_are_refused(branch: list[int]) -> None:
    points = np.array([[0.0, 0.0], [0.0, 1.0], [-1.0, 2.0], [1.0, 2.0]])
    tree = Skeleton(points, np.zeros(4), np.array([-1, 0, 1, 1]))
    with pytest.raises(ValueError, match="branch"):
        Branched(tree, np.array(branch))
