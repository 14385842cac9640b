import numpy as np

from treestroke.core.imaging.levelling import MOST_GAIN, levelled
from treestroke.core.imaging.light import linear_light

COUNT = 18
AZIMUTHS = np.linspace(0, 2 * np.pi, COUNT, endpoint=False)
TREE = np.ones((8, 8), np.bool_)


def walk() -> list[np.ndarray]:
    """Photos around a tree whose side toward azimuth 0 is in the sun."""
    levels = 110 + 40 * np.cos(AZIMUTHS)
    return [np.full((8, 8, 3), round(level), np.uint8) for level in levels.tolist()]


def lights(pictures: list[np.ndarray]) -> np.ndarray:
    """Return the mean linear light of each picture's channels."""
    table = linear_light(np.arange(256.0))
    return np.array([table[picture].mean(axis=(0, 1)) for picture in pictures])


def levelled_lights(pictures: list[np.ndarray]) -> np.ndarray:
    return lights(levelled(pictures, [TREE] * COUNT, AZIMUTHS))


def test_the_sunny_side_stays_brighter() -> None:
    before, after = lights(walk()), levelled_lights(walk())
    assert np.abs(after / before - 1).max() < 0.12
    assert after[0].mean() > 2 * after[COUNT // 2].mean()


def test_one_photo_too_bright_and_too_warm_is_brought_to_its_neighbours() -> None:
    pictures, usual = walk(), levelled_lights(walk())
    pictures[5] = np.clip(pictures[5] * np.array([1.15, 1.1, 1.0]), 0, 255).astype(np.uint8)
    wrong = lights(pictures)[5] / usual[5]
    left = levelled_lights(pictures)[5] / usual[5]
    assert wrong[0] > 1.3
    assert np.abs(left - 1).max() < 0.5 * np.abs(wrong - 1).max()


def test_a_night_photo_is_not_made_day() -> None:
    pictures = walk()
    pictures[3] = np.full((8, 8, 3), 12, np.uint8)
    assert np.all(levelled_lights(pictures)[3] <= 1.02 * MOST_GAIN * lights(pictures)[3] + 1e-3)


def test_a_photo_without_neighbours_is_left_as_it_is() -> None:
    pictures = walk()[:2]
    found = levelled(pictures, [TREE] * 2, np.array([0.0, np.pi]))
    assert all(np.array_equal(one, other) for one, other in zip(pictures, found, strict=True))
