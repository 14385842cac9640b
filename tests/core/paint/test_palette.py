import numpy as np
import pytest

from treestroke.core.paint.palette import foliage_palette, lab_from_rgb, nearest_colour, rgb_from_lab, unshaded

BLUE = lab_from_rgb(np.array([[110, 160, 230]], np.uint8))[0]


def test_lab_and_back_is_the_same_colour():
    rgb = np.random.default_rng(0).integers(0, 256, (500, 3)).astype(np.uint8)
    assert np.abs(rgb_from_lab(lab_from_rgb(rgb)).astype(int) - rgb).max() <= 1


def test_shares_sum_to_one_and_fall(photo, mask):
    palette = foliage_palette(photo, mask, 12, np.random.default_rng(0))
    assert palette.shares.sum() == pytest.approx(1)
    assert (np.diff(palette.shares) <= 0).all()


def test_sky_between_leaves_is_no_foliage_colour(photo, mask):
    holed, sky = photo.copy(), (np.indices(mask.shape).sum(axis=0) // 6 % 8 == 0) & mask
    holed[sky] = (110, 160, 230)
    palette = foliage_palette(holed, mask & ~sky, 12, np.random.default_rng(0))
    assert nearest_colour(BLUE[None], palette.centres)[1][0] > 30**2


def test_pixels_count_by_their_cover(mask):
    upper = np.indices(mask.shape)[0] < 150
    photo = np.where(upper[..., None], np.uint8((60, 120, 30)), np.uint8((150, 60, 40)))
    cover = np.where(upper, np.float32(0.2), np.float32(0.8)) * mask
    palette = foliage_palette(photo, cover, 2, np.random.default_rng(0))
    assert palette.shares[0] == pytest.approx(0.8, abs=0.03)
    assert palette.centres[0, 1] > 20


@pytest.mark.parametrize("seed", range(6))
def test_each_hue_has_clusters_of_its_own_amid_light_and_shade(mask, seed):
    """A crown that is yellow on the left and red on the right, with light and dark sprays all over."""
    rows, columns = np.indices(mask.shape)
    light = 0.35 + 0.65 * ((rows // 12 + columns // 12) % 5 / 4)
    colour = np.where((columns < 150)[..., None], np.float64((235, 170, 40)), np.float64((225, 70, 40)))
    palette = foliage_palette((colour * light[..., None]).astype(np.uint8), mask, 10, np.random.default_rng(seed))
    hue = np.degrees(np.arctan2(palette.centres[:, 2], palette.centres[:, 1]))
    wanted = np.array([lab_from_rgb(np.uint8([[rgb]]))[0, 0] for rgb in ((235, 170, 40), (225, 70, 40))])
    yellow, red = np.degrees(np.arctan2(wanted[:, 2], wanted[:, 1]))
    for own in (yellow, red):
        assert palette.shares[np.abs(hue - own) < 8].sum() > 0.35


def test_one_colour_gives_one_cluster(mask):
    photo = np.full((*mask.shape, 3), 90, np.uint8)
    assert len(foliage_palette(photo, mask, 12, np.random.default_rng(0)).shares) == 1


def test_two_colours_give_two_clusters_by_their_areas(mask):
    upper = np.indices(mask.shape)[0] < 120
    photo = np.where(upper[..., None], np.uint8((60, 120, 30)), np.uint8((150, 60, 40)))
    palette = foliage_palette(photo, mask, 2, np.random.default_rng(0))
    spread = [np.ptp(colours, axis=0).max() for colours in palette.members]
    assert spread == pytest.approx([0, 0], abs=0.2)  # a spray's colour is rounded
    assert palette.shares[1] == pytest.approx(upper[mask].mean(), abs=0.02)


def test_leaves_of_a_spray_differ_as_they_do_in_the_photo(mask):
    """Light and dark pixels alternate; the left half of the crown is green, the right one red."""
    row, column = np.indices(mask.shape)
    light = np.where((row + column) % 2, 1.0, 0.5)[..., None]
    photo = (light * np.where((column < 150)[..., None], (60, 120, 30), (150, 60, 40))).astype(np.uint8)
    green, red = sorted(foliage_palette(photo, mask, 2, np.random.default_rng(0)).members, key=lambda m: m[:, 1].mean())
    assert green[:, 1].max() < 0 < red[:, 1].min()
    assert min(green[:, 0].std(), red[:, 0].std()) > 8


def test_unshaded_colours_keep_their_order_their_hue_and_white():
    lab = np.stack([np.linspace(5, 90, 30), np.full(30, -8.0), np.full(30, 16.0)], axis=1)
    bare = unshaded(lab)
    assert (np.diff(bare[:, 0]) > 0).all()
    assert bare[:, 0].mean() > lab[:, 0].mean()
    assert bare[:, 2] == pytest.approx(-2 * bare[:, 1])
    assert unshaded(np.array([[100.0, 0.0, 0.0]]))[0, 0] == pytest.approx(99.0, abs=1.0)


def test_an_empty_mask_is_refused(photo):
    with pytest.raises(ValueError, match="cover with foliage"):
        foliage_palette(photo, np.zeros(photo.shape[:2], bool), 8, np.random.default_rng(0))
