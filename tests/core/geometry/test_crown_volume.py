import numpy as np
from treestroke.core.geometry.views import CrownViews, View, from_left

from treestroke.core.geometry.camera import Camera

CAMERA = Camera(100, 100, 0.1, (50.0, 90.0))


def upper_right() -> View:
    """A crown that fills the picture's right half above the root."""
    mask = np.zeros((100, 100), dtype=bool)
    mask[:90, 50:] = True
    return View(mask, CAMERA)


def test_from_the_left_the_viewers_side_is_on_the_right() -> None:
    towards_viewer, left, up = np.eye(3)[[2, 0, 1]] * [[1.0], [-1.0], [1.0]]
    assert from_left(np.stack([towards_viewer, left, up])).tolist() == [[1, 0, 0], [0, 0, 1], [0, 1, 0]]


def test_a_view_shows_what_falls_on_its_mask_and_nothing_beside_the_picture() -> None:
    points = np.array([[1.0, 1.0, 9.0], [-1.0, 1.0, 0.0], [1.0, 50.0, 0.0], [60.0, 1.0, 0.0]])
    assert upper_right().shows(points).tolist() == [True, False, False, False]


def test_a_crown_of_two_views_holds_what_both_show() -> None:
    both = CrownViews(upper_right(), upper_right())
    points = np.array([[1.0, 2.0, 1.0], [1.0, 2.0, -1.0], [-1.0, 2.0, 1.0]])
    assert both.inside(points).tolist() == [True, False, False]
    assert CrownViews(upper_right()).inside(points).tolist() == [True, True, False]
