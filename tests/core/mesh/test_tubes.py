import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from tests.builders import fork, oak, stick

from treestroke.core.geometry.mesh import Mesh
from treestroke.core.mesh.tubes import TubeParams, tubes
from treestroke.core.skeleton.skeleton import Skeleton

PLAIN = TubeParams(root_swelling=1.0, buttress=0.0, collar_swelling=0.0)


def corners(mesh: Mesh) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    a, b, c = mesh.positions.astype(np.float64)[mesh.triangles].transpose(1, 0, 2)
    return a, b, c


def areas(mesh: Mesh) -> np.ndarray:
    a, b, c = corners(mesh)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def any_tree(seed: int) -> Skeleton:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 60))
    parents = np.array([-1] + [int(rng.integers(0, i)) for i in range(1, count)])
    points = np.zeros((count, 3))
    for i in range(1, count):
        # some joints stand on their parent
        points[i] = points[parents[i]] + rng.normal(0.0, 0.4, 3) * (i == 1 or rng.random() > 0.1)
    return Skeleton(points, rng.random(count) * 0.2, parents)


@given(st.integers(0, 100_000))
@settings(max_examples=40, deadline=None)
def test_any_tree_gives_finite_triangles_with_area_and_unit_normals(seed: int) -> None:
    mesh = tubes(any_tree(seed), TubeParams())
    height = np.ptp(mesh.positions, axis=0).max()
    assert np.isfinite(mesh.positions).all()
    assert np.isfinite(mesh.uvs).all()
    assert areas(mesh).min() > 1e-10 * height**2
    assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1.0, abs=1e-5)


def test_a_stick_is_a_closed_solid_of_the_right_volume() -> None:
    solid = trimesh.Trimesh(*_welded(tubes(stick(radius=0.1, tip_radius=0.1), PLAIN)), process=False)
    assert solid.is_watertight
    assert solid.is_winding_consistent
    assert solid.volume == pytest.approx(np.pi * 0.1**2 * 4.0, rel=0.05)


@given(st.integers(0, 100_000))
@settings(max_examples=30, deadline=None)
def test_vertices_are_attached_to_joints_of_one_path_to_the_root(seed: int) -> None:
    tree = any_tree(seed)
    attachment = tubes(tree, TubeParams()).attachment
    assert attachment.joints.min() >= 0
    assert ((attachment.share >= 0) & (attachment.share < 1)).all()
    for near, far in np.unique(attachment.joints, axis=0).tolist():
        while far > near:
            far = int(tree.parents[far])
        assert far == near


def test_vertices_are_attached_where_their_rings_stand() -> None:
    tree = oak()
    mesh = tubes(tree, PLAIN)
    share = mesh.attachment.share[:, None]
    held = tree.points[mesh.attachment.joints[:, 0]] * (1 - share) + tree.points[mesh.attachment.joints[:, 1]] * share
    away = np.linalg.norm(mesh.positions - held, axis=1)
    thick = np.maximum(*tree.radii[mesh.attachment.joints].T)
    assert (away <= 1.05 * thick).mean() > 0.9
    assert away.max() < 2 * thick.max()


def test_a_limb_starts_from_its_parent_s_joint() -> None:
    joints = tubes(fork()).attachment.joints
    assert {(2, 2), (5, 5), (6, 6)} <= {(a, b) for a, b in joints.tolist()}
    assert not ((joints == 3) | (joints == 4)).any(axis=1)[joints.max(axis=1) > 4].any()


