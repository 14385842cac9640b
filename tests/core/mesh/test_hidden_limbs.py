import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.builders import fork, oak
from tests.pieces import touching_pieces

from treestroke.core.mesh.hidden_limbs import without_hidden_limbs
from treestroke.core.mesh.limb_axes import limb_axes
from treestroke.core.mesh.tubes import TubeParams, tubes
from treestroke.core.skeleton.skeleton import Skeleton


def trunk_with(line: list[list[float]], radius: float = 0.03) -> Skeleton:
    """Build a trunk, 0.4 m thick, with a line of joints at 2 m."""
    trunk = [[0, 0, 0], [0, 1, 0], [0, 2, 0], [0, 3, 0], [0, 4, 0]]
    radii = [0.2] * 5 + [radius] * len(line)
    parents = [-1, 0, 1, 2, 3, 2, *range(5, 4 + len(line))]
    return Skeleton(np.array(trunk + line, dtype=np.float64), np.array(radii), np.array(parents))


def hooked(turn: float) -> Skeleton:
    """Build a limb with a straight stretch, whose last joint turns back sharply, and thin twigs along the stretch."""
    limb = [[0.25 * i, 2, 0] for i in range(1, 13)] + [[3.0 + 0.05 * np.cos(turn), 2 + 0.05 * np.sin(turn), 0]]
    tree = trunk_with(limb, radius=0.012)
    twigs = [[0.25 * i, 2.2, 0.1] for i in range(2, 12)]
    return Skeleton(
        np.vstack([tree.points, twigs]),
        np.concatenate([tree.radii, np.full(10, 0.004)]),
        np.concatenate([tree.parents, np.arange(6, 16)]),
    )


@pytest.mark.parametrize("end", [[0.1, 2.05, 0], [0.0, 2.9, 0.1]])
def test_a_limb_that_ends_inside_its_parent_has_no_tube(end: list[float]) -> None:
    assert len(without_hidden_limbs(limb_axes(trunk_with([end]), 1e-4)).parent_radius) == 1
    assert touching_pieces(tubes(trunk_with([end]))) == 1


def test_a_limb_that_leaves_its_parent_stays_with_all_limbs_that_lead_to_it() -> None:
    tree = trunk_with([[0.1, 2.05, 0], [0.1, 2.1, 0], [1.0, 2.4, 0]])
    parents = tree.parents.copy()
    parents[7] = 5  # a hidden stub of two joints, and a limb out of its middle
    axes = limb_axes(Skeleton(tree.points, tree.radii, parents), 1e-4)
    assert len(without_hidden_limbs(axes).parent_radius) == len(axes.parent_radius)


@pytest.mark.parametrize("tree", [fork(), oak()])
def test_visible_limbs_stay(tree: Skeleton) -> None:
    axes = limb_axes(tree, 1e-4)
    assert np.array_equal(without_hidden_limbs(axes).joint, axes.joint)


@pytest.mark.parametrize("turn", [-1.2, -1.6, -2.4])
def test_twigs_stand_on_a_limb_that_turns_sharply_after_a_straight_stretch(turn: float) -> None:
    assert touching_pieces(tubes(hooked(turn))) == 1


def any_tapering_tree(seed: int) -> Skeleton:
    """Build a tree of joints near and far, straight on and back again, that gets thinner outward."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 50))
    points, radii = np.zeros((count, 3)), np.full(count, rng.uniform(0.01, 0.2))
    parents = np.array([-1] + [int(rng.integers(max(0, i - 9), i)) for i in range(1, count)])
    for i in range(1, count):
        points[i] = points[parents[i]] + rng.normal(0.0, 0.4, 3) * rng.choice([0.1, 1.0])
        radii[i] = radii[parents[i]] * rng.uniform(0.4, 1.0)
    return Skeleton(points, radii, parents)


@given(st.integers(0, 100_000))
@settings(max_examples=20, deadline=None)
def test_bark_is_one_piece_whatever_the_tree(seed: int) -> None:
    assert touching_pieces(tubes(any_tapering_tree(seed), TubeParams(max_triangles=4_000))) == 1
