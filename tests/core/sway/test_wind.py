import numpy as np
import pytest
from hypothesis import given, settings
from scipy.stats import spearmanr
from tests.builders import oak, stick
from tests.core.sway.posing import branches, posed, turns_at, widest_turns
from tests.strategies import skeletons

from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.sway.motion import Animation, Motion, Rig
from treestroke.core.sway.wind import WEATHERS, WIND, wind_of


def length(animation: Animation) -> float:
    return float(animation.times[0][-1])


def swings(rig: Rig, animation: Animation) -> np.ndarray:
    """How far each bone's end is moved at 40 moments (40, b, 3), metres."""
    poses = [posed(rig, animation, seconds) for seconds in np.linspace(0, length(animation), 41)[:-1]]
    return np.array([heads + np.einsum("bij,bj->bi", turns, rig.ends - rig.heads) - rig.ends for turns, heads in poses])


@given(skeletons())
@settings(deadline=None, max_examples=25)
def test_loops_close_and_keys_are_unit_turns_in_order(tree: Skeleton) -> None:
    for animation in wind_of(tree, tuple(WEATHERS), np.array([len(tree) - 1])).animations:
        for times, turns in zip(animation.times, animation.rotations, strict=True):
            assert (np.diff(times) > 0).all()
            assert times[0] == 0
            assert times[-1] == WEATHERS[animation.name].seconds
            assert np.array_equal(turns[0], turns[-1])
            assert np.linalg.norm(turns, axis=1) == pytest.approx(1)


def test_loops_close_without_a_jerk(blown: Motion) -> None:
    for animation in blown.animations:
        for turns in animation.rotations:
            speed = np.diff(turns, axis=0)
            jerks = np.linalg.norm(np.diff(np.concatenate([speed, speed[:1]]), axis=0), axis=1)
            assert jerks[-1] <= jerks.max()
            assert np.linalg.norm(speed[0] - speed[-1]) < 0.6 * np.linalg.norm(speed, axis=1).max()


def test_only_the_root_stands_still(blown: Motion) -> None:
    for animation in blown.animations:
        assert animation.bones == tuple(range(1, len(blown.rig.names)))


def test_bones_keep_their_length(blown: Motion) -> None:
    rig = blown.rig
    rest = np.linalg.norm(rig.heads[1:] - rig.heads[rig.parents[1:]], axis=1)
    for animation in blown.animations:
        for seconds in np.linspace(0, length(animation), 9):
            _, heads = posed(rig, animation, seconds)
            assert np.linalg.norm(heads[1:] - heads[rig.parents[1:]], axis=1) == pytest.approx(rest, rel=1e-3)


@pytest.mark.parametrize("number", [0, 1])
def test_thin_wood_turns_and_moves_further_than_thick_wood(blown: Motion, number: int) -> None:
    rig, animation = blown.rig, blown.animations[number]
    bones, widest = branches(rig), widest_turns(animation)
    moved = np.linalg.norm(swings(rig, animation), axis=2).max(axis=0)
    assert spearmanr(rig.radii[bones], [widest[bone] for bone in bones])[0] < -0.95
    assert spearmanr(rig.radii[bones], moved[bones])[0] < -0.6


def test_thick_wood_swings_more_slowly(blown: Motion) -> None:
    rig, breeze = blown.rig, blown.animations[0]
    counts = np.array([len(times) for times in breeze.times])
    bones = branches(rig)
    by_radius = counts[bones[np.argsort(rig.radii[bones], kind="stable")] - 1]
    assert (np.diff(by_radius) <= 0).all()
    swings = by_radius - 1  # a animation begins and ends with the same pose
    assert swings[0] >= 2 * swings[-1]


def test_a_breeze_moves_twigs_by_centimetres_and_the_trunk_by_millimetres(blown: Motion) -> None:
    moved = np.linalg.norm(swings(blown.rig, blown.animations[0]), axis=2).max(axis=0)
    twigs = np.setdiff1d(branches(blown.rig), blown.rig.parents)
    assert 0.02 < np.median(moved[twigs]) < 0.1
    assert moved[1] < 0.005


def test_a_gust_leans_with_the_wind_and_lets_go(blown: Motion) -> None:
    animation = blown.animations[1]
    downwind = np.median(swings(blown.rig, animation)[:, branches(blown.rig)] @ WIND, axis=1)
    breeze = np.linalg.norm(swings(blown.rig, blown.animations[0]), axis=2).max(axis=0)
    assert downwind.max() > 2 * np.median(breeze)
    assert abs(downwind.min()) < 0.25 * downwind.max()


def test_branches_swing_each_in_its_own_time(blown: Motion) -> None:
    rig, animation = blown.rig, blown.animations[0]
    turned = np.array([turns_at(rig, animation, t)[:, 2, 1] for t in np.linspace(0, length(animation), 81)[:-1]])
    alike = np.corrcoef(turned[:, branches(rig)].T)
    assert np.abs(alike[np.triu_indices_from(alike, 1)]).mean() < 0.3


def test_a_tall_tree_swings_more_slowly_than_a_small_one() -> None:
    small, tall = (wind_of(stick(height=h, radius=h / 40, tip_radius=h / 80), ("breeze",), None) for h in (3.0, 30.0))
    assert len(small.animations[0].times[0]) > 1.5 * len(tall.animations[0].times[0])


def test_equal_trees_get_equal_bytes() -> None:
    first, second = (wind_of(oak(), ("gust",), np.arange(20)) for _ in range(2))
    assert [turns.tobytes() for turns in first.animations[0].rotations] == [
        turns.tobytes() for turns in second.animations[0].rotations
    ]


def test_an_unknown_wind_is_refused() -> None:
    with pytest.raises(ValueError, match="breeze, gust, not storm"):
        wind_of(stick(), ("storm",), None)
