import cv2
import numpy as np

from treestroke.core.imaging.correlation import correlation, windows_of

SIDE, FLAT = 7, 2.0
GREY = cv2.GaussianBlur(np.random.default_rng(2).uniform(0, 255, (40, 50)).astype(np.float32), (0, 0), 1.0)


def test_brightness_and_contrast_do_not_matter() -> None:
    found = correlation(windows_of(GREY, SIDE, FLAT), windows_of(0.5 * GREY + 60, SIDE, FLAT))
    np.testing.assert_allclose(found, 1.0, atol=2e-3)


def test_a_negative_is_the_opposite_and_other_noise_is_nothing() -> None:
    mine = windows_of(GREY, SIDE, FLAT)
    np.testing.assert_allclose(correlation(mine, windows_of(255 - GREY, SIDE, FLAT)), -1.0, atol=2e-3)
    other = cv2.GaussianBlur(np.random.default_rng(3).uniform(0, 255, (40, 50)).astype(np.float32), (0, 0), 1.0)
    assert abs(float(correlation(mine, windows_of(other, SIDE, FLAT)).mean())) < 0.1


def test_even_windows_match_nothing() -> None:
    even = np.full((20, 20), 90, np.float32)
    assert np.abs(correlation(windows_of(even, SIDE, FLAT), windows_of(even, SIDE, FLAT))).max() < 0.01
