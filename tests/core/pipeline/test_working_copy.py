import cv2
import numpy as np
from tests.core.pipeline.test_completion import strokes

from treestroke.core.pipeline.growing import read_photo
from treestroke.core.pipeline.working_copy import WORKING_SIDE, working_copy
from treestroke.core.strokes import Stroke, Strokes

DRAWN = strokes((150, 150), 140)


def cut_out(photo: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    return np.dstack([photo, (255 * alpha).astype(np.uint8)])


def test_the_foliage_of_a_cut_out_ends_where_its_alpha_ends(photo: np.ndarray, mask: np.ndarray) -> None:
    half = mask.copy()
    half[:, 150:] = False
    found = read_photo(cut_out(photo, half), DRAWN).foliage
    assert np.array_equal(found.mask, half)
    assert (found.alpha[~half] == 0).all()


def test_half_transparent_leaves_stay_half_transparent(photo: np.ndarray, mask: np.ndarray) -> None:
    found = read_photo(cut_out(photo, 0.7 * mask), DRAWN).foliage
    assert np.abs(found.alpha[mask] - 0.7).max() < 0.01


def test_what_is_transparent_has_the_colour_of_white(photo: np.ndarray, mask: np.ndarray) -> None:
    copy = working_copy(cut_out(photo, mask), DRAWN)
    assert (copy.photo[~mask] == 255).all()
    assert np.array_equal(copy.photo[mask], photo[mask])


def test_a_photo_with_round_corners_is_no_cut_out(photo: np.ndarray) -> None:
    corners = cv2.rectangle(np.zeros(photo.shape[:2], np.uint8), (2, 2), (297, 397), 1, -1)
    assert working_copy(cut_out(photo, corners), DRAWN).cut_out is None
    assert working_copy(photo, DRAWN).cut_out is None


def test_the_alpha_of_a_large_cut_out_is_reduced_with_it(photo: np.ndarray, mask: np.ndarray) -> None:
    large = cv2.resize(cut_out(photo, mask), None, fx=8, fy=8, interpolation=cv2.INTER_NEAREST)
    eight = Strokes(Stroke(8 * DRAWN.crown.points), tuple(Stroke(8 * s.points) for s in DRAWN.branches))
    copy = working_copy(large, eight)
    assert copy.cut_out is not None
    assert copy.cut_out.shape == copy.photo.shape[:2] == (WORKING_SIDE, 3 * WORKING_SIDE // 4)
    assert abs(copy.cut_out.mean() - mask.mean()) < 1e-3
