import numpy as np
import pytest
from scipy.spatial import cKDTree
from tests.core.lift.stick_captures import FORK, along, capture, cloud

from treestroke.core.errors import TreestrokeError
from treestroke.core.lift.seen_branches import SeenBranches, seen_branches
from treestroke.core.skeleton.edit import densified
from treestroke.core.types import Floats

NOWHERE = cloud(np.zeros((0, 3)))
TWIG = ((0, 1.0, 0), (0.5, 1.5, -0.4), 0.012)
BALL = ((-0.45, 2.0, -0.4), (-0.3, 2.0, -0.3), 0.45)
"""Leaves about the end of the fork's second limb."""


@pytest.fixture(scope="module")
def bare() -> SeenBranches:
    return seen_branches(*capture((*FORK, TWIG)), NOWHERE)


def samples(found: SeenBranches) -> Floats:
    return densified(found.skeleton, 0.02)[0].points


def test_a_bare_tree_comes_out_as_its_limbs_down_to_the_twig(bare: SeenBranches) -> None:
    true = np.concatenate([along(stick) for stick in (*FORK, TWIG)])
    places = samples(bare)
    assert cKDTree(places).query(true)[0].max() < 0.08
    assert cKDTree(true).query(places)[0].max() < 0.12
    assert bare.seen.mean() > 0.95


def test_the_tree_is_one_piece_from_the_origin(bare: SeenBranches) -> None:
    assert bare.skeleton.points[0].tolist() == [0.0, 0.0, 0.0]
    assert (bare.skeleton.parents[1:] >= 0).all()


def test_radii_are_as_wide_as_the_shots_show(bare: SeenBranches) -> None:
    tree = bare.skeleton
    for stick, least in ((FORK[0], 0.3), (FORK[1], 1.9), (TWIG, 1.3)):
        near = (cKDTree(along(stick)).query(tree.points)[0] < 0.03) & (tree.points[:, 1] > least)
        near &= tree.points[:, 1] < np.max([stick[0][1], stick[1][1]]) - 0.15
        assert np.median(tree.radii[near]) == pytest.approx(stick[2], rel=0.3)


def test_no_joint_is_thicker_than_its_parent(bare: SeenBranches) -> None:
    radii, parents = bare.skeleton.radii, bare.skeleton.parents
    assert (radii[1:] <= radii[parents[1:]]).all()


def test_a_limb_in_leaves_is_not_seen_and_the_cloud_tells_the_leaves() -> None:
    points = np.array([[0.0, 0.5, 0.0], [-0.4, 2.0, -0.35], [-0.3, 2.2, -0.2]])
    found = seen_branches(*capture(FORK, (BALL,)), cloud(points))
    places = samples(found)
    assert cKDTree(places).query(along(FORK[1]))[0].max() < 0.08
    assert np.linalg.norm(places - FORK[2][1], axis=1).min() > 0.2
    assert found.leaf_points.tolist() == points[1:].tolist()


def test_a_trunk_under_leaves_is_where_and_as_wide_as_its_silhouette() -> None:
    tree = seen_branches(*capture(FORK, (BALL,)), NOWHERE).skeleton
    trunk = (tree.points[:, 1] > 0.3) & (tree.points[:, 1] < 1.2)
    assert np.hypot(tree.points[trunk, 0], tree.points[trunk, 2]).max() < 0.004
    assert np.median(tree.radii[trunk]) == pytest.approx(FORK[0][2], rel=0.1)


def test_what_a_leafless_piece_bridges_is_marked_as_not_seen() -> None:
    cover = ((0, 0.7, 0), (0, 0.9, 0), 0.15)
    found = seen_branches(*capture(FORK, (cover,)), NOWHERE)
    hidden = (found.skeleton.points[:, 1] > 0.65) & (found.skeleton.points[:, 1] < 0.95)
    assert hidden.any()
    assert not found.seen[hidden].any()
    assert cKDTree(samples(found)).query(along(FORK[2]))[0].max() < 0.15


def test_the_same_shots_give_the_same_tree(bare: SeenBranches) -> None:
    again = seen_branches(*capture((*FORK, TWIG)), NOWHERE)
    assert again.skeleton.points.tobytes() == bare.skeleton.points.tobytes()
    assert again.skeleton.radii.tobytes() == bare.skeleton.radii.tobytes()


def test_shots_without_wood_are_the_users_fault() -> None:
    with pytest.raises(TreestrokeError, match="mark it with a branch stroke"):
        seen_branches(*capture((), (BALL,)), NOWHERE)
