import cv2
import numpy as np
import pytest

from treestroke.core.imaging.blur import broadly_blurred


def test_it_averages_as_a_gaussian_does() -> None:
    picture = np.random.default_rng(0).random((200, 300))
    exact = cv2.GaussianBlur(picture, (0, 0), 15.0, borderType=cv2.BORDER_REPLICATE)
    assert np.abs(broadly_blurred(picture, 15.0) - exact)[20:-20, 20:-20].max() < 0.01


@pytest.mark.parametrize(("beyond", "corner"), [(cv2.BORDER_REPLICATE, 1.0), (cv2.BORDER_CONSTANT, 0.35)])
def test_beyond_the_border_is_its_nearest_pixel_or_nothing(beyond: int, corner: float) -> None:
    assert broadly_blurred(np.ones((90, 120)), 12.0, beyond)[0, 0] == pytest.approx(corner, abs=0.1)


def test_a_blur_of_less_than_a_pixel_leaves_the_size() -> None:
    assert broadly_blurred(np.eye(3), 0.5).shape == (3, 3)
