import cv2
import numpy as np
import pytest
from tests.core.conftest import SKY
from tests.core.pipeline.test_completion import strokes

from treestroke.core.geometry.silhouette import overlap
from treestroke.core.pipeline.evidence import read_photo
from treestroke.core.pipeline.growing import grow_tree
from treestroke.core.pipeline.photo import trace_photo
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.working_copy import LEAST_SIDE, WORKING_SIDE, working_copy
from treestroke.core.strokes import Stroke, Strokes

DRAWN = strokes((150, 150), 130)


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


def moved(drawn: Strokes, factor: float, corner: tuple[int, int]) -> Strokes:
    """Return strokes on a photo that is scaled, and then part of a larger one."""
    return Strokes(
        Stroke(factor * drawn.crown.points + corner),
        tuple(Stroke(factor * stroke.points + corner) for stroke in drawn.branches),
    )


def test_a_tiny_photo_is_enlarged_and_its_trace_is_in_its_own_pixels(photo: np.ndarray, mask: np.ndarray) -> None:
    tiny = cv2.resize(photo, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)
    assert working_copy(tiny, moved(DRAWN, 0.25, (0, 0))).photo.shape[0] == LEAST_SIDE
    traced = trace_photo(tiny, moved(DRAWN, 0.25, (0, 0)))
    small = cv2.resize(mask.astype(np.uint8), (75, 100), interpolation=cv2.INTER_AREA) > 0
    assert overlap(traced.foliage, small) > 0.95
    assert traced.skeleton is not None
    assert traced.skeleton.points[0] == pytest.approx(0.25 * DRAWN.branches[0].points[0], abs=0.5)


def test_a_small_tree_in_a_large_photo_is_worked_on_at_its_own_scale(photo: np.ndarray, mask: np.ndarray) -> None:
    corner = (900, 300)
    large = np.full((1500, 2400, 3), SKY, np.uint8)
    large[300:700, 900:1200] = photo
    drawn = moved(DRAWN, 1.0, corner)
    copy = working_copy(large, drawn)
    assert copy.frame.scale == 1.0
    assert max(copy.photo.shape) < 1000
    traced = trace_photo(large, drawn)
    whole = np.zeros(large.shape[:2], bool)
    whole[300:700, 900:1200] = mask
    assert overlap(traced.foliage, whole) > 0.95
    tree = grow_tree(traced.evidence, ModelSettings(iterations=5), np.random.default_rng(0))
    assert (tree.camera.width, tree.camera.height) == (2400, 1500)
    assert tree.camera.root_px == pytest.approx(tuple(drawn.branches[0].points[0]))
    shown = cv2.resize(whole.astype(np.uint8), tree.expected[0].mask.shape[::-1], interpolation=cv2.INTER_AREA) > 0
    assert overlap(tree.expected[0].mask, shown) > 0.85


def test_a_branch_that_leaves_the_part_that_was_seen_is_followed_all_the_same(photo: np.ndarray) -> None:
    large = np.full((1500, 2400, 3), SKY, np.uint8)
    large[300:700, 900:1200] = photo
    drawn = moved(DRAWN, 1.0, (900, 300))
    seen = trace_photo(large, drawn)
    far = Stroke(np.array([[1050.0, 500.0], [700.0, 520.0]]))
    again = trace_photo(large, Strokes(drawn.crown, (*drawn.branches, far)), seen.evidence)
    assert again.skeleton is not None
    assert again.skeleton.points[:, 0].min() == pytest.approx(700, abs=5)
