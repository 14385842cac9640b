from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from tests.builders import fork, oak
from tests.core.sway.posing import moved
from tests.strategies import skeletons

from treestroke.core.geometry.mesh import Attachment, Mesh
from treestroke.core.mesh.tubes import tubes
from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.sway.bones import rig_of
from treestroke.core.sway.motion import Animation, Motion
from treestroke.core.sway.skinning import skin
from treestroke.core.sway.wind import wind_of

REST = Animation("rest", (), (), ())


def held_cards(tree: Skeleton, joints: np.ndarray) -> Mesh:
    """Build a card of 20 cm at each of some joints."""
    square = 0.1 * np.array([[-1.0, 0, 0], [1, 0, 0], [1, 2, 0], [-1, 2, 0]])
    positions = (tree.points[joints][:, None] + square).reshape(-1, 3).astype(np.float32)
    attachment = Attachment(np.repeat(joints, 8).reshape(-1, 2), np.zeros(len(positions)))
    flat = np.zeros((len(positions), 3), np.float32)
    return Mesh(positions, flat, flat[:, :2], np.zeros((0, 3), np.uint32), attachment=attachment)


@given(skeletons())
@settings(deadline=None, max_examples=40)
def test_weights_sum_to_255_and_bones_of_weight_0_are_bone_0(tree: Skeleton) -> None:
    joints = np.arange(len(tree))
    rig = rig_of(tree, joints)
    rng = np.random.default_rng(len(tree))
    mesh = held_cards(tree, joints)
    pairs = np.stack([np.maximum(tree.parents, 0)[mesh.attachment.joints[:, 0]], mesh.attachment.joints[:, 0]], axis=1)
    for leaves, attachment in ((True, mesh.attachment), (False, Attachment(pairs, rng.random(len(pairs))))):
        bound = skin(rig, replace(mesh, attachment=attachment), leaves=leaves)
        assert (bound.weights.sum(axis=1, dtype=np.int64) == 255).all()
        assert (bound.bones[bound.weights == 0] == 0).all()
        assert bound.bones.max() < len(rig.names)


def test_bones_at_rest_leave_a_photographed_tree_as_it_was(maple: TreeModel, blown: Motion) -> None:
    for mesh, leaves in ((maple.bark.mesh, False), (maple.leaf.mesh, True)):
        bound = skin(blown.rig, mesh, leaves=leaves)
        assert moved(blown.rig, REST, 0.0, bound, mesh.positions) == pytest.approx(mesh.positions, abs=1e-6)


def test_a_vertex_follows_the_joints_that_it_is_attached_to() -> None:
    tree = fork()
    rig = rig_of(tree, None)
    mesh = tubes(tree)
    bound = skin(rig, mesh, leaves=False)
    full = np.zeros((len(tree), len(rig.names)))
    np.add.at(full, (np.arange(len(tree)), rig.joint_bones[:, 0]), 1 - rig.joint_share)
    np.add.at(full, (np.arange(len(tree)), rig.joint_bones[:, 1]), rig.joint_share)
    share = mesh.attachment.share[:, None]
    wanted = full[mesh.attachment.joints[:, 0]] * (1 - share) + full[mesh.attachment.joints[:, 1]] * share
    found = np.zeros(wanted.shape)
    for k in range(4):
        np.add.at(found, (np.arange(len(wanted)), bound.bones[:, k]), bound.weights[:, k] / 255)
    assert found == pytest.approx(wanted, abs=1 / 255)


@pytest.mark.parametrize("number", [0, 1])
def test_the_foot_stands_still_and_bark_never_tears(maple: TreeModel, blown: Motion, number: int) -> None:
    mesh, animation = maple.bark.mesh, blown.animations[number]
    positions = mesh.positions.astype(np.float64)
    bound = skin(blown.rig, mesh, leaves=False)
    edges = mesh.triangles[:, [0, 1, 1, 2]].reshape(-1, 2)
    rest = np.linalg.norm(positions[edges[:, 0]] - positions[edges[:, 1]], axis=1)
    for seconds in np.linspace(0, animation.times[0][-1], 6)[:-1]:
        now = moved(blown.rig, animation, seconds, bound, positions)
        assert np.abs(now - positions)[positions[:, 1] < 0.02].max() < 1e-9
        stretched = np.linalg.norm(now[edges[:, 0]] - now[edges[:, 1]], axis=1) - rest
        assert (np.abs(stretched) < 0.002 + 0.05 * rest).all()


