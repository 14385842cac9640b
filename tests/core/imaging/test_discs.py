import cv2
import numpy as np
import pytest

from treestroke.core.imaging.discs import cover_with_discs


def blot() -> np.ndarray:
    shape = np.zeros((90, 120), np.uint8)
    cv2.circle(shape, (45, 45), 30, 1, -1)
    cv2.circle(shape, (90, 40), 12, 1, -1)
    return shape > 0


def painted(discs: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    y, x = np.mgrid[: shape[0], : shape[1]] + 0.5
    return (np.hypot(x - discs[:, 0, None, None], y - discs[:, 1, None, None]) <= discs[:, 2, None, None]).any(axis=0)


def test_discs_cover_a_shape_and_lie_in_it() -> None:
    shape = blot()
    cover = painted(cover_with_discs(shape, 1.0, 100.0), shape.shape)
    assert (cover & shape).sum() > 0.97 * shape.sum()
    assert not (cover & ~cv2.dilate(shape.astype(np.uint8), np.ones((3, 3))).astype(bool)).any()


def test_the_largest_comes_first_and_none_is_larger_than_asked() -> None:
    free, bounded = (cover_with_discs(blot(), 1.0, most) for most in (100.0, 8.0))
    assert free[0] == pytest.approx([45.5, 45.5, 30.0], abs=1.5)
    assert bounded[:, 2].max() == 8.0
    assert (np.diff(free[:, 2]) <= 1e-6).all()


def test_what_is_too_fine_has_no_disc() -> None:
    line = np.zeros((20, 60), dtype=bool)
    line[10] = True
    assert cover_with_discs(line, 2.0, 10.0).shape == (0, 3)
    assert cover_with_discs(line[:0], 1.0, 10.0).shape == (0, 3)
