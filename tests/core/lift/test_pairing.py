import numpy as np
import pytest
from tests.sketched import Stroke, sketched

from treestroke.core.lift.pairing import UNMATCHED, PartnerSearch, detour
from treestroke.core.lift.params import RetrievalParams
from treestroke.core.lift.path_pairs import PathTrie
from treestroke.core.lift.sketch_tree import SketchTree, prepare_sketch

STEM = [(0.0, 300.0), (0.0, 600.0), (0.0, 1000.0)]
LOW: Stroke = (0, 1, [(200.0, 450.0)])
HIGH: Stroke = (0, 2, [(200.0, 900.0)])
HANGING: Stroke = (0, 2, [(150.0, 650.0), (200.0, 100.0)])


def drawn(*strokes: Stroke) -> SketchTree:
    return prepare_sketch(sketched(STEM, *strokes), 6.0)


def search(front: SketchTree, side: SketchTree, number: int) -> PartnerSearch:
    """Search partners for a branch of the front; the stems are paired."""
    trie = PathTrie((front, side))
    stems = PartnerSearch(trie, 0, 0, front.branch_joints[0], RetrievalParams()).best(set())
    trie.insert(0, stems.pair, np.zeros(stems.pair.joints.shape[1], dtype=np.int64))
    return PartnerSearch(trie, 0, number, front.branch_joints[number], RetrievalParams())


def test_a_limb_pairs_with_the_one_at_its_heights() -> None:
    side = drawn(LOW, HIGH)
    for number, stroke in enumerate((LOW, HIGH), start=1):
        best = search(drawn(stroke), side, 1).best(set())
        assert best.partner == number
        assert np.abs(best.pair.apart).max() <= 6.0


def test_a_branch_that_was_tried_is_not_tried_again() -> None:
    tried = {0, 1}
    best = search(drawn(LOW), drawn(LOW), 1).best(tried)
    assert best.partner == UNMATCHED
    assert tried == {0, 1, UNMATCHED}


def test_of_two_at_its_heights_the_one_of_like_family_height_is_preferred() -> None:
    tall, short = (0, 1, [(-100.0, 500.0)]), (0, 1, [(-100.0, 500.0), (-150.0, 950.0)])
    unlike = search(drawn((0, 1, [(100.0, 500.0)])), drawn(tall, short), 1).feature_costs()
    assert unlike[1] < unlike[2]
    assert unlike[1] < unlike[0]


def test_a_partner_s_thickness_counts_where_brushes_tell_it() -> None:
    limb = (0, 1, [(1.0, 301.0), (200.0, 450.0)])
    side = prepare_sketch(sketched(STEM, limb, limb, radii=(20.0, 10.0, 4.0)), 6.0)
    told, untold = (
        search(prepare_sketch(sketched(STEM, limb, radii=radii), 6.0), side, 1).feature_costs()
        for radii in ((20.0, 10.0), ())
    )
    assert told[2] - told[1] == pytest.approx(RetrievalParams().feature_weight * 10.0 * 6.0)
    assert untold[2] == untold[1]


def test_a_path_leads_past_its_bud_up_to_a_height_and_back() -> None:
    tree = drawn(HANGING)
    path = detour(tree, 1, 800.0)
    heights = tree.points[path, 1]
    assert heights.max() == pytest.approx(800, abs=6)
    assert np.abs(np.diff(heights)).max() <= 6.0 + 1e-9
    assert path[-1] == tree.paths[1][-1]


def test_a_path_with_nothing_above_its_bud_makes_no_detour() -> None:
    tree = drawn(HANGING)
    assert np.array_equal(detour(tree, 1, 1200.0), tree.paths[1])
