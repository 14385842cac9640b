import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.builders import oak, stick
from tests.levels import silhouette_ious

from treestroke.core.geometry.mesh import Mesh, Surface
from treestroke.core.mesh.lod_tubes import LEAST_TRIANGLES, LodParams, lod_tubes
from treestroke.core.mesh.tubes import tubes
from treestroke.core.skeleton.skeleton import Skeleton

WOOD = np.full((4, 4, 3), 90, np.uint8)


def any_tree(seed: int) -> Skeleton:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 200))
    parents = np.array([-1] + [int(rng.integers(0, i)) for i in range(1, count)])
    points = np.zeros((count, 3))
    for i in range(1, count):
        # some joints stand on their parent, but not all
        points[i] = points[parents[i]] + rng.normal(0.0, 0.4, 3) * (i == count - 1 or rng.random() > 0.2)
    return Skeleton(points, rng.random(count) * 0.2, parents)


def length(mesh: Mesh) -> float:
    return float(np.ptp(mesh.positions, axis=0).max())


@given(st.integers(0, 100_000))
@settings(max_examples=40, deadline=None)
def test_any_tree_has_reduced_bark(seed: int) -> None:
    mesh = lod_tubes(any_tree(seed), LodParams(LEAST_TRIANGLES, 100))
    assert len(mesh.triangles) > 0
    assert np.isfinite(mesh.positions).all()
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("most", [150, 400, 1_000])
def test_the_triangle_budget_is_kept_and_used(most: int) -> None:
    mesh = lod_tubes(oak(orders=5), LodParams(most, 200))
    assert 0.7 * most < len(mesh.triangles) <= most


def test_vertices_are_attached_to_near_joints_of_the_whole_tree() -> None:
    tree = oak(orders=5)
    mesh = lod_tubes(tree, LodParams(400, 200))
    assert mesh.attachment is not None
    start, end = tree.points[mesh.attachment.joints.T]
    place = start + mesh.attachment.share[:, None] * (end - start)
    assert np.linalg.norm(mesh.positions - place, axis=1).max() < 0.6


def test_a_stick_stays_one_tube_and_as_tall() -> None:
    mesh = lod_tubes(stick(), LodParams(LEAST_TRIANGLES, 100))
    assert length(mesh) == pytest.approx(4.0, rel=0.02)


def test_twigs_are_dropped_before_the_trunk() -> None:
    tree = oak(orders=5)
    mesh = lod_tubes(tree, LodParams(LEAST_TRIANGLES, 200))
    assert mesh.attachment is not None
    gone = set(range(len(tree))) - set(mesh.attachment.joints.ravel().tolist())
    assert {0, 3}.isdisjoint(gone)
    assert len(gone) > len(tree) / 2


def test_a_third_of_the_triangles_covers_nearly_the_same() -> None:
    tree = oak(orders=5)
    whole = tubes(tree)
    coarse = lod_tubes(tree, LodParams(len(whole.triangles) // 3, 200))
    assert silhouette_ious([Surface(whole, WOOD)], [Surface(coarse, WOOD)], 200).min() > 0.88


def test_params_out_of_range_are_refused() -> None:
    with pytest.raises(ValueError, match="triangles"):
        LodParams(LEAST_TRIANGLES - 1, 100)
    with pytest.raises(ValueError, match="most_thickened"):
        LodParams(LEAST_TRIANGLES, 100, most_thickened=0.9)
