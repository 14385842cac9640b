import numpy as np
import pytest
from tests.sketched import Stroke, sketched

from treestroke.core.lift.path_pairs import Walk, Weave, walk
from treestroke.core.lift.retrieval import retrieve_depth
from treestroke.core.lift.sheet import Sheet, sheet
from treestroke.core.lift.straying import stray

STEM = [(0.0, 300.0), (0.0, 1000.0)]
LIMB: Stroke = (0, 1, [(300.0, 800.0)])
LOW: Stroke = (0, 1, [(200.0, 500.0)])
HIGH: Stroke = (0, 1, [(100.0, 450.0), (120.0, 900.0)])
HANGING: Stroke = (0, 1, [(10.0, 960.0), (60.0, 990.0), (90.0, 500.0)])


def strayed(*side: Stroke) -> tuple[Walk, tuple[Sheet, Sheet]]:
    """Let a limb of the front, the stems being paired, stray over the side's."""
    sheets = sheet(sketched(STEM, LIMB), 6.0), sheet(sketched(STEM, *side), 6.0)
    weave = Weave(sheets, (np.zeros(len(sheets[0].points), dtype=bool), np.zeros(len(sheets[1].points), dtype=bool)))
    stems = walk(sheets, sheets[0].paths[0], sheets[1].paths[0])
    weave.lay(0, stems, np.zeros(stems.joints.shape[1], dtype=np.int64))
    chain = sheets[0].paths[1]
    first = int(np.flatnonzero(chain == sheets[0].own[1][0])[0])
    found = stray(weave, 0, chain, first, len(chain))
    assert found is not None
    return found, sheets


def test_a_limb_is_walked_to_its_tip_at_equal_heights() -> None:
    found, (front, side) = strayed(LOW, HIGH)
    assert set(front.own[1].tolist()) <= set(found.joints[0].tolist())
    assert found.joints[0, -1] == front.own[1][-1]
    assert side.branch[found.joints[1, -1]] == 2
    assert np.abs(found.apart).max() <= 4.0 + 3.0


def test_a_follower_crosses_over_aslant_at_the_leader_s_heights() -> None:
    found, _ = strayed(HANGING)
    assert found.strayed.any()
    assert np.abs(np.diff(found.places[1, :, 0])).max() < 12.0
    assert found.places[1, found.strayed, 1] == pytest.approx(found.places[0, found.strayed, 1])
    assert found.invented[1].sum() > 0
    assert found.invented[0].sum() == 0


def test_what_was_crossed_over_stands_for_nothing_of_the_follower_s() -> None:
    found, sheets = strayed(HANGING)
    weave = Weave(sheets, (np.zeros(len(sheets[0].points), dtype=bool), np.zeros(len(sheets[1].points), dtype=bool)))
    weave.lay(0, found, np.zeros(found.joints.shape[1], dtype=np.int64))
    only = set(found.joints[1, found.strayed].tolist()) - set(found.joints[1, ~found.strayed].tolist())
    assert not weave.used[1][sorted(only)].any()
    assert weave.used[0][found.joints[0]].all()


def test_the_stem_ends_where_it_was_drawn_to() -> None:
    short = [(0.0, 200.0), (0.0, 400.0)]
    sketch = sketched(short, (0, 2, [(300.0, 1000.0)]), (0, 2, [(-300.0, 1000.0)]))
    tree = retrieve_depth(sketch, sketch).tree
    assert tree.skeleton.points[tree.branch == 0, 1].max() == pytest.approx(400, abs=6)
