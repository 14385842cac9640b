import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.builders import fork, oak, stick
from tests.core.sway.posing import branches
from tests.strategies import skeletons

from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import child_counts
from treestroke.core.sway.bones import MOST_BRANCHES, MOST_FLUTTERS, rig_of
from treestroke.core.sway.motion import Motion


def tips(tree: Skeleton) -> np.ndarray:
    return np.flatnonzero(child_counts(tree) == 0)


@given(skeletons(), st.booleans())
@settings(deadline=None, max_examples=60)
def test_bones_come_after_their_parents_and_joints_follow_a_bone_and_its_parent(tree: Skeleton, leafy: bool) -> None:
    rig = rig_of(tree, tips(tree) if leafy else None)
    assert rig.parents[0] == -1
    assert (rig.parents[1:] < np.arange(1, len(rig.names))).all()
    assert (rig.parents[1:] >= 0).all()
    before, own = rig.joint_bones.T
    assert np.array_equal(before, np.maximum(rig.parents, 0)[own])
    assert ((rig.joint_share >= 0) & (rig.joint_share <= 1)).all()


@given(skeletons())
@settings(deadline=None, max_examples=60)
def test_every_root_stands_on_the_root_bone(tree: Skeleton) -> None:
    rig = rig_of(tree, None)
    roots = tree.parents < 0
    assert rig.names[0] == "root"
    assert (rig.joint_bones[roots] == 0).all()
    assert (rig.joint_share[roots] == 0).all()


@given(skeletons(), st.booleans())
@settings(deadline=None, max_examples=60)
def test_flutter_bones_have_length_and_hang_on_branches(tree: Skeleton, leafy: bool) -> None:
    rig = rig_of(tree, tips(tree) if leafy else None)
    flutters = np.array([name.startswith("flutter") for name in rig.names])
    parents = rig.parents[flutters]
    assert leafy or not flutters.any()
    assert not flutters[parents].any()
    assert (np.linalg.norm(rig.heads[flutters] - rig.heads[parents], axis=1) > 0).all()
    assert (rig.flutter[parents] == np.flatnonzero(flutters)).all()


def test_a_photographed_tree_has_all_bones_it_may_have(blown: Motion) -> None:
    names = blown.rig.names
    assert len(set(names)) == len(names)
    assert len(branches(blown.rig)) == MOST_BRANCHES - 1
    assert sum(name.startswith("flutter") for name in names) == MOST_FLUTTERS


def test_the_trunk_gets_several_bones_and_every_limb_of_a_fork_one() -> None:
    rig = rig_of(fork(), None)
    starts_in_trunk = np.isclose(rig.heads[1:, 0], 0) & np.isclose(rig.heads[1:, 2], 0)
    aside = rig.ends[1:, 0] > 0.5
    assert starts_in_trunk.sum() >= 3
    assert aside.sum() >= 1


def test_bones_of_a_limb_follow_one_another() -> None:
    rig = rig_of(stick(joints=40), None)
    assert len(rig.names) > 3
    assert np.array_equal(rig.parents, np.arange(len(rig.names)) - 1)
    assert rig.heads[2:] == pytest.approx(rig.ends[1:-1])
    assert rig.ends[-1] == pytest.approx([0, 4, 0])


def test_weights_blend_into_a_bone_without_a_kink() -> None:
    tree = stick(joints=400)
    rig = rig_of(tree, None)
    bends = np.abs(np.diff(np.where(rig.joint_bones[:, 1] == 2, rig.joint_share, np.nan), n=2))
    assert rig.joint_share[rig.joint_bones[:, 1] == 2].max() == 1.0
    assert np.nanmax(bends) < 0.01


def test_limbs_with_leaves_get_bones_before_bare_ones() -> None:
    tree = oak(orders=5)
    high = tips(tree)[tree.points[tips(tree), 0] > 0]
    leafy, bare = rig_of(tree, np.repeat(high, 1000)), rig_of(tree, None)
    assert (leafy.ends[branches(leafy), 0] > 0).mean() > (bare.ends[branches(bare), 0] > 0).mean()


def test_a_bone_is_as_thick_as_the_wood_at_its_head(maple: TreeModel, blown: Motion) -> None:
    tree, rig = maple.grown.skeleton, blown.rig
    for bone in branches(rig):
        starts = np.flatnonzero(np.linalg.norm(tree.points[np.maximum(tree.parents, 0)] - rig.heads[bone], axis=1) == 0)
        assert rig.radii[bone] in tree.radii[starts]
