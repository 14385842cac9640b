import numpy as np
import pytest
from tests.builders import fork, oak, stick
from tests.core.sway.posing import posed

from treestroke.core.sway.bones import rig_of
from treestroke.core.sway.measured import MOST_RAD, MOST_RAD_S, Seen, heads_in_motion, looped, turns_of
from treestroke.core.sway.motion import Rig
from treestroke.core.sway.stiffness import fluttering, moving_branches

RATE, FRAMES = 30.0, 60


def rigged(tree: object, leaves: bool = False) -> Rig:
    joints = np.arange(len(tree) - 12, len(tree)) if leaves else None
    return rig_of(tree, joints, 60, tips=True)


def truly_turning(rig: Rig, most_rad: float = 0.06) -> np.ndarray:
    """Return turns (f, b, 3) of all branches across the line of sight, each with its own time."""
    time = np.arange(FRAMES) / RATE
    turns = np.zeros((FRAMES, len(rig.names), 3))
    for bone in np.flatnonzero(moving_branches(rig)).tolist():
        turns[:, bone, 2] = most_rad * (np.sin(2.0 * np.pi * (0.8 + 0.02 * bone) * time + bone) - np.sin(bone))
    return turns


def seen(rig: Rig, turns: np.ndarray, error: float = 0.0) -> Seen:
    moved = heads_in_motion(rig, turns)[:, :, :2] - rig.heads[:, :2]
    return Seen(moved, np.full(len(rig.names), error), RATE)


@pytest.mark.parametrize("tree", [fork(), oak()])
def test_bones_follow_what_is_seen(tree: object) -> None:
    rig = rigged(tree)
    shown = seen(rig, truly_turning(rig))
    found = heads_in_motion(rig, turns_of(rig, shown))[:, :, :2] - rig.heads[:, :2]
    places = shown.moved.std(axis=0).max(axis=1) > 0.01
    assert places.sum() >= 3
    left = np.sqrt(((found - shown.moved)[:, places] ** 2).mean())
    assert left < 0.25 * np.sqrt((shown.moved[:, places] ** 2).mean())


def test_bones_keep_their_length() -> None:
    rig = rigged(oak())
    heads = heads_in_motion(rig, turns_of(rig, seen(rig, truly_turning(rig, 0.2))))
    lengths = np.linalg.norm(heads[:, 1:] - heads[:, rig.parents[1:]], axis=2)
    assert lengths == pytest.approx(np.broadcast_to(lengths[0], lengths.shape), abs=1e-9)


def test_noise_does_not_twist_limbs() -> None:
    rig = rigged(oak())
    noisy = np.random.default_rng(4).normal(0.0, 0.5, (FRAMES, len(rig.names), 2))
    turns = turns_of(rig, Seen(noisy, np.full(len(rig.names), 0.5), RATE))
    assert np.linalg.norm(turns, axis=2).max() <= MOST_RAD + 1e-9
    along = rig.ends - rig.heads
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    assert np.abs((turns * along)[:, moving_branches(rig)].sum(axis=2)).max() < 1e-9


def test_speed_is_bounded() -> None:
    rig = rigged(fork())
    jump = np.zeros((FRAMES, len(rig.names), 2))
    jump[30:, -1] = 3.0
    turns = turns_of(rig, Seen(jump, np.zeros(len(rig.names)), RATE))
    assert np.linalg.norm(np.diff(turns, axis=0), axis=2).max() <= MOST_RAD_S / RATE + 1e-9


def test_what_is_not_seen_follows_its_parent_later_and_less() -> None:
    rig = rigged(oak())
    turns = truly_turning(rig)
    shown = seen(rig, turns)
    error = np.where(moving_branches(rig) & (np.arange(len(rig.names)) < 8), 0.0, np.inf)
    found = turns_of(rig, Seen(shown.moved, error, RATE))
    bones = [b for b in np.flatnonzero(moving_branches(rig)).tolist() if b >= 12 and np.isinf(error[rig.parents[b]])]
    assert bones
    for bone in bones[:5]:
        parent = int(rig.parents[bone])
        if found[:, parent].std() > 1e-6:
            assert 0.0 < found[:, bone].std() < found[:, parent].std()


def test_where_nothing_is_seen_nothing_moves() -> None:
    rig = rigged(oak(), leaves=True)
    turns = turns_of(rig, Seen(np.zeros((FRAMES, len(rig.names), 2)), np.full(len(rig.names), np.inf), RATE))
    assert not turns.any()


def test_leaves_flutter_where_their_branch_moves() -> None:
    rig = rigged(oak(), leaves=True)
    turns = turns_of(rig, seen(rig, truly_turning(rig)))
    assert fluttering(rig).any()
    assert (np.abs(turns[:, fluttering(rig)]).max(axis=(0, 2)) > 0).all()


def test_the_animation_shows_each_frame_and_closes_without_a_jerk() -> None:
    rig = rigged(fork())
    turns = turns_of(rig, seen(rig, truly_turning(rig)))
    animation = looped(turns, RATE)
    assert animation.name == "measured"
    for index in (0, 7, FRAMES - 1):
        _, heads = posed(rig, animation, index / RATE)
        assert heads == pytest.approx(heads_in_motion(rig, turns)[index], abs=1e-6)
    for keys in animation.rotations:
        assert keys[-1] == pytest.approx(keys[0], abs=1e-9)
        steps = np.linalg.norm(np.diff(keys, axis=0), axis=1)
        assert np.linalg.norm((keys[1] - keys[0]) - (keys[-1] - keys[-2])) < 0.5 * steps.max() + 1e-6


def test_a_trunk_alone_moves_too() -> None:
    rig = rigged(stick(12))
    found = turns_of(rig, seen(rig, truly_turning(rig)))
    assert np.abs(found).max() > 0.0
