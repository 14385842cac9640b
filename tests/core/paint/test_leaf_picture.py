import numpy as np
import pytest
from tests.core.paint.drawn import PURPLE, leaf_picture

from treestroke.core.paint.atlas import LeafStyle, leaf_atlas, tile_alphas, tile_labs
from treestroke.core.paint.palette import lab_from_rgb
from treestroke.core.paint.species import AUTO, SPECIES


def atlas_of(photo, mask, **look):
    return leaf_atlas(photo, mask, "leaves", np.random.default_rng(0), LeafStyle(picture=leaf_picture(), **look))


def test_the_picture_s_colour_is_the_leaves_whatever_the_photo_s(photo, mask):
    labs = tile_labs(atlas_of(photo, mask))
    own = lab_from_rgb(np.array([PURPLE], np.uint8))[0]
    assert np.abs(labs.mean(axis=0) - own).max() < 8
    assert np.abs(labs[:, 1:] - own[1:]).max() < 12


def test_what_is_clear_in_the_picture_gives_no_colour(photo, mask):
    image = atlas_of(photo, mask).image
    opaque = image[image[..., 3] > 60][:, :3].astype(int)
    assert (opaque[:, 1] > np.maximum(opaque[:, 0], opaque[:, 2]) + 10).mean() < 0.001


def test_light_and_dark_of_the_photo_stay(photo, mask):
    assert 1.0 < tile_labs(atlas_of(photo, mask))[:, 0].std() < 10


@pytest.mark.parametrize("name", ["auto", "maple", "willow"])
def test_a_pictured_spray_fills_a_quarter_to_three_quarters_of_its_tile(name, photo, mask):
    alphas = tile_alphas(atlas_of(photo, mask, species=SPECIES.get(name, AUTO))) > 127
    assert alphas.mean(axis=(1, 2)).min() >= 0.25
    assert alphas.mean(axis=(1, 2)).max() <= 0.75
    assert not alphas[:, [0, -1]].any()


def test_a_season_leaves_the_picture_s_colour(photo, mask):
    autumn = tile_labs(atlas_of(photo, mask, season="autumn")).mean(axis=0)
    assert autumn == pytest.approx(tile_labs(atlas_of(photo, mask)).mean(axis=0), abs=2)


@pytest.mark.parametrize(
    "wrong",
    [np.zeros((20, 20, 4), np.uint8), np.full((20, 20, 3), 255, np.uint8), np.ones((20, 20, 4))],
    ids=["clear", "rgb", "float"],
)
def test_what_shows_no_leaf_is_refused(wrong):
    with pytest.raises(ValueError, match="picture of a leaf"):
        LeafStyle(picture=wrong)


@pytest.mark.parametrize("shape", [(1, 1), (1, 400), (400, 1), (3, 2)])
def test_odd_pictures_are_drawn_without_a_stop(shape, photo, mask):
    speck = np.full((*shape, 4), 200, np.uint8)
    look = LeafStyle(picture=speck)
    assert leaf_atlas(photo, mask, "leaves", np.random.default_rng(0), look).image.shape == (1024, 1024, 4)
