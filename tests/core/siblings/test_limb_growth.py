"""Tests of the limbs that are grown of what was learnt of an example."""

from functools import cache

import numpy as np
from tests.branching import branching, distances
from tests.conftest import DATA

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import TurnedOutline, turned_outline
from treestroke.core.siblings.bifurcations import bifurcations
from treestroke.core.siblings.branching_model import learn_branching
from treestroke.core.siblings.limb_growth import grow_limbs
from treestroke.core.skeleton.skeleton import Skeleton

SAVED = np.load(DATA / "oak_02.skeleton.npz")
TREE = Skeleton(SAVED["points"], SAVED["radii"], SAVED["parents"])
HEIGHT = float(np.ptp(TREE.points[:, 1]))


def crown() -> TurnedOutline:
    """A round crown about the upper part of the tree."""
    camera = OrthographicCamera(240, 200, HEIGHT / 180, (120.0, 190.0))
    rows, columns = np.mgrid[:200, :240]
    mask = np.hypot((columns - 120) / 100, (rows - 85) / 78) <= 1
    return turned_outline(Silhouette(mask, camera))


@cache
def sibling(seed: int = 1) -> Skeleton:
    return grow_limbs(learn_branching(TREE), crown(), HEIGHT, np.random.default_rng(seed))


def test_limbs_keep_to_the_crown_but_for_their_bases() -> None:
    tree = sibling()
    tips = np.setdiff1d(np.arange(len(tree)), tree.parents)
    above = tips[tree.points[tips, 1] > crown().bounds[0, 1]]
    assert (crown().reach(tree.points[above]) <= 1.001).mean() > 0.97


def test_no_joint_is_thicker_than_the_one_before_it() -> None:
    tree = sibling()
    inner = tree.parents >= 0
    assert (tree.radii[inner] <= tree.radii[tree.parents[inner]] + 1e-9).all()


def test_siblings_branch_as_their_example_does() -> None:
    example = branching(TREE)
    for seed in range(2):
        apart = distances(branching(sibling(seed)), example, 1)
        assert apart["angle_deg"] < 18
        assert apart["length_ratio"] < 0.22  # the crown is not the oak's own
        assert apart["radius_ratio"] < 0.1


def test_the_same_seed_gives_the_same_limbs_and_others_do_not() -> None:
    again = grow_limbs(learn_branching(TREE), crown(), HEIGHT, np.random.default_rng(1))
    assert np.array_equal(sibling(1).points, again.points)
    assert not np.array_equal(sibling(1).points[:50], sibling(2).points[:50])


def test_a_model_learns_every_limb_that_is_long_enough() -> None:
    model = learn_branching(TREE)
    assert sum(len(order.shapes) for order in model.orders) == len(bifurcations(TREE).limb)
