import numpy as np
import pytest
from tests.sketched import Stroke, sketched

from treestroke.core.lift.pairing import ALONE, FEATURES, Search, detour
from treestroke.core.lift.path_pairs import Weave
from treestroke.core.lift.sheet import Sheet, sheet

STEM = [(0.0, 300.0), (0.0, 600.0), (0.0, 1000.0)]
LOW: Stroke = (0, 1, [(200.0, 450.0)])
HIGH: Stroke = (0, 2, [(200.0, 900.0)])
HANGING: Stroke = (0, 2, [(150.0, 650.0), (200.0, 100.0)])


def drawn(*strokes: Stroke) -> Sheet:
    return sheet(sketched(STEM, *strokes), 6.0)


def search(front: Sheet, side: Sheet, number: int) -> Search:
    """Seek partners for a branch of the front, the stems being paired."""
    weave = Weave((front, side), (np.zeros(len(front.points), dtype=bool), np.zeros(len(side.points), dtype=bool)))
    stems = Search(weave, 0, 0, front.own[0], 10.0).best(set(), 3)
    weave.lay(0, stems.walk, np.zeros(stems.walk.joints.shape[1], dtype=np.int64))
    return Search(weave, 0, number, front.own[number], 10.0)


def test_a_limb_is_answered_by_the_one_at_its_heights() -> None:
    side = drawn(LOW, HIGH)
    for number, stroke in enumerate((LOW, HIGH), start=1):
        best = search(drawn(stroke), side, 1).best(set(), 3)
        assert best.other == number
        assert np.abs(best.walk.apart).max() <= 6.0


def test_what_was_tried_is_not_tried_again() -> None:
    tried = {0, 1}
    best = search(drawn(LOW), drawn(LOW), 1).best(tried, 3)
    assert best.other == ALONE
    assert tried == {0, 1, ALONE}


def test_of_two_at_its_heights_the_one_of_like_family_height_is_preferred() -> None:
    tall, short = (0, 1, [(-100.0, 500.0)]), (0, 1, [(-100.0, 500.0), (-150.0, 950.0)])
    unlike = search(drawn((0, 1, [(100.0, 500.0)])), drawn(tall, short), 1).features()
    assert unlike[1] < unlike[2]
    assert unlike[1] < unlike[0]


def test_a_partner_s_thickness_counts_where_brushes_tell_it() -> None:
    limb = (0, 1, [(1.0, 301.0), (200.0, 450.0)])
    side = sheet(sketched(STEM, limb, limb, radii=(20.0, 10.0, 4.0)), 6.0)
    told, untold = (
        search(sheet(sketched(STEM, limb, radii=radii), 6.0), side, 1).features() for radii in ((20.0, 10.0), ())
    )
    assert told[2] - told[1] == pytest.approx(FEATURES * 10.0 * 6.0)
    assert untold[2] == untold[1]


def test_a_path_leads_past_its_bud_up_to_a_height_and_back() -> None:
    sheet_ = drawn(HANGING)
    path = detour(sheet_, 1, 800.0)
    heights = sheet_.points[path, 1]
    assert heights.max() == pytest.approx(800, abs=6)
    assert np.abs(np.diff(heights)).max() <= 6.0 + 1e-9
    assert path[-1] == sheet_.paths[1][-1]


def test_without_anything_above_its_bud_a_path_stays() -> None:
    sheet_ = drawn(HANGING)
    assert np.array_equal(detour(sheet_, 1, 1200.0), sheet_.paths[1])
