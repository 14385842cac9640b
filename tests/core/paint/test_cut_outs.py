import numpy as np
import pytest
from tests.core.paint.drawn import PURPLE, leaf_picture

from treestroke.core.paint.cut_outs import (
    LONGEST_PX,
    SOLID_ALPHA,
    mean_lab,
    mean_solid_colour,
    opaque_part,
    reduced,
    resized_premultiplied,
)
from treestroke.core.paint.palette import lab_from_rgb


def test_the_opaque_part_is_cut_out():
    picture = np.zeros((50, 60, 4), np.uint8)
    picture[10:30, 20:25, 3] = 255
    assert opaque_part(picture).shape == (20, 5, 4)


def test_a_large_picture_is_shrunk_without_the_colour_of_what_is_clear():
    small = reduced(opaque_part(leaf_picture(2000)))
    assert max(small.shape) == LONGEST_PX
    assert np.abs(small[small[..., 3] > 10][:, :3].astype(int) - PURPLE).max() < 20


@pytest.mark.parametrize("side", [40, 300])
def test_resizing_lets_transparent_pixels_add_no_colour(side):
    resized = resized_premultiplied(leaf_picture(100), side, side)
    opaque = resized[resized[..., 3] > 0.1]
    assert np.abs(opaque[:, :3] / opaque[:, 3:] - PURPLE).max() < 1


def test_mean_colours_are_those_of_what_the_picture_shows():
    picture = leaf_picture()
    assert mean_solid_colour(picture) == pytest.approx(PURPLE)
    assert mean_lab(picture) == pytest.approx(lab_from_rgb(np.array([PURPLE], np.uint8))[0])


def test_edges_give_no_solid_colour():
    picture = np.full((2, 2, 4), 255, np.uint8)
    picture[0] = (0, 0, 0, SOLID_ALPHA - 1)
    assert mean_solid_colour(picture).tolist() == [255, 255, 255]
