"""Pictures composited with known opacities: the matte finds them again."""

import cv2
import numpy as np
import pytest
from tests.pictures import disc, noisy, ring

from treestroke.core.segment.foliage import Foliage, segment_foliage
from treestroke.core.segment.matte import matte

SIZE = 300
LEAF, SKY, DUSK = (60, 95, 40), (150, 185, 230), (235, 190, 150)


def sprinkled(share: float, leaf_px: int = 5) -> np.ndarray:
    """Opacity (h, w) of a crown of small leaves with soft edges that cover a share of a disc."""
    spots = cv2.GaussianBlur(np.random.default_rng(3).standard_normal((SIZE, SIZE)), (0, 0), leaf_px / 2)
    within = disc(SIZE, 100)
    cut = np.quantile(spots[within], 1 - share)
    fine = (spots > cut) & within
    return cv2.GaussianBlur(fine.astype(np.float32), (0, 0), 0.7)


def composed(opacity: np.ndarray, sky: tuple[int, int, int] = SKY) -> np.ndarray:
    mixed = opacity[..., None] * np.array(LEAF, float) + (1 - opacity[..., None]) * np.array(sky, float)
    return noisy(mixed, 5.0)


def found_in(opacity: np.ndarray, sky: tuple[int, int, int] = SKY) -> Foliage:
    return segment_foliage(composed(opacity, sky), ring(110, (150.0, 150.0)))


@pytest.mark.parametrize("sky", [SKY, DUSK], ids=["day", "dusk"])
@pytest.mark.parametrize("share", [0.45, 0.7, 0.95])
def test_thin_foliage_is_as_thin_as_it_is(share: float, sky: tuple[int, int, int]) -> None:
    truth = sprinkled(share)
    found, within = found_in(truth, sky), disc(SIZE, 105)
    assert np.abs(found.alpha - truth)[within].mean() < 0.06
    assert found.alpha.sum() == pytest.approx(truth.sum(), rel=0.06)


def test_dark_shade_among_leaves_is_no_gap() -> None:
    shade = disc(SIZE, 12, (170.0, 140.0))
    photo = composed(disc(SIZE, 100).astype(np.float32))
    photo[shade] = noisy(np.full((*photo.shape[:2], 3), (25, 28, 22), np.uint8), 4.0)[shade]
    assert segment_foliage(photo, ring(110, (150.0, 150.0))).covered[shade].mean() > 0.95


def test_a_hole_too_small_for_the_mask_is_one_in_the_matte() -> None:
    hole = np.zeros((SIZE, SIZE), dtype=bool)
    hole[150, 149:152] = True
    found = found_in((disc(SIZE, 100) & ~hole).astype(np.float32))
    assert found.mask[hole].all()
    assert not found.covered[hole].any()


def test_what_is_covered_lies_in_the_mask_but_for_specks() -> None:
    found = found_in(sprinkled(0.45))
    assert (found.covered & ~found.mask).sum() < 0.01 * found.covered.sum()
    assert found.alpha.min() >= 0
    assert found.alpha.max() <= 1
    assert not found.alpha[~found.region].any()


def test_the_opacity_of_a_cut_out_is_taken_as_it_is() -> None:
    truth = sprinkled(0.6)
    on_white = composed(truth, (255, 255, 255))
    found = segment_foliage(on_white, ring(110, (150.0, 150.0)), cut_out=truth)
    assert np.array_equal(found.alpha, truth * found.region)


def test_where_colours_are_alike_the_likelihood_decides() -> None:
    likely = cv2.GaussianBlur(disc(SIZE, 100).astype(np.float32), (0, 0), 8)
    grey, region = np.full((SIZE, SIZE, 3), 90, np.uint8), np.ones((SIZE, SIZE), np.bool_)
    assert np.abs(matte(grey, likely, region) - likely).max() < 0.01


def test_mixed_pixels_follow_from_the_colours_beside_them() -> None:
    truth = np.tile(np.clip((np.arange(SIZE) - 146) / 8, 0, 1).astype(np.float32), (SIZE, 1))
    rough = (truth > 0.01).astype(np.float32)
    region = np.ones(truth.shape, np.bool_)
    assert np.abs(matte(composed(truth), rough, region) - truth).mean() < 0.02


def test_nothing_is_covered_outside_the_region() -> None:
    truth = np.tile(np.clip((np.arange(SIZE) - 146) / 8, 0, 1).astype(np.float32), (SIZE, 1))
    region = disc(SIZE, 100)
    alpha = matte(composed(truth), (truth > 0.5).astype(np.float32), region)
    assert not alpha[~region].any()
    assert alpha[region].max() > 0.9


def test_windows_of_a_wall_behind_a_thin_crown_are_none_of_it() -> None:
    """Panes are neither the wall's colour nor the leaves', and lie aside of all mixtures of both."""
    wall, pane = (205, 190, 150), (75, 85, 100)
    house = np.full((SIZE, SIZE, 3), wall, float)
    panes = np.zeros((SIZE, SIZE), dtype=bool)
    for row in range(20, SIZE, 70):
        for column in range(20, SIZE, 60):
            panes[row : row + 34, column : column + 26] = True
    house[panes] = pane
    truth = sprinkled(0.5)
    photo = noisy(truth[..., None] * np.array((190, 160, 40), float) + (1 - truth[..., None]) * house, 5.0)
    alpha = segment_foliage(photo, ring(110, (150.0, 150.0))).alpha
    seen = panes & disc(SIZE, 95) & (truth < 0.05)
    assert (alpha[seen] > 0.5).mean() < 0.1
    assert (alpha[disc(SIZE, 95) & (truth > 0.95)] > 0.5).mean() > 0.95
