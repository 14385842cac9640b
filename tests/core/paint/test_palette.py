import numpy as np
import pytest

from treestroke.core.paint.palette import flattened, foliage_palette, lab_from_rgb, nearest_colour, rgb_from_lab

BLUE = lab_from_rgb(np.array([[110, 160, 230]], np.uint8))[0]


def test_lab_and_back_is_the_same_colour():
    rgb = np.random.default_rng(0).integers(0, 256, (500, 3)).astype(np.uint8)
    assert np.abs(rgb_from_lab(lab_from_rgb(rgb)).astype(int) - rgb).max() <= 1


def test_shares_sum_to_one_and_fall(photo, mask):
    palette = foliage_palette(photo, mask, 12, np.random.default_rng(0))
    assert palette.shares.sum() == pytest.approx(1)
    assert (np.diff(palette.shares) <= 0).all()


def test_sky_between_leaves_is_no_foliage_colour(photo, mask):
    holed = photo.copy()
    holed[(np.indices(mask.shape).sum(axis=0) // 6 % 8 == 0) & mask] = (110, 160, 230)
    palette = foliage_palette(holed, mask, 12, np.random.default_rng(0))
    assert nearest_colour(BLUE[None], palette.centres)[1][0] > 30**2


def test_one_colour_gives_one_cluster(mask):
    photo = np.full((*mask.shape, 3), 90, np.uint8)
    assert len(foliage_palette(photo, mask, 12, np.random.default_rng(0)).shares) == 1


def test_two_colours_give_two_clusters_by_their_areas(mask):
    upper = np.indices(mask.shape)[0] < 120
    photo = np.where(upper[..., None], np.uint8((60, 120, 30)), np.uint8((150, 60, 40)))
    palette = foliage_palette(photo, mask, 2, np.random.default_rng(0))
    assert [np.ptp(colours, axis=0).max() for colours in palette.members] == [0, 0]
    assert palette.shares[1] == pytest.approx(upper[mask].mean(), abs=0.02)


def test_clusters_are_the_colours_nearest_to_their_mean(photo, mask):
    palette = foliage_palette(photo, mask, 8, np.random.default_rng(0))
    nearest = [nearest_colour(colours, palette.centres)[0] for colours in palette.members]
    assert np.mean([np.mean(index == label) for label, index in enumerate(nearest)]) > 0.9


def test_flattening_keeps_the_order_of_lightness():
    lab = np.stack([np.linspace(5, 90, 30), np.zeros(30), np.zeros(30)], axis=1)
    assert (np.diff(flattened(lab)[:, 0]) > 0).all()


def test_an_empty_mask_is_refused(photo):
    with pytest.raises(ValueError, match="mask with foliage"):
        foliage_palette(photo, np.zeros(photo.shape[:2], bool), 8, np.random.default_rng(0))
