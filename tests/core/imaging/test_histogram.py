import numpy as np
import pytest

from treestroke.core.imaging.histogram import median_of_bytes


@pytest.mark.parametrize("count", [1, 2, 3, 10, 999, 1000])
def test_the_median_of_bytes_equals_numpys(count: int) -> None:
    values = np.random.default_rng(count).integers(0, 256, count).astype(np.uint8)

    assert median_of_bytes(values) == np.median(values)


def test_the_median_lies_between_two_values_that_share_the_middle() -> None:
    assert median_of_bytes(np.array([0, 255, 0, 255], np.uint8)) == 127.5
