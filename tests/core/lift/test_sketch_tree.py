import numpy as np
import pytest
from tests.sketched import broadleaf, sketched

from treestroke.core.lift.sketch_tree import BIN, BINS, LOWEST, prepare_sketch

STEM = [(0.0, 300.0), (0.0, 600.0), (0.0, 1000.0)]
FORKED = sketched(STEM, (0, 1, [(300.0, 500.0)]), (1, 0, [(400.0, 900.0)]), (0, 2, [(-200.0, 100.0), (-250.0, -50.0)]))


def test_joints_are_at_most_a_step_apart_and_lie_on_the_strokes() -> None:
    sketch = broadleaf(5, 3)
    found = prepare_sketch(sketch, 6.0)
    assert found.lengths.max() <= 6.0 + 1e-9
    drawn = sketch.skeleton.points
    assert np.hypot(*(found.points - drawn[found.source_joint]).T).max() < 8.0
    chains = sketch.chains()
    assert all(given in chains[number] for given, number in zip(found.source_joint, found.branch, strict=True))


def test_a_family_s_heights_are_those_of_all_its_branches() -> None:
    found = prepare_sketch(FORKED, 6.0)
    assert found.level.tolist() == [0, 1, 2, 1]
    assert found.top[:3] == pytest.approx([1000, 500, 900])
    assert found.family_top[:3] == pytest.approx([1000, 900, 900])
    assert found.family_lowest[[0, 3]] == pytest.approx([-50, -50])
    assert found.family_length[0] == pytest.approx(found.lengths.sum())


def test_branches_come_by_level_and_the_longest_family_first() -> None:
    assert prepare_sketch(FORKED, 6.0).order() == [0, 1, 3, 2]


def test_paths_lead_from_the_root_to_each_tip() -> None:
    found = prepare_sketch(FORKED, 6.0)
    for path, tip in zip(found.paths, [(0, 1000), (300, 500), (400, 900), (-250, -50)], strict=True):
        assert (found.parents[path[1:]] == path[:-1]).all()
        assert found.points[path[0]] == pytest.approx([0, 0])
        assert found.points[path[-1]] == pytest.approx(tip)


def test_lengths_by_height_hold_all_that_is_chosen() -> None:
    found = prepare_sketch(FORKED, 6.0)
    chosen = found.points[:, 1] > 400
    total = found.lengths_by_height(chosen)
    assert total.sum(axis=1) == pytest.approx([found.lengths[chosen & (found.branch == b)].sum() for b in range(4)])
    assert total.shape == (4, BINS)
    assert not total[:, : int((400 - LOWEST) // BIN)].any()


def test_aside_is_measured_from_the_stem_at_that_height() -> None:
    leaning = sketched([(200.0, 500.0), (200.0, 1000.0)], (0, 1, [(260.0, 700.0)]))
    found = prepare_sketch(leaning, 6.0)
    limb = found.branch_joints[1]
    assert found.aside[limb] == pytest.approx(found.points[limb, 0] - 200)
    assert found.aside[found.branch_joints[0]] == pytest.approx(0)
