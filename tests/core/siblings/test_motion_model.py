import numpy as np
import pytest

from treestroke.core.siblings.motion_model import MotionModel, Turns, learn_motion

FRAMES = 120


def branches(count: int = 40, seed: int = 1) -> Turns:
    rng = np.random.default_rng(seed)
    along = rng.normal(size=(count, 3))
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    first = np.cross(along, [0.3, 0.1, 0.9])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return Turns(along, np.stack([first, np.cross(along, first)], axis=1), rng.uniform(0.05, 1.0, count))


def gusty(seen: Turns, seed: int = 2) -> np.ndarray:
    """Turns of branches in a gust that blows to the right, each with a swing of its own."""
    rng, time = np.random.default_rng(seed), np.arange(FRAMES) / FRAMES
    gust = np.sin(2.0 * np.pi * 3.0 * time)[:, None, None]
    lean = np.cross(seen.along, [0.04, 0.0, 0.0]) * (seen.thickness**-0.5)[:, None]
    own = 0.006 * np.sin(2.0 * np.pi * (5.0 * time[:, None] + rng.uniform(size=len(seen.thickness))))
    return gust * lean + own[:, :, None] * seen.axes[:, 0]


@pytest.fixture(scope="module")
def model() -> MotionModel:
    seen = branches()
    return learn_motion(gusty(seen), seen)


def test_the_gusts_are_found(model: MotionModel) -> None:
    gust = np.sin(2.0 * np.pi * 3.0 * np.arange(FRAMES) / FRAMES)
    assert abs(np.corrcoef(model.gusts, gust)[0, 1]) > 0.99
    assert abs(model.push[0]) > 5.0 * np.abs(model.push[1:]).max()
    assert model.softer == pytest.approx(0.5, abs=0.15)


def test_a_sibling_turns_as_far_in_the_same_wind(model: MotionModel) -> None:
    other = branches(60, seed=9)
    drawn, seen = model.draw(other, np.random.default_rng(3)), gusty(other)
    assert drawn.shape == (FRAMES, 60, 3)
    ratio = np.linalg.norm(drawn.std(axis=0), axis=1) / np.linalg.norm(seen.std(axis=0), axis=1)
    assert 0.7 < np.median(ratio) < 1.4


def test_siblings_move_alike_but_not_the_same(model: MotionModel) -> None:
    other = branches(60, seed=9)
    first, second, again = (model.draw(other, np.random.default_rng(seed)) for seed in (1, 2, 1))
    assert np.array_equal(first, again)
    assert np.abs(first - second).max() > 0.01


def test_the_series_is_one_period(model: MotionModel) -> None:
    drawn = model.draw(branches(), np.random.default_rng(1))
    steps = np.linalg.norm(np.diff(drawn, axis=0), axis=2)
    assert np.linalg.norm(drawn[0] - drawn[-1], axis=1).max() < 1.5 * steps.max()


def test_few_frames_are_refused() -> None:
    with pytest.raises(ValueError, match="10 frames"):
        learn_motion(np.zeros((5, 40, 3)), branches())
