"""Visual hulls of balls from mattes that follow from geometry."""

import numpy as np
import pytest
from tests.core.carve.walk import Ball, ball_points, matte, sees, shot, walk

from treestroke.core.capture import TreeMatte
from treestroke.core.carve.visual_hull import VisualHull, hull_top, visual_hull
from treestroke.core.errors import StrokesError

CROWN: Ball = ((0.2, 3.0, -0.1), 1.2)
OTHER: Ball = ((0.2, 3.0, 2.3), 0.5)
LIMB: list[Ball] = [((0.2, 3.0, z), 0.06) for z in np.arange(1.0, 1.9, 0.05)]


@pytest.fixture(scope="module")
def plain() -> VisualHull:
    """The hull of the crown alone."""
    return hull_of([CROWN], count=16)


def hull_of(balls: list[Ball], count: int = 12, changed: dict[int, TreeMatte] | None = None) -> VisualHull:
    cameras = walk(count, 360)
    mattes = [(changed or {}).get(index, matte(sees(camera, balls))) for index, camera in enumerate(cameras)]
    return visual_hull([shot(camera) for camera in cameras], mattes)


def test_the_hull_holds_what_the_mattes_show_and_little_more(plain: VisualHull) -> None:
    cubic_metres = np.count_nonzero(plain.cells.filled) * plain.cells.side**3
    assert plain.inside(ball_points(CROWN, 0.99, np.random.default_rng(0))).all()
    assert 1.0 < cubic_metres / (4 / 3 * np.pi * CROWN[1] ** 3) < 1.25
    assert plain.height == pytest.approx(4.2, abs=0.15)


@pytest.mark.parametrize("balls", [[CROWN], [CROWN, OTHER, *LIMB]])
def test_the_top_is_that_of_the_whole_hull(balls: list[Ball]) -> None:
    cameras = walk(12, 360)
    top = hull_top([shot(camera) for camera in cameras], [matte(sees(camera, balls)) for camera in cameras])
    assert top == pytest.approx(hull_of(balls).height, abs=0.05)
    assert top == pytest.approx(4.2, abs=0.1)


def test_a_thin_limb_stays_and_the_gap_around_it_is_empty() -> None:
    hull = hull_of([CROWN, OTHER, *LIMB])
    assert hull.inside(np.array([middle for middle, _ in LIMB])).all()
    assert hull.inside(ball_points(OTHER, 0.9, np.random.default_rng(0))).all()
    assert not hull.inside(np.array([[0.2, 3.4, 1.45], [0.2, 2.6, 1.45]])).any()


def test_an_empty_matte_is_left_out() -> None:
    hull = hull_of([CROWN], changed={3: matte(np.zeros((200, 160), dtype=bool))})
    assert hull.good.tolist() == [index != 3 for index in range(12)]
    assert hull.inside(ball_points(CROWN, 0.99, np.random.default_rng(0))).all()


def test_a_limb_that_one_matte_lacks_stays() -> None:
    hull = hull_of([CROWN, OTHER, *LIMB], changed={3: matte(sees(walk(12, 360)[3], [CROWN]))})
    assert hull.good.all()
    assert hull.inside(ball_points(OTHER, 0.9, np.random.default_rng(0))).all()


def test_pixels_behind_something_say_nothing() -> None:
    changed = {}
    for index in (2, 5, 8):
        seen = sees(walk(12, 360)[index], [CROWN])
        half = np.arange(160)[None] < 80
        changed[index] = TreeMatte((seen & ~half).astype(np.float32), np.zeros((200, 160), np.float32), seen & half)
    hull = hull_of([CROWN], changed=changed)
    assert hull.good.all()
    assert hull.inside(ball_points(CROWN, 0.99, np.random.default_rng(0))).all()


def test_the_share_outside_grows_with_the_mattes_that_miss_a_point(plain: VisualHull) -> None:
    shares = plain.share_outside(np.array([CROWN[0], (0.2, 3.0, 1.6), (0.2, 4.9, -0.1), (0.0, 50.0, 0.0)]))
    assert shares[0] == 0
    assert 0.2 < shares[1] < 0.95
    assert shares[2:].tolist() == [1, 1]
    near = np.array([[0.2, 4.4, -0.1]])
    assert plain.share_outside(near, 0.4)[0] < 0.1 < plain.share_outside(near)[0]


def test_noise_in_the_mattes_does_not_change_the_hull_much(plain: VisualHull) -> None:
    rng = np.random.default_rng(1)
    changed = {
        index: matte(sees(camera, [CROWN]) ^ (rng.random((200, 160)) < 0.02))
        for index, camera in enumerate(walk(16, 360))
    }
    noisy = hull_of([CROWN], 16, changed).cells
    sizes = [np.count_nonzero(cells.filled) * cells.side**3 for cells in (plain.cells, noisy)]
    assert sizes[1] == pytest.approx(sizes[0], rel=0.1)


def test_mattes_that_agree_on_nothing_are_refused() -> None:
    cameras = walk(4, 360)
    empty = [matte(np.zeros((200, 160), dtype=bool))] * 4
    with pytest.raises(StrokesError, match="do not agree on where the tree stands"):
        visual_hull([shot(camera) for camera in cameras], empty)
    with pytest.raises(ValueError, match="three shots"):
        visual_hull([shot(camera) for camera in cameras[:2]], empty[:2])
