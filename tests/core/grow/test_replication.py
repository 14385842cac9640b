from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial import cKDTree
from tests.builders import fork, oak

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.replication import CrownBounds, ReplicationParams, grow_hidden
from treestroke.core.grow.replication_blocks import NO_SHOOT, replication_blocks
from treestroke.core.types import Floats, Mask

CAMERA = OrthographicCamera(400, 600, 0.01, (200.0, 590.0))
MIDDLE, RADIUS = np.array([0.5, 4.0, 0.0]), 1.4


@dataclass(frozen=True)
class Ball:
    """A crown that is a ball; only what growth asks of a crown."""

    bounds: Floats

    def inside(self, points: Floats) -> Mask:
        return np.asarray(np.linalg.norm(points - MIDDLE, axis=1) < 0.8 * RADIUS)

    def admits(self, points: Floats) -> Mask:
        return np.asarray(np.linalg.norm(points - MIDDLE, axis=1) < RADIUS)


def bounds(columns: slice = slice(None)) -> CrownBounds:
    """Bound growth by the ball, and by a front view that shows some columns."""
    mask = np.zeros((600, 400), dtype=bool)
    mask[:, columns] = True
    box = np.stack([MIDDLE - RADIUS, MIDDLE + RADIUS])
    return CrownBounds(Ball(box), [Silhouette(mask, CAMERA)], leaves(), 5.4)  # type: ignore[arg-type]


def leaves() -> Floats:
    """Scatter leaf points over the upper half of the ball's surface."""
    directions = np.random.default_rng(3).normal(size=(400, 3))
    directions[:, 1] = np.abs(directions[:, 1])
    return MIDDLE + 0.85 * RADIUS * directions / np.linalg.norm(directions, axis=1)[:, None]


def grown(params: ReplicationParams | None = None, limits: CrownBounds | None = None) -> Grown:
    """Grow a fork, 3.6 m high, into the ball."""
    params = params or ReplicationParams()
    return grow_hidden(fork(), limits or bounds(), params, np.random.default_rng(5))


def test_branches_grow_to_where_leaves_were_measured() -> None:
    tree = grown()
    away = cKDTree(tree.skeleton.points).query(leaves())[0]
    before = cKDTree(fork().points).query(leaves())[0]
    assert np.median(before) > 1.0
    assert np.median(away) < 0.3
    assert tree.attractors_reached > 0.5


def test_visible_branches_stay_where_they_are() -> None:
    tree = grown()
    assert tree.skeleton.points[:7].tolist() == fork().points.tolist()
    assert tree.skeleton.parents[:7].tolist() == fork().parents.tolist()
    assert (tree.born[:7] == 0).all()
    assert (tree.born[7:] > 0).all()


def test_new_wood_stands_in_the_crown_and_in_all_silhouettes() -> None:
    new = grown(limits=bounds(slice(0, 280))).skeleton.points[7:]
    assert len(new) > 10
    assert (np.linalg.norm(new - MIDDLE, axis=1) < RADIUS).all()
    assert new[:, 0].max() < 0.8


@pytest.mark.parametrize("iterations", [0, 3])
def test_iterations_are_the_most_blocks(iterations: int) -> None:
    tree = grown(ReplicationParams(iterations=iterations))
    assert len(tree.choices) == iterations
    assert (len(tree.skeleton) == 7) == (iterations == 0)


def test_a_generation_grows_on_the_one_before() -> None:
    tree = grown()
    parents = np.maximum(tree.skeleton.parents, 0)
    step = tree.born - tree.born[parents]
    assert set(step[7:].tolist()) <= {0, 1}
    assert tree.born.max() >= 2


def test_radii_shrink_outward() -> None:
    tree = grown().skeleton
    assert (tree.radii[1:] <= tree.radii[tree.parents[1:]]).all()
    assert (tree.radii > 0).all()


def test_the_same_seed_grows_the_same_tree() -> None:
    assert grown().skeleton.points.tobytes() == grown().skeleton.points.tobytes()


def test_blocks_come_from_the_visible_tree_and_turn_about_their_primary_branch() -> None:
    blocks = replication_blocks(oak())
    start, axis = np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.0, 2.0])
    bases, ends = blocks.placed(start, axis)
    exists = blocks.parents > NO_SHOOT
    assert exists.any(axis=1).all()
    along = (bases - start)[exists & (blocks.parents == -1)]
    assert np.abs(along[:, :2]).max() < 1e-9
    assert 0 <= along[:, 2].min() <= along[:, 2].max() <= 2 + 1e-9
    first = np.linalg.norm((ends - bases)[:12], axis=2)
    assert np.allclose(first, first[0])
    assert np.ptp(ends[:12, 0, 0]) > 0.1


@pytest.mark.parametrize("wrong", [{"iterations": -1}, {"cone_deg": 0.0}, {"shortest": 0.3}, {"tip": 0.0}])
def test_impossible_parameters_are_a_programmers_mistake(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="replication needs"):
        ReplicationParams(**wrong)  # type: ignore[arg-type]
