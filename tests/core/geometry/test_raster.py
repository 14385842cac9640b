import numpy as np

from treestroke.core.geometry.raster import covered_pixels, planes, visible_triangles
from treestroke.core.types import Indices

RIGHT_HALF = [[20.0, 0.0], [40.0, 0.0], [20.0, 20.0]]


def whole(triangle: Indices, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.ones(len(triangle), dtype=bool)


def test_a_triangle_covers_the_pixels_whose_centres_it_holds() -> None:
    shown = visible_triangles(np.array([RIGHT_HALF]), np.zeros(1), whole, 20, 40)
    row, column = np.mgrid[:20, :40]
    assert np.array_equal(shown == 0, (column >= 20) & (column - 19.5 + row + 0.5 < 20))


def test_the_nearest_triangle_is_shown() -> None:
    shown = visible_triangles(np.array([RIGHT_HALF] * 3), np.array([0.0, 2.0, 1.0]), whole, 20, 40)
    assert set(np.unique(shown)) == {-1, 1}


def test_a_point_cut_away_shows_the_triangle_behind() -> None:
    shown = visible_triangles(
        np.array([RIGHT_HALF] * 2), np.array([1.0, 0.0]), lambda t, x, y: (t == 1) | (y > 10), 20, 40
    )
    assert set(np.unique(shown[:10])) == {-1, 1}
    assert set(np.unique(shown[10:])) == {-1, 0}


def test_two_triangles_that_share_an_edge_leave_no_gap() -> None:
    square = np.array([[3.3, 2.1], [31.7, 5.2], [28.4, 17.9], [5.6, 15.5]])
    shown = visible_triangles(square[np.array([[0, 1, 2], [0, 2, 3]])], np.zeros(2), whole, 20, 40)
    for row in shown:
        inside = np.flatnonzero(row >= 0)
        assert inside.size == 0 or inside[-1] - inside[0] + 1 == inside.size


def test_a_triangle_outside_the_picture_is_not_drawn() -> None:
    shown = visible_triangles(np.array([RIGHT_HALF]) - 100, np.zeros(1), whole, 20, 40)
    assert (shown == -1).all()


def test_planes_give_the_corners_back_and_the_mean_between() -> None:
    corners, values = np.array([RIGHT_HALF]), np.array([[[1.0], [3.0], [8.0]]])
    found = planes(corners, values)
    x, y = corners[0].T
    assert np.allclose(found.at(np.zeros(3, dtype=int), x, y)[0], [1, 3, 8])
    assert np.allclose(found.at(np.zeros(1, dtype=int), x.mean(keepdims=True), y.mean(keepdims=True)), 4)


def test_what_triangles_cover_does_not_depend_on_which_is_shown() -> None:
    rng = np.random.default_rng(1)
    corners_px = rng.random((5_000, 1, 2)) * (60, 40) + rng.normal(0.0, 4.0, (5_000, 3, 2))
    seen = np.zeros((40, 60), dtype=bool)
    covered_pixels(corners_px[:300], lambda t, x, y: x > 20, seen)
    shown = visible_triangles(corners_px[:300], np.zeros(300), lambda t, x, y: x > 20, 40, 60)
    assert np.array_equal(seen, shown >= 0)
    covered_pixels(corners_px, whole, seen)
    assert np.array_equal(seen, visible_triangles(corners_px, np.zeros(5_000), whole, 40, 60) >= 0)
