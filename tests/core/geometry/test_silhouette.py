import numpy as np
import pytest
from tests.builders import oak, stick
from tests.levels import silhouette_ious

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import Mesh, Surface
from treestroke.core.geometry.silhouette import (
    AZIMUTHS_RAD,
    framing,
    overlap,
    silhouette,
    silhouette_from,
)
from treestroke.core.mesh.tubes import tubes

WOOD = np.full((4, 4, 3), 90, np.uint8)


def wooden(skeleton: object) -> Surface:
    return Surface(tubes(skeleton), WOOD)  # type: ignore[arg-type]


def plate(alpha: np.ndarray, x: float = 0.0, z: float = 0.0) -> Surface:
    """Stand a square of 2 m up in front of the axis."""
    square = np.array([[-1, 0, 0], [1, 0, 0], [1, 2, 0], [-1, 2, 0]], np.float32) + np.array([x, 0, z], np.float32)
    uvs = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)
    texture = np.dstack([np.zeros((*alpha.shape, 3)), alpha]).astype(np.uint8)
    normals = np.tile(np.array([0, 0, 1], np.float32), (4, 1))
    return Surface(Mesh(square, normals, uvs, np.array([[0, 1, 2], [0, 2, 3]], np.uint32)), texture)


def columns(mask: np.ndarray) -> list[int]:
    shown = np.flatnonzero(mask.any(axis=0))
    return [int(shown[0]), int(shown[-1]) + 1]


def test_the_front_is_what_the_photo_framed() -> None:
    seen = silhouette(wooden(stick()), None, OrthographicCamera(100, 100, 0.05, (50.0, 95.0)), 50)
    assert seen.shape == (50, 50)
    assert columns(seen)[0] == 50 - columns(seen)[1]
    assert np.flatnonzero(seen.any(axis=1))[[0, -1]] == pytest.approx([7, 47], abs=1)


def test_from_the_right_what_is_nearer_to_the_camera_stands_left() -> None:
    surfaces = [plate(np.full((4, 4), 255), x=3.0), plate(np.full((4, 4), 255), x=-3.0, z=3.0)]
    view = framing(surfaces, 20)
    middle = view.width // 2
    front = silhouette_from(surfaces, view, 0.0)
    assert columns(front) == [middle - 40, middle + 40]
    corner = view.project(np.array([0.0, 0.0, 3.0]), np.pi / 2)
    assert corner == pytest.approx([middle - 30, view.bottom_px])


def test_from_behind_a_silhouette_is_mirrored() -> None:
    surfaces = [wooden(oak())]
    view = framing(surfaces, 60)
    for front, back in zip(AZIMUTHS_RAD[:4], AZIMUTHS_RAD[4:], strict=True):
        ahead, behind = (silhouette_from(surfaces, view, at) for at in (front, back))
        assert overlap(ahead, behind[:, ::-1]) > 0.99


def test_a_texture_is_averaged_before_it_is_cut() -> None:
    stripes = np.zeros((256, 256))
    stripes[:, ::4] = 255
    view = framing([plate(stripes)], 10)
    assert not silhouette_from([plate(stripes)], view, 0.0).any()
    stripes[:, 1::4] = 255
    assert silhouette_from([plate(stripes)], view, 0.0).sum() == 100


def test_a_tree_is_like_itself_and_unlike_a_thicker_one() -> None:
    thin, thick = wooden(stick(radius=0.2, tip_radius=0.2)), wooden(stick(radius=0.4, tip_radius=0.4))
    assert silhouette_ious([thin], [thin], 80).tolist() == [1.0] * 8
    assert silhouette_ious([thick], [thin], 160) == pytest.approx(0.5, abs=0.05)
