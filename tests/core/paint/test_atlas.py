import cv2
import numpy as np
import pytest

from treestroke.core.paint.atlas import leaf_atlas, tile_alphas
from treestroke.core.paint.palette import lab_from_rgb


def test_boxes_lie_in_the_texture_and_do_not_overlap(atlas):
    assert atlas.boxes.min() >= 0
    assert atlas.boxes.max() <= 1
    sizes = atlas.boxes[:, 2:] - atlas.boxes[:, :2]
    assert sizes.prod(axis=1).sum() == pytest.approx(1)
    assert len(np.unique(atlas.boxes, axis=0)) == len(atlas.boxes)


def test_sides_are_powers_of_two_up_to_1024(atlas):
    assert all(side <= 1024 and side & (side - 1) == 0 for side in atlas.image.shape[:2])


def test_the_picture_takes_less_than_a_megabyte(atlas):
    assert len(cv2.imencode(".png", atlas.image)[1]) < 1_000_000


def test_colours_are_near_the_photos(atlas, photo, mask):
    mean = lab_from_rgb(np.rint(atlas.colours).astype(np.uint8)).mean(axis=0)
    lighter, redder, yellower = mean - lab_from_rgb(photo[mask]).mean(axis=0)
    assert 0 < lighter < 14  # leaves alone are lighter than a crown, whose leaves shade each other
    assert max(abs(redder), abs(yellower)) < 9


def test_every_tile_is_another_drawing(atlas):
    alphas = tile_alphas(atlas).reshape(len(atlas.boxes), -1)
    assert len(np.unique(alphas, axis=0)) == len(alphas)


def test_pale_petals_become_blossom_and_green_leaves_do_not(photo, mask):
    green = leaf_atlas(photo, mask, "leaves", np.random.default_rng(3))
    white = np.where(mask[..., None], 225, photo).astype(np.uint8)
    petals = leaf_atlas(white, mask, "leaves", np.random.default_rng(3))
    assert not np.array_equal(tile_alphas(green)[0], tile_alphas(petals)[0])


def test_dark_twigs_between_petals_are_no_petals(photo, mask):
    twigs = np.indices(mask.shape).sum(axis=0) // 5 % 4 == 0
    flowering = np.where(twigs[..., None], np.uint8((70, 45, 40)), np.uint8((235, 232, 225)))
    petals = leaf_atlas(flowering, mask, "leaves", np.random.default_rng(3))
    assert lab_from_rgb(np.rint(petals.colours).astype(np.uint8))[:, 0].min() > 65


def test_the_same_seed_gives_the_same_atlas(photo, mask, atlas):
    again = leaf_atlas(photo, mask, "leaves", np.random.default_rng(0))
    assert np.array_equal(again.image, atlas.image)
