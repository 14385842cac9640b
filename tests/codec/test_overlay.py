import numpy as np

from treestroke.codec.overlay import draw_overlay
from treestroke.core.skeleton.skeleton import Skeleton

GREY = np.full((60, 80, 3), 128, dtype=np.uint8)


def test_foliage_is_tinted_and_the_rest_stays() -> None:
    foliage = np.zeros((60, 80), dtype=bool)
    foliage[:30] = True
    picture = draw_overlay(GREY, foliage, None, np.empty(0, dtype=np.int64))
    assert (picture[30:] == 128).all()
    assert (picture[:30, :, 1] > 140).all()


def test_drawn_and_found_branches_differ_in_colour() -> None:
    skeleton = Skeleton(np.array([[20.0, 55], [20, 30], [60, 30]]), np.full(3, 3.0), np.array([-1, 0, 1]))
    picture = draw_overlay(GREY, np.zeros((60, 80), dtype=bool), skeleton, np.array([0, 0, -1]))
    assert picture[45, 20].tolist() == [255, 214, 64]
    assert picture[30, 45].tolist() == [255, 96, 64]
