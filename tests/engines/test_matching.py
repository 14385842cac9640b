import numpy as np

from treestroke.engines.epipolar_matching import Rays, match_along_lines
from treestroke.engines.features import LENGTH, find_features
from treestroke.engines.matching import match_descriptors

RNG = np.random.default_rng(5)


def descriptors(count: int) -> np.ndarray:
    raw = RNG.random((count, 128)) ** 4
    return np.round(LENGTH * raw / np.linalg.norm(raw, axis=1, keepdims=True)).astype(np.float32)


def noisy(clean: np.ndarray) -> np.ndarray:
    return np.maximum(np.round(clean + RNG.normal(0, 3, clean.shape)), 0).astype(np.float32)


def test_shuffled_features_are_found_again() -> None:
    first, order = descriptors(60), RNG.permutation(60)
    matches = match_descriptors(first, noisy(first[order]))
    assert len(matches) == 60
    assert (order[matches[:, 1]] == matches[:, 0]).all()


def test_what_looks_the_same_twice_is_not_matched() -> None:
    first = descriptors(10)
    matches = match_descriptors(first, np.concatenate([first, first[:3]]))
    assert sorted(matches[:, 0]) == list(range(3, 10))


def test_nothing_matches_a_photo_without_features() -> None:
    assert match_descriptors(descriptors(5), descriptors(0)).shape == (0, 2)


def test_lines_tell_apart_what_looks_the_same() -> None:
    points = RNG.uniform([-2, -2, 4], [2, 2, 8], (40, 3))
    same = np.repeat(descriptors(1), 40, axis=0)
    first, second = (_rays(np.array(centre), points, same) for centre in ([0.0, 0, 0], [1.0, 0, 0]))
    assert len(match_descriptors(same, same.copy())) == 0
    matches = match_along_lines(first, second, (0.0, 1.0))
    assert len(matches) > 25
    assert (matches[:, 0] == matches[:, 1]).all()


def test_parallax_beyond_the_range_is_no_match() -> None:
    points = RNG.uniform([-2, -2, 4], [2, 2, 8], (40, 3))
    look = descriptors(40)
    first, second = (_rays(np.array(centre), points, look) for centre in ([0.0, 0, 0], [1.0, 0, 0]))
    assert len(match_along_lines(first, second, (0.0, 1.0))) == 40
    assert len(match_along_lines(first, second, (0.5, 1.0))) == 0


def test_a_plain_photo_has_no_features() -> None:
    found = find_features(np.full((90, 120, 3), 128, np.uint8))
    assert len(found) == 0
    assert found.descriptors.shape == (0, 128)


def test_features_lie_in_the_middle_of_what_they_show() -> None:
    picture = np.full((90, 120, 3), 128, np.uint8)
    picture[40:44, 70:74] = 255
    found = find_features(picture)
    assert np.linalg.norm(found.points_px - [72.0, 42.0], axis=1).min() < 0.3


def _rays(centre: np.ndarray, points: np.ndarray, look: np.ndarray) -> Rays:
    toward = points - centre
    return Rays(centre, toward / np.linalg.norm(toward, axis=1, keepdims=True), look, 1e-4)
