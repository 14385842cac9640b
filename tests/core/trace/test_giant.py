import numpy as np
import pytest
from tests.pictures import wood_mask

from treestroke.core.geometry.polyline import resample
from treestroke.core.trace.giant import fork_of, is_giant, upright

HEIGHT, USUAL = 400.0, 26.0
LINE = resample(np.array([[180.0, 440.0], [180.0, 300.0], [160.0, 120.0]]), 3.0)
BARE = LINE[:, 1] > 300
TRUNK = wood_mask([([(220.0, 460.0), (220.0, 290.0)], 180.0), ([(160.0, 320.0), (160.0, 100.0)], 30.0)], 450, 450)


def test_a_trunk_many_times_thicker_than_usual_is_a_giant() -> None:
    assert is_giant(LINE[BARE], TRUNK, USUAL, HEIGHT)
    assert not is_giant(LINE[BARE], wood_mask([(LINE, 40.0)], 450, 450), USUAL, HEIGHT)


def test_wood_without_sides_is_no_giant() -> None:
    assert not is_giant(LINE[BARE], np.ones((450, 450), dtype=bool), USUAL, HEIGHT)


def test_a_giant_stands_in_the_middle_of_its_wood_whatever_stands_before_it() -> None:
    posts = TRUNK.copy()
    posts[380:, 250:262] = False
    line, halves = upright(LINE, BARE, posts, HEIGHT)
    assert line[0, 0] == pytest.approx(220.0, abs=3.0)
    assert np.nanmedian(halves) == pytest.approx(90.0, abs=3.0)
    assert np.isnan(halves[~BARE]).all()
    assert line[-1] == pytest.approx(LINE[-1], abs=1.0)


def test_a_limb_rises_from_a_giant_as_it_leaves_it() -> None:
    axis = resample(np.array([[220.0, 440.0], [220.0, 240.0]]), 4.0)
    limb = resample(np.array([[310.0, 300.0], [370.0, 240.0]]), 4.0)
    assert axis[fork_of(limb, axis, 20.0), 1] == pytest.approx(390.0, abs=5.0)


def test_a_limb_stays_above_the_ground() -> None:
    axis = resample(np.array([[220.0, 440.0], [220.0, 240.0]]), 4.0)
    steep = resample(np.array([[310.0, 420.0], [330.0, 340.0]]), 4.0)
    assert axis[fork_of(steep, axis, 20.0), 1] <= 420.0
