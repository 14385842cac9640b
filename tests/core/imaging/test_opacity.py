import numpy as np
import pytest

from treestroke.core.imaging.opacity import over_white


def test_opaque_pixels_stay_and_transparent_ones_are_white() -> None:
    picture = np.random.default_rng(0).integers(0, 256, (300, 7, 4), dtype=np.uint8)
    picture[:150, :, 3], picture[150:, :, 3] = 255, 0
    laid = over_white(picture)
    assert np.array_equal(laid[:150], picture[:150, :, :3])
    assert (laid[150:] == 255).all()


@pytest.mark.parametrize("alpha", [1, 77, 128, 254])
def test_every_value_is_blended_to_the_nearest(alpha: int) -> None:
    values = np.arange(256)
    picture = np.dstack([values, values, values, np.full(256, alpha)]).astype(np.uint8)
    wanted = values * alpha / 255 + 255 - alpha
    assert np.abs(over_white(picture)[0, :, 0] - wanted).max() <= 0.5


def test_a_picture_without_alpha_is_returned_as_it_is() -> None:
    picture = np.zeros((4, 5, 3), np.uint8)
    assert over_white(picture) is picture
