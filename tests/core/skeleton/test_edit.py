import numpy as np
import pytest
from tests.builders import oak

from treestroke.core.skeleton.edit import densified, subskeleton
from treestroke.core.skeleton.measure import edge_lengths, path_lengths


@pytest.mark.parametrize("step", [0.05, 0.4, 100.0])
def test_denser_joints_keep_the_old_ones_and_the_length(step: float) -> None:
    tree = oak()
    dense, owner = densified(tree, step)
    last = np.searchsorted(owner, np.arange(len(tree)), side="right") - 1
    assert np.allclose(dense.points[last], tree.points)
    assert np.allclose(dense.radii[last], tree.radii)
    assert np.allclose(path_lengths(dense)[last], path_lengths(tree))
    assert edge_lengths(dense).max() <= step + 1e-9


def test_a_subskeleton_keeps_joints_and_their_parents() -> None:
    tree = oak()
    kept = path_lengths(tree) < 0.6 * path_lengths(tree).max()
    part, joints = subskeleton(tree, kept)
    assert joints.tolist() == np.flatnonzero(kept).tolist()
    assert np.array_equal(part.points, tree.points[kept])
    assert np.array_equal(part.radii, tree.radii[kept])
    assert np.array_equal(joints[part.parents[1:]], tree.parents[joints[1:]])
