import numpy as np
import pytest
from tests.levels import silhouette_ious

from treestroke.core.geometry.mesh import ALPHA_CUT, Mesh, Surface
from treestroke.core.geometry.silhouette import AZIMUTHS_RAD, framing, overlap, silhouette_from
from treestroke.core.mesh.impostor import BANDS, COLUMNS, TILE_SIDE, impostor

RED, GREEN = (200, 30, 20), (20, 160, 40)


def ball(colour: tuple[int, int, int], middle: tuple[float, float, float], radius: float, alpha: int = 255) -> Surface:
    """Round an octahedron three times."""
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    corners = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]])
    faces = axes[corners]
    for _ in range(3):
        a, b, c = faces.transpose(1, 0, 2)
        ab, bc, ca = a + b, b + c, c + a
        faces = np.stack([p for q in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)) for p in q], axis=1)
        faces = faces.reshape(-1, 3, 3) / np.linalg.norm(faces.reshape(-1, 3, 3), axis=2, keepdims=True)
    points = faces.reshape(-1, 3).astype(np.float32)
    triangles = np.arange(len(points), dtype=np.uint32).reshape(-1, 3)
    texture = np.full((4, 4, 4), (*colour, alpha), np.uint8)
    mesh = Mesh(
        points * np.float32(radius) + np.array(middle, np.float32),
        points,
        np.full((len(points), 2), 0.5, np.float32),
        triangles,
    )
    return Surface(mesh, texture)


CROWN = [ball(GREEN, (1.5, 3, 0.5), 1.0), ball(GREEN, (0.8, 2, -0.3), 0.7)]


@pytest.fixture(scope="module")
def baked() -> Surface:
    """Pictures of a crown aside of the axis."""
    return impostor(CROWN)


def tile(picture: np.ndarray, number: int) -> np.ndarray:
    row, column = divmod(number, COLUMNS)
    return picture[row * TILE_SIDE : (row + 1) * TILE_SIDE, column * TILE_SIDE : (column + 1) * TILE_SIDE]


@pytest.fixture(scope="module")
def two_balls() -> Surface:
    """A green one in front (+Z) of a red one."""
    return impostor([ball(RED, (0, 2, -1), 1.0), ball(GREEN, (0, 2, 1), 0.5)])


def test_the_atlas_has_sides_of_powers_of_two(two_balls: Surface) -> None:
    assert two_balls.texture.shape == (512, 1024, 4)
    assert two_balls.normal_map is not None
    assert two_balls.normal_map.shape == (512, 1024, 3)


def test_each_side_shows_what_is_nearer_there(two_balls: Surface) -> None:
    middle = slice(120, 136)
    assert tile(two_balls.texture, 0)[middle, middle, :3] == pytest.approx(np.broadcast_to(GREEN, (16, 16, 3)), abs=2)
    assert tile(two_balls.texture, 4)[middle, middle, :3] == pytest.approx(np.broadcast_to(RED, (16, 16, 3)), abs=2)


def test_from_the_right_what_is_in_front_stands_left(two_balls: Surface) -> None:
    side = tile(two_balls.texture, 2)
    assert side[128, 30, :3] == pytest.approx(GREEN, abs=2)
    assert side[128, 200, :3] == pytest.approx(RED, abs=2)


def test_colours_continue_under_transparent_texels(two_balls: Surface) -> None:
    picture = tile(two_balls.texture, 4)
    clear = picture[picture[..., 3] == 0]
    assert len(clear) > 5_000
    assert (clear[:, 0] > clear[:, 1] + 100).all()


def test_the_normal_map_bulges_to_the_viewer(two_balls: Surface) -> None:
    assert two_balls.normal_map is not None
    normals = tile(two_balls.normal_map, 4).astype(float) / 127.5 - 1
    assert normals[128, 128] == pytest.approx([0, 0, 1], abs=0.1)
    assert normals[128, 200, 0] > 0.4
    assert normals[40, 128, 1] > 0.4


def test_triangles_face_the_azimuth_that_they_show(two_balls: Surface) -> None:
    mesh = two_balls.mesh
    a, b, c = mesh.positions[mesh.triangles].transpose(1, 0, 2)
    facing = np.cross(b - a, c - a).reshape(8, 2 * BANDS, 3)
    out = np.stack([np.sin(AZIMUTHS_RAD), 0 * AZIMUTHS_RAD, np.cos(AZIMUTHS_RAD)], axis=1)
    assert (np.einsum("ktc,kc->kt", facing, out) > 0).all()
    assert mesh.normals.reshape(8, -1, 3)[:, 0] == pytest.approx(out, abs=1e-6)


def test_the_picture_runs_to_the_viewer_s_right_and_up(two_balls: Surface) -> None:
    corners, uvs = two_balls.mesh.positions.reshape(8, -1, 2, 3), two_balls.mesh.uvs.reshape(8, -1, 2, 2)
    right = np.stack([np.cos(AZIMUTHS_RAD), 0 * AZIMUTHS_RAD, -np.sin(AZIMUTHS_RAD)], axis=1)
    assert (np.einsum("kbc,kc->kb", corners[:, :, 1] - corners[:, :, 0], right) > 0).all()
    assert (uvs[:, :, 1, 0] > uvs[:, :, 0, 0]).all()
    assert (np.diff(corners[:, :, 0, 1], axis=1) > 0).all()
    assert (np.diff(uvs[:, :, 0, 1], axis=1) < 0).all()


@pytest.mark.parametrize("number", range(8))
def test_a_view_s_own_plane_shows_the_tree_s_silhouette(number: int, baked: Surface) -> None:
    own = baked.mesh.triangles.reshape(8, -1, 3)[number]
    mesh = Mesh(baked.mesh.positions, baked.mesh.normals, baked.mesh.uvs, own)
    view = framing(CROWN, 64)
    shown = silhouette_from([Surface(mesh, baked.texture)], view, AZIMUTHS_RAD[number])
    assert overlap(shown, silhouette_from(CROWN, view, AZIMUTHS_RAD[number])) > 0.95


def test_a_crown_aside_of_the_axis_keeps_its_silhouettes(baked: Surface) -> None:
    assert silhouette_ious(CROWN, [baked], 64).min() > 0.9


@pytest.mark.parametrize("azimuth", AZIMUTHS_RAD.tolist())
def test_sides_turned_away_add_nothing_to_the_silhouette(azimuth: float, baked: Surface) -> None:
    mesh, view = baked.mesh, framing(CROWN, 64)
    towards = mesh.normals[mesh.triangles[:, 0]] @ np.array([np.sin(azimuth), 0.0, np.cos(azimuth)]) > 0.1
    front = Surface(Mesh(mesh.positions, mesh.normals, mesh.uvs, mesh.triangles[towards]), baked.texture)
    assert overlap(*(silhouette_from([each], view, azimuth) for each in (front, baked))) > 0.98


def test_half_covered_texels_are_at_the_cut(two_balls: Surface) -> None:
    alpha = two_balls.texture[..., 3]
    assert np.abs(alpha.astype(int) - round(255 * ALPHA_CUT)).min() <= 1
