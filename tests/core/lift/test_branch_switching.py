import numpy as np
import pytest
from tests.sketched import Stroke, sketched

from treestroke.core.lift.branch_switching import align_switching
from treestroke.core.lift.params import RetrievalParams
from treestroke.core.lift.path_pairs import PathPair, PathTrie, align_paths
from treestroke.core.lift.retrieval import retrieve_depth
from treestroke.core.lift.sketch_tree import SketchTree, prepare_sketch

STEM = [(0.0, 300.0), (0.0, 1000.0)]
LIMB: Stroke = (0, 1, [(300.0, 800.0)])
LOW: Stroke = (0, 1, [(200.0, 500.0)])
HIGH: Stroke = (0, 1, [(100.0, 450.0), (120.0, 900.0)])
HANGING: Stroke = (0, 1, [(10.0, 960.0), (60.0, 990.0), (90.0, 500.0)])


def switched(*side: Stroke) -> tuple[PathPair, tuple[SketchTree, SketchTree]]:
    """Align a limb of the front with several of the side; the stems are paired."""
    sketches = prepare_sketch(sketched(STEM, LIMB), 6.0), prepare_sketch(sketched(STEM, *side), 6.0)
    trie = PathTrie(sketches)
    stems = align_paths(sketches, sketches[0].paths[0], sketches[1].paths[0])
    trie.insert(0, stems, np.zeros(stems.joints.shape[1], dtype=np.int64))
    path = sketches[0].paths[1]
    first = int(np.flatnonzero(path == sketches[0].branch_joints[1][0])[0])
    found = align_switching(trie, 0, path, first, RetrievalParams())
    assert found is not None
    return found, sketches


def test_a_limb_is_aligned_to_its_tip_at_equal_heights() -> None:
    found, (front, side) = switched(LOW, HIGH)
    assert set(front.branch_joints[1].tolist()) <= set(found.joints[0].tolist())
    assert found.joints[0, -1] == front.branch_joints[1][-1]
    assert side.branch[found.joints[1, -1]] == 2
    assert np.abs(found.apart).max() <= 4.0 + 3.0


def test_a_follower_crosses_gaps_in_a_straight_line_at_the_leader_s_heights() -> None:
    found, _ = switched(HANGING)
    assert found.switching.any()
    assert np.abs(np.diff(found.places[1, :, 0])).max() < 12.0
    assert found.places[1, found.switching, 1] == pytest.approx(found.places[0, found.switching, 1])
    assert found.unsupported[1].sum() > 0
    assert found.unsupported[0].sum() == 0


def test_joints_of_the_follower_that_were_crossed_are_not_used() -> None:
    found, sketches = switched(HANGING)
    trie = PathTrie(sketches)
    trie.insert(0, found, np.zeros(found.joints.shape[1], dtype=np.int64))
    only = set(found.joints[1, found.switching].tolist()) - set(found.joints[1, ~found.switching].tolist())
    assert not trie.used[1][sorted(only)].any()
    assert trie.used[0][found.joints[0]].all()


def test_the_stem_ends_where_it_was_drawn_to() -> None:
    short = [(0.0, 200.0), (0.0, 400.0)]
    sketch = sketched(short, (0, 2, [(300.0, 1000.0)]), (0, 2, [(-300.0, 1000.0)]))
    tree = retrieve_depth(sketch, sketch).tree
    assert tree.skeleton.points[tree.branch == 0, 1].max() == pytest.approx(400, abs=6)