def _welded(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    rounded = np.round(mesh.positions.astype(np.float64), 6)
    vertices, index = np.unique(rounded, axis=0, return_inverse=True)
    return vertices, index.reshape(-1)[mesh.triangles]


def test_triangles_face_the_way_their_normals_do() -> None:
    mesh = tubes(stick(), TubeParams())
    a, b, c = corners(mesh)
    towards = np.einsum("ij,ij->i", np.cross(b - a, c - a), mesh.normals[mesh.triangles].sum(axis=1))
    assert (towards > 0).all()


def test_bark_stands_on_the_ground_even_where_the_trunk_leans() -> None:
    points = np.array([[0.0, 0, 0], [0.5, 1, 0], [1.0, 2, 0]])
    mesh = tubes(Skeleton(points, np.array([0.2, 0.2, 0.2]), np.array([-1, 0, 1])), TubeParams(root_swelling=1.5))
    low = mesh.positions[mesh.positions[:, 1] < 0.001]
    assert mesh.positions[:, 1].min() == pytest.approx(0.0, abs=1e-6)
    assert np.hypot(low[:, 0], low[:, 2]).max() > 0.25


@pytest.mark.parametrize("lean", [0.0, 0.4, 0.7])
def test_a_trunk_is_cut_level_at_the_ground_and_is_no_wider_there(lean: float) -> None:
    up = np.linspace(0.0, 3.0, 13)
    points = np.column_stack([lean * up, up, 0.2 * np.sin(up)])
    mesh = tubes(Skeleton(points, np.full(13, 0.2), np.arange(13) - 1))
    low = mesh.positions[mesh.positions[:, 1] == 0.0]
    assert mesh.positions[:, 1].min() == 0.0
    assert np.hypot(low[:, 0], low[:, 2]).max() == pytest.approx(0.2, rel=1e-3)
    assert low.mean(axis=0) == pytest.approx(np.zeros(3), abs=0.02)


def test_the_root_swells_and_the_trunk_above_does_not() -> None:
    mesh = tubes(stick(joints=9, radius=0.1, tip_radius=0.1), TubeParams(root_swelling=1.5, buttress=0.0))
    reach = np.hypot(mesh.positions[:, 0], mesh.positions[:, 2])
    assert reach[mesh.positions[:, 1] == 0].max() == pytest.approx(0.15, rel=1e-5)
    assert reach[mesh.positions[:, 1] > 0.5].max() == pytest.approx(0.1, rel=1e-5)


def test_a_flare_that_the_photo_shows_is_not_swollen_again() -> None:
    points = np.array([[0.0, 0, 0], [0, 0.2, 0], [0, 0.5, 0], [0, 4, 0]])
    flared = Skeleton(points, np.array([0.16, 0.11, 0.1, 0.1]), np.array([-1, 0, 1, 2]))
    mesh = tubes(flared, TubeParams(root_swelling=1.5, buttress=0.0))
    assert np.hypot(mesh.positions[:, 0], mesh.positions[:, 2]).max() == pytest.approx(0.16, rel=1e-5)


def test_a_giant_among_many_twigs_keeps_its_shape() -> None:
    points = np.array([[0.0, 0, 0], [0, 1, 0], [0, 2, 0], [0, 10, 0]])
    mesh = tubes(Skeleton(points, np.array([3.0, 3.0, 2.0, 0.3]), np.array([-1, 0, 1, 2])), TubeParams(buttress=0.0))
    reach, high = np.hypot(mesh.positions[:, 0], mesh.positions[:, 2]), mesh.positions[:, 1]
    shown = np.interp([1.0, 2.0], np.unique(high), [reach[high == y].max() for y in np.unique(high)])
    assert shown == pytest.approx([3.0, 2.0], abs=0.1)


def test_a_trunk_without_flare_ends_as_round_as_it_is_above() -> None:
    mesh = tubes(stick(joints=9, radius=0.1, tip_radius=0.1), TubeParams())
    reach = np.hypot(mesh.positions[:, 0], mesh.positions[:, 2])
    assert reach[(reach > 0) & (mesh.positions[:, 1] < 0.5)] == pytest.approx(0.1, rel=1e-5)


def test_a_limb_from_a_thick_foot_does_not_reach_below_the_ground() -> None:
    points = np.array([[0.0, 0, 0], [0, 0.3, 0], [0, 2, 0], [1.0, 0.5, 0], [2.0, 1, 0]])
    tree = Skeleton(points, np.array([0.5, 0.5, 0.4, 0.4, 0.3]), np.array([-1, 0, 1, 1, 3]))
    assert tubes(tree).positions[:, 1].min() == 0.0


def test_the_strongest_child_goes_on_ring_by_ring() -> None:
    trunk, child = _pieces(tubes(fork(), TubeParams()))
    assert (trunk.is_watertight, child.is_watertight) == (True, False)
    assert trunk.bounds[:, 1] == pytest.approx([0.0, 3.6], abs=0.1)


def test_a_limb_starts_hidden_inside_its_parent() -> None:
    _, child = _pieces(tubes(fork(), TubeParams()))
    edges, count = np.unique(child.edges_sorted, axis=0, return_counts=True)
    rim = child.vertices[np.unique(edges[count == 1])]
    assert len(rim) >= 3
    assert np.hypot(rim[:, 0], rim[:, 2]).max() < 0.2 * np.cos(np.pi / 16)
    assert rim[:, 1] == pytest.approx(2.0, abs=0.2)


def _pieces(mesh: Mesh) -> list[trimesh.Trimesh]:
    """Split into connected pieces, the one of most triangles first."""
    vertices, faces = _welded(mesh)
    pairs = np.concatenate([faces[:, :2], faces[:, 1:]])
    links = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(vertices), len(vertices)))
    piece = connected_components(links, directed=False)[1][faces[:, 0]]
    largest_first = np.argsort(-np.bincount(piece), kind="stable")
    return [trimesh.Trimesh(vertices, faces[piece == k], process=True) for k in largest_first if (piece == k).any()]


