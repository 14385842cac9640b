"""Small networks whose shortest paths are known."""

from itertools import pairwise

import numpy as np
import pytest

from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.trace.limb_paths import HEADING_PX, WINDING, Network, join_strokes, shortest_paths
from treestroke.core.trace.ribbons import Ribbons

SIZE = 120
STEM = Skeleton(np.array([[60.5, 110.5], [60.5, 20.5]]), np.array([4.0, 4.0]), np.array([-1, 0]))
LEAVES = np.ones((SIZE, SIZE), dtype=bool)


def level(row: int, start: int, end: int) -> np.ndarray:
    """A line of pixels along a row."""
    return np.column_stack([np.full(end - start, row), np.arange(start, end)])


def network(*lines: np.ndarray) -> Network:
    pixels = np.concatenate(lines)
    return join_strokes(Ribbons(pixels, np.full(len(pixels), 1.5)), STEM, (SIZE, SIZE))


def way_to(place: tuple[int, int], net: Network, leafy: np.ndarray = LEAVES) -> tuple[list[tuple[int, int]], float]:
    """The pixels from a stroke to a place (row, column), and the gaps' length in all."""
    paths = shortest_paths(net, leafy, 100.0)
    pixel = int(np.flatnonzero((net.ribbons.pixels == place).all(axis=1))[0])
    way, gaps = [pixel], 0.0
    while paths.before[way[-1]] >= 0:
        gaps += paths.gap[way[-1]]
        way.append(int(paths.before[way[-1]]))
    return [tuple(net.ribbons.pixels[at].tolist()) for at in way[::-1]], gaps


def test_ribbons_in_the_wood_of_a_stroke_are_its_own() -> None:
    net = network(level(60, 55, 80))
    along = net.ribbons.pixels[:, 0] == 60
    assert net.stroked[along & (net.ribbons.pixels[:, 1] <= 64)].all()
    assert not net.stroked[along & (net.ribbons.pixels[:, 1] > 67)].any()


def test_a_ribbon_that_touches_is_reached_along_wood() -> None:
    way, gaps = way_to((60, 95), network(level(60, 60, 100)))
    assert gaps == 0.0
    assert [column for _, column in way] == list(range(way[0][1], 96))


def test_a_gap_is_crossed_once_and_straight() -> None:
    way, gaps = way_to((60, 99), network(level(60, 60, 75), level(60, 83, 100)))
    assert gaps == pytest.approx(9.0, abs=1.0)
    assert (60, 90) in way


def test_a_gap_longer_than_a_limb_may_hide_is_not_crossed() -> None:
    net = network(level(60, 80, 100))
    paths = shortest_paths(net, LEAVES, 100.0)
    assert net.stroked[paths.order].all()


def test_a_ribbon_is_entered_by_its_end_rather_than_from_its_side() -> None:
    upright = np.column_stack([np.arange(40, 70), np.full(30, 86)])
    way, _ = way_to((45, 86), network(level(74, 60, 86), level(55, 60, 78), upright))
    assert (74, 80) in way
    assert (55, 75) not in way


def test_a_way_before_the_sky_costs_more_than_one_behind_leaves() -> None:
    sky = LEAVES.copy()
    sky[50:62, 66:90] = False
    lines = (level(56, 60, 70), level(64, 60, 68), level(60, 76, 100))
    assert (56, 67) in way_to((60, 99), network(*lines))[0]
    assert (64, 66) in way_to((60, 99), network(*lines), sky)[0]


@pytest.mark.parametrize("start", [66, 70])
def test_a_ribbon_is_not_entered_at_the_end_from_which_it_leads_back(start: int) -> None:
    way, _ = way_to((64, 91), network(level(60, 60, 80), level(64, start, 92)))
    assert all(after[1] >= before[1] for before, after in pairwise(way))


def test_the_more_a_limb_turns_at_a_gap_the_shorter_that_is() -> None:
    upright = np.column_stack([np.arange(20, 90), np.full(70, 74)])
    straight, across = network(level(50, 74, 100)), network(upright)
    assert not straight.stroked[shortest_paths(straight, LEAVES, 130.0).order].all()
    assert across.stroked[shortest_paths(across, LEAVES, 130.0).order].all()


def test_a_way_that_winds_ends() -> None:
    turn = np.linspace(0.0, 5.5, 400)
    spiral = np.unique(np.column_stack([60 - 22 * np.sin(turn), 84 - 22 * np.cos(turn)]).astype(int), axis=0)
    net = network(level(60, 60, 63), spiral)
    paths = shortest_paths(net, LEAVES, 100.0)
    length, start = np.zeros(len(paths.before)), np.arange(len(paths.before))
    for pixel in paths.order[paths.before[paths.order] >= 0]:
        before = paths.before[pixel]
        length[pixel] = length[before] + np.hypot(*(net.ribbons.points[pixel] - net.ribbons.points[before]))
        start[pixel] = start[before]
    straight = np.hypot(*(net.ribbons.points - net.ribbons.points[start]).T)
    assert (length <= WINDING * straight + HEADING_PX).all()
    assert 40 < length.max() < 110
