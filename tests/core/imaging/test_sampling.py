import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from treestroke.core.imaging.sampling import sample_nearest

GREY = np.arange(12).reshape(3, 4)


@given(st.integers(0, 2), st.integers(0, 3), st.floats(0, 0.999), st.floats(0, 0.999))
def test_each_point_reads_the_pixel_that_holds_it(row: int, column: int, down: float, right: float) -> None:
    assert sample_nearest(GREY, np.array([column + right, row + down]), -1) == GREY[row, column]


@pytest.mark.parametrize("point", [(-0.01, 1.0), (4.0, 1.0), (1.0, -0.01), (1.0, 3.0), (1e9, 1e9)])
def test_a_point_beyond_the_picture_reads_what_lies_outside(point: tuple[float, float]) -> None:
    assert sample_nearest(GREY, np.array(point), -7) == -7


def test_colours_keep_their_channels_and_points_their_shape() -> None:
    picture = np.random.default_rng(0).integers(1, 256, (5, 6, 3), dtype=np.uint8)
    points = np.array([[[0.5, 0.5], [5.5, 4.5], [9.0, 0.0]]])
    read = sample_nearest(picture, points, 0)
    assert read.shape == (1, 3, 3)
    assert read[0].tolist() == [picture[0, 0].tolist(), picture[4, 5].tolist(), [0, 0, 0]]


def test_a_mask_stays_a_mask() -> None:
    read = sample_nearest(GREY > 5, np.array([[0.5, 2.5], [-1.0, 0.0]]), False)
    assert read.dtype == bool
    assert read.tolist() == [True, False]
