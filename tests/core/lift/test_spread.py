from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import turned_outline
from treestroke.core.lift.spread import FrontCrown, FrontTree, LiftParams, lift
from treestroke.core.skeleton.skeleton import Skeleton

DEFAULT = LiftParams()
CAMERA = OrthographicCamera(400, 400, 0.025, (200.0, 390.0))


def crown() -> FrontCrown:
    y, x = np.mgrid[:400, :400] + 0.5
    return FrontCrown(turned_outline(Silhouette(np.hypot(x - 200, y - 180) < 160, CAMERA)), CAMERA)


CROWN = crown()


def tree_of(limbs: list[list[tuple[float, float]]]) -> Skeleton:
    """Draw a stem of five joints, (200, 390) to (200, 60) px, and limbs that leave its joint 2 at (200, 225)."""
    points = [(200.0, y) for y in (390.0, 300.0, 225.0, 140.0, 60.0)]
    parents = [-1, 0, 1, 2, 3]
    for limb in limbs:
        parents += [2, *range(len(points), len(points) + len(limb) - 1)]
        points += limb
    radii = np.linspace(8.0, 1.0, len(points))
    return Skeleton(np.array(points), radii, np.array(parents))


LEFT = [(150.0, 190.0), (100.0, 160.0)]
TWINS = tree_of([LEFT, [(x + 4.0, y - 3.0) for x, y in LEFT]])
SPRAY = tree_of(
    [LEFT, [(250.0, 190.0), (300.0, 150.0)], [(160.0, 210.0), (90.0, 215.0)], [(240.0, 205.0), (310.0, 210.0)]]
)


def lifted(tree: Skeleton, seed: int = 0, params: LiftParams = DEFAULT, seen: Sequence[int] = ()) -> Skeleton:
    """Lift a tree whose stem alone was stroked; some joints are seen among leaves."""
    stroke, joints = np.where(np.arange(len(tree)) < 5, 0, -1), np.arange(len(tree))
    return lift(FrontTree(tree, stroke, np.isin(joints, seen)), CROWN, np.random.default_rng(seed), params)


@given(st.integers(0, 2**32 - 1), st.integers(1, 12))
@settings(max_examples=30, deadline=None)
def test_every_joint_still_stands_on_its_pixel(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    tree = tree_of([[tuple(p) for p in rng.uniform(60, 320, (2, 2))] for _ in range(count)])
    found = lifted(tree, seed)
    assert CAMERA.pixels_from_world(found.points) == pytest.approx(tree.points)
    assert found.radii == pytest.approx(tree.radii * CAMERA.metres_per_pixel)
    assert np.array_equal(found.parents, tree.parents)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_depth_stays_inside_the_volume_where_there_is_crown(seed: int) -> None:
    ends = np.random.default_rng(seed).uniform(20, 340, (6, 2, 2))
    ends[..., 1] = np.clip(ends[..., 1], 22, 338)
    found = lifted(tree_of([[tuple(p) for p in limb] for limb in ends]), seed)
    stems = tree_of([]).points[:, 0].size
    room = LiftParams().inside * CROWN.volume.half_depth(found.points)
    start = np.maximum(np.abs(found.points[2, 2]), 0.0)
    assert (np.abs(found.points[stems:, 2]) <= np.maximum(room[stems:], start) + 1e-9).all()


def test_the_trunk_stays_in_the_picture_s_plane() -> None:
    assert (lifted(SPRAY).points[:5, 2] == 0).all()


def test_siblings_that_cover_each_other_part_in_depth() -> None:
    depth = lifted(TWINS).points[[6, 8], 2]
    assert np.abs(depth[0] - depth[1]) > 1.0


def test_limbs_turn_to_both_sides() -> None:
    depth = lifted(SPRAY).points[[6, 8, 10, 12], 2]
    assert depth.min() < -0.5
    assert depth.max() > 0.5


def test_a_limb_is_no_steeper_than_allowed() -> None:
    found = lifted(SPRAY, params=LiftParams(steepest=0.3)).points
    for start, end in ((2, 5), (5, 6), (2, 7), (7, 8)):
        run = np.linalg.norm(found[end, :2] - found[start, :2])
        assert abs(found[end, 2] - found[start, 2]) <= 0.3 * run + 1e-9


def test_chance_decides_just_the_side_of_a_tie() -> None:
    """The first twin may go to the front or the back, the other goes where it is not; mirrored, the trees are one."""
    trees = [lifted(TWINS, seed).points for seed in range(12)]
    assert len({tuple(np.round(points[:, 2] * np.sign(points[6, 2]), 9)) for points in trees}) == 1
    assert {float(np.sign(points[6, 2])) for points in trees} == {-1.0, 1.0}


def test_the_same_lot_gives_the_same_tree() -> None:
    assert np.array_equal(lifted(SPRAY, 3).points, lifted(SPRAY, 3).points)


def test_a_stem_alone_and_a_lone_joint_stay_flat() -> None:
    lone = Skeleton(np.array([[200.0, 390.0]]), np.ones(1), np.array([-1]))
    for tree in (tree_of([]), lone):
        assert (lifted(tree).points[:, 2] == 0).all()


def test_without_slope_the_tree_is_flat() -> None:
    assert (lifted(SPRAY, params=LiftParams(steepest=0.0)).points[:, 2] == 0).all()


@pytest.mark.parametrize("changes", [{"steepest": -1.0}, {"slopes": 0}, {"inside": 1.5}, {"inside": -0.1}])
def test_parameters_out_of_range_are_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="lifting needs"):
        LiftParams(**changes)


def test_a_limb_enters_the_crown_without_a_jump_in_depth() -> None:
    limb = [(200.0 + 2 * k, 385.0 - 6 * k) for k in range(30)]
    points = lifted(tree_of([limb])).points[5:]
    run = np.linalg.norm(np.diff(points[:, :2], axis=0), axis=1)
    assert (np.abs(np.diff(points[:, 2])) <= LiftParams().steepest * run + 1e-9).all()
    assert np.abs(points[:, 2]).max() > 0.3


@pytest.mark.parametrize("seed", range(5))
def test_limbs_seen_among_leaves_lie_on_the_viewer_s_side(seed: int) -> None:
    depth = lifted(SPRAY, seed, seen=range(5, len(SPRAY))).points[:, 2]
    assert depth.min() >= 0
    assert np.ptp(depth[[6, 8, 10, 12]]) > 1.0


def test_what_is_seen_of_one_limb_leaves_the_others_free() -> None:
    depth = np.array([lifted(SPRAY, seed, seen=[5, 6]).points[:, 2] for seed in range(8)])
    assert (depth[:, 5:7] >= 0).all()
    assert (depth[:, 7:] < 0).any()


def test_a_limb_of_which_little_is_seen_may_lie_behind() -> None:
    hidden = tree_of([[*LEFT, (80.0, 100.0), (60.0, 20.0)], [(x + 4.0, y - 3.0) for x, y in LEFT]])
    assert any(lifted(hidden, seed, seen=[5]).points[5:9, 2].min() < 0 for seed in range(8))
