import numpy as np
import pytest
from tests.core.lift.test_spread import CAMERA, CROWN, LEFT, SPRAY, tree_of

from treestroke.core.lift.fan import fan_out
from treestroke.core.skeleton.skeleton import Skeleton

MANY = tree_of(
    [
        [(200 + side * 40.0, 205.0 - up), (200 + side * 90.0, 180.0 - up)]
        for up in (0, 20, 40, 60, 80)
        for side in (-1, 1)
    ]
)


def fanned(tree: Skeleton, seed: int = 0) -> Skeleton:
    """Lift a tree whose stem alone was stroked."""
    stroke = np.where(np.arange(len(tree)) < 5, 0, -1)
    return fan_out(tree, stroke, CROWN, np.random.default_rng(seed))


@pytest.mark.parametrize("tree", [SPRAY, MANY, tree_of([])], ids=["spray", "many", "stem"])
def test_every_joint_still_stands_on_its_pixel_and_the_stem_in_the_picture(tree: Skeleton) -> None:
    lifted = fanned(tree)
    assert np.allclose(CAMERA.pixels_from_world(lifted.points)[:, :2], tree.points)
    assert not lifted.points[:5, 2].any()


def test_limbs_stand_on_both_sides_and_within_the_crown() -> None:
    points = fanned(MANY).points[5:]
    widest = float(CROWN.volume.half_width(points[:, 1]).max())
    assert points[:, 2].min() < -0.5 < 0.5 < points[:, 2].max()
    assert np.abs(points[:, 2]).max() <= widest


def test_no_limb_turns_back_toward_the_picture_s_plane() -> None:
    depth = fanned(MANY).points[5:, 2].reshape(-1, 2)
    assert (np.abs(depth[:, 1]) >= np.abs(depth[:, 0])).all()


def test_limbs_in_one_line_of_sight_end_evenly_from_front_to_back() -> None:
    ends = np.sort(fanned(tree_of([[(240.0, 190.0), (280.0, 160.0)]] * 12)).points[6::2, 2])
    assert np.ptp(ends) > 3.0
    assert np.diff(ends).max() < 0.25 * np.ptp(ends)


def test_limbs_at_the_crown_s_edge_leave_the_picture_less_than_those_in_its_middle() -> None:
    middle, edge = (
        np.abs(fanned(tree_of([limb] * 12)).points[6::2, 2]).max()
        for limb in ([(250.0, 200.0), (280.0, 110.0)], [(300.0, 200.0), (355.0, 160.0)])
    )
    assert edge < 0.95 * middle


def test_limbs_in_one_line_of_sight_part_in_depth() -> None:
    ends = fanned(tree_of([LEFT, LEFT])).points[[6, 8], 2]
    assert abs(ends[0] - ends[1]) > 0.3


def test_the_same_lot_gives_the_same_tree_and_another_lot_another() -> None:
    assert np.array_equal(fanned(MANY, 1).points, fanned(MANY, 1).points)
    assert not np.array_equal(fanned(MANY, 1).points, fanned(MANY, 2).points)