def test_a_collar_is_wider_than_the_limb_beyond_it() -> None:
    plain, collared = (tubes(fork(angle_rad=1.2), p) for p in (PLAIN, TubeParams(root_swelling=1.0, buttress=0.0)))
    near = [m.positions[(m.positions[:, 0] > 0.2) & (m.positions[:, 0] < 0.3)] for m in (plain, collared)]
    far = [m.positions[m.positions[:, 0] > 0.9] for m in (plain, collared)]
    assert np.ptp(near[1][:, 1]) > np.ptp(near[0][:, 1])
    assert np.array_equal(far[0], far[1])


@pytest.mark.parametrize("budget", [1_000, 3_000, 95_000])
def test_the_triangle_budget_holds(budget: int) -> None:
    assert len(tubes(oak(), TubeParams(max_triangles=budget)).triangles) <= budget


def test_too_many_limbs_for_the_budget_are_refused() -> None:
    with pytest.raises(ValueError, match="100 triangles do not suffice"):
        tubes(oak(orders=5), TubeParams(max_triangles=100))


def test_texels_are_nearly_square() -> None:
    mesh = tubes(oak(), TubeParams(buttress=0.0))
    across, along = _texture_stretch(mesh)
    ratio = along / across * TubeParams().texture_aspect
    assert np.quantile(ratio, [0.05, 0.95]) == pytest.approx([1.0, 1.0], abs=0.45)


def _texture_stretch(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Length of du and of dv on each triangle that spans both, texture units a metre."""
    a, b, c = corners(mesh)
    edges = np.stack([b - a, c - a], axis=1)
    uv = mesh.uvs.astype(np.float64)[mesh.triangles]
    steps = np.stack([uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]], axis=1)
    solid = np.abs(np.linalg.det(steps)) > 1e-9
    tangents = np.linalg.solve(steps[solid], edges[solid])
    length = 1.0 / np.linalg.norm(tangents, axis=2)
    return length[:, 0], length[:, 1]


def test_a_skeleton_without_length_is_refused() -> None:
    with pytest.raises(ValueError, match="without length"):
        tubes(Skeleton(np.zeros((1, 3)), np.ones(1), np.array([-1])), TubeParams())


def test_a_drawing_is_refused() -> None:
    with pytest.raises(ValueError, match="3D"):
        tubes(Skeleton(np.array([[0.0, 0], [0, 1]]), np.ones(2), np.array([-1, 0])), TubeParams())


def test_each_stem_has_its_own_foot() -> None:
    points = np.array([[0.0, 0, 0], [0, 2, 0], [1, 0, 0], [1, 1.5, 0]])
    params = TubeParams(root_swelling=1.5, buttress=0.0)
    mesh = tubes(Skeleton(points, np.full(4, 0.1), np.array([-1, 0, -1, 2])), params)
    ground = mesh.positions[mesh.positions[:, 1] == 0]
    assert [ground[:, 0].min(), ground[:, 0].max()] == pytest.approx([-0.15, 1.15], abs=0.01)


def test_equal_trees_give_equal_bytes() -> None:
    first, second = tubes(oak(), TubeParams()), tubes(oak(), TubeParams())
    assert first.positions.tobytes() == second.positions.tobytes()
    assert first.uvs.tobytes() == second.uvs.tobytes()
