import numpy as np

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette, shown_by_all

FRONT = OrthographicCamera(100, 100, 0.1, (50.0, 90.0))
LEFT = OrthographicCamera(100, 100, 0.1, (50.0, 90.0), from_left=True)


def right_half(camera: OrthographicCamera) -> Silhouette[OrthographicCamera]:
    """A crown that fills the picture's right half above the root."""
    mask = np.zeros((100, 100), dtype=bool)
    mask[:90, 50:] = True
    return Silhouette(mask, camera)


def test_a_silhouette_shows_what_falls_on_its_mask_and_nothing_beside_the_picture() -> None:
    points = np.array([[1.0, 1.0, 9.0], [-1.0, 1.0, 0.0], [1.0, 50.0, 0.0], [60.0, 1.0, 0.0]])
    assert right_half(FRONT).shows(points).tolist() == [True, False, False, False]


def test_a_silhouette_of_the_left_side_has_the_front_on_its_right() -> None:
    points = np.array([[9.0, 1.0, 1.0], [0.0, 1.0, -1.0]])
    assert right_half(LEFT).shows(points).tolist() == [True, False]


def test_all_silhouettes_show_what_each_shows() -> None:
    points = np.array([[1.0, 2.0, 1.0], [1.0, 2.0, -1.0], [-1.0, 2.0, 1.0]])
    assert shown_by_all([right_half(FRONT), right_half(LEFT)], points).tolist() == [True, False, False]
    assert shown_by_all([], points).all()