def test_rings_stay_around_their_joints_in_a_gust(maple: TreeModel, blown: Motion) -> None:
    tree, animation = maple.grown.skeleton, blown.animations[1]
    positions = maple.bark.mesh.positions.astype(np.float64)
    joints = Mesh(
        tree.points.astype(np.float32),
        np.zeros((len(tree), 3), np.float32),
        np.zeros((len(tree), 2), np.float32),
        np.zeros((0, 3), np.uint32),
        attachment=Attachment(np.repeat(np.arange(len(tree)), 2).reshape(-1, 2), np.zeros(len(tree))),
    )
    attachment = maple.bark.mesh.attachment
    on_joint = attachment.joints[:, 0] == attachment.joints[:, 1]
    wood = moved(blown.rig, animation, 3.0, skin(blown.rig, joints, leaves=False), joints.positions.astype(np.float64))
    bark = moved(blown.rig, animation, 3.0, skin(blown.rig, maple.bark.mesh, leaves=False), positions)
    before = np.linalg.norm(positions - tree.points[attachment.joints[:, 0]], axis=1)
    after = np.linalg.norm(bark - wood[attachment.joints[:, 0]], axis=1)
    assert after[on_joint] == pytest.approx(before[on_joint], abs=0.004)


def test_outer_corners_of_leaves_flutter_and_inner_ones_follow_the_wood() -> None:
    tree = oak()
    rig = rig_of(tree, np.arange(len(tree)))
    joints = np.flatnonzero(rig.joint_share == 1)
    mesh = held_cards(tree, joints)
    bound = skin(rig, mesh, leaves=True)
    flutter = np.array([name.startswith("flutter") for name in rig.names])
    part = (np.where(flutter[bound.bones], bound.weights, 0).sum(axis=1) / 255).reshape(-1, 4)
    own = np.isin(rig.joint_bones[joints, 1], rig.parents[flutter])
    assert (part[:, :2] == 0).all()
    assert part[own][:, 2:] == pytest.approx(0.5, abs=0.01)
    assert (part[~own][:, 2:] < 0.2).all()


def test_cards_keep_their_shape_within_reason(maple: TreeModel, blown: Motion) -> None:
    mesh, animation = maple.leaf.mesh, blown.animations[0]
    bound = skin(blown.rig, mesh, leaves=True)
    rest = mesh.positions.astype(np.float64).reshape(-1, 4, 3)
    now = moved(blown.rig, animation, 2.0, bound, mesh.positions.astype(np.float64)).reshape(-1, 4, 3)
    sides = [np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2) for corners in (rest, now)]
    stretched = np.abs(sides[1] / sides[0] - 1).max(axis=1)
    assert np.percentile(stretched, 95) < 0.15
    assert np.percentile(stretched, 50) > 0.001


def test_sway_is_0_at_the_foot_and_grows_outward(maple: TreeModel, blown: Motion) -> None:
    mesh, tree = maple.bark.mesh, maple.grown.skeleton
    bound = skin(blown.rig, mesh, leaves=False)
    assert bound.sway[mesh.positions[:, 1] < 0.02].max() == 0
    assert bound.sway.max() <= 1
    at_joint = mesh.attachment.share == 0
    sums, counts = (
        np.bincount(mesh.attachment.joints[at_joint, 0], weights, len(tree))
        for weights in (bound.sway[at_joint], np.ones(at_joint.sum()))
    )
    seen = (counts > 0) & (counts[tree.parents] > 0) & (tree.parents >= 0)
    sway = sums / np.maximum(counts, 1)
    assert (sway[seen] >= sway[tree.parents[seen]] - 1e-9).mean() > 0.95
    assert ((bound.phase >= 0) & (bound.phase <= 1)).all()


def test_a_mesh_without_attachment_is_refused() -> None:
    tree = oak()
    with pytest.raises(ValueError, match="without attachment"):
        skin(wind_of(tree, (), None).rig, replace(tubes(tree), attachment=None), leaves=False)
