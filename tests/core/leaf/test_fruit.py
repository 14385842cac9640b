from dataclasses import replace

import cv2
import numpy as np
import pytest
from tests.core.leaf.conftest import view_of

from treestroke.core.appearance import Appearance
from treestroke.core.geometry.crown_volume import Silhouette, shown_by_all
from treestroke.core.geometry.mesh import Surface
from treestroke.core.geometry.outline_volume import TurnedOutline
from treestroke.core.geometry.silhouette import framing, silhouettes
from treestroke.core.leaf.cards import cards
from treestroke.core.leaf.fruit import FruitParams, hang_fruit, with_fruit
from treestroke.core.leaf.leaf_crown import leaf_crown
from treestroke.core.leaf.leaves import Leaves, fruit_among, leaf_area, no_leaves
from treestroke.core.leaf.placement import LeafParams, place_leaves
from treestroke.core.leaf.thinning import Coverage, thin_leaves
from treestroke.core.paint.atlas import Atlas, tile_alphas
from treestroke.core.skeleton.skeleton import Skeleton

ORANGE = (230, 130, 20)


def fruit_picture(width: int = 90, height: int = 100) -> np.ndarray:
    """An orange oval that fills its picture, transparent and green around."""
    picture = np.zeros((height, width, 4), np.uint8)
    picture[..., 1] = 255
    cv2.ellipse(picture, (width // 2, height // 2), (width // 2, height // 2), 0, 0, 360, (*ORANGE, 255), -1)
    return picture


@pytest.fixture(scope="module")
def views(volume: TurnedOutline, mask: np.ndarray) -> list[Silhouette]:
    return [Silhouette(mask, volume.camera)]


@pytest.fixture(scope="module")
def fruit(tree: Skeleton, volume: TurnedOutline, views: list[Silhouette]) -> Leaves:
    return hang_fruit(tree, volume, views, FruitParams(aspect=100 / 90), np.random.default_rng(0))


@pytest.fixture(scope="module")
def leaves(tree, mask, volume, photo, atlas) -> Leaves:
    rng = np.random.default_rng(0)
    crown = leaf_crown(Appearance((view_of(photo, mask, volume.camera),), True), volume, atlas, 1.0, rng)
    return place_leaves(tree, crown, LeafParams(density=0.3), rng)


def one_of_each(fruit: Leaves) -> Leaves:
    return fruit.select(np.arange(len(fruit)) < len(fruit) // 2)


def test_fruit_hangs_inside_the_crown(fruit, volume, views):
    lowest = fruit.centres - fruit.ups * 0.9
    assert shown_by_all(views, fruit.centres).all()
    assert shown_by_all(views, lowest).all()
    assert volume.reach(fruit.centres).max() <= 1


def test_a_tree_bears_sixty_to_two_hundred(fruit):
    assert 60 <= len(fruit) // 2 <= 200


def test_a_fruit_is_two_crossed_upright_cards(fruit):
    first, second = one_of_each(fruit), fruit.select(np.arange(len(fruit)) >= len(fruit) // 2)
    assert np.array_equal(first.centres, second.centres)
    assert np.abs((first.rights * second.rights).sum(axis=1)).max() < 1e-12
    assert (fruit.ups[:, [0, 2]] == 0).all()
    assert (fruit.ups[:, 1] > 0).all()


def test_fruit_hangs_below_its_twig_and_near_it(fruit, tree):
    half = fruit.ups[:, 1]
    ends, starts = tree.points[fruit.joints], tree.points[tree.parents[fruit.joints]]
    way = ends - starts
    share = np.clip(((fruit.centres - starts) * way).sum(axis=1) / (way**2).sum(axis=1), 0, 1)
    gap = fruit.centres - starts - share[:, None] * way
    assert (np.linalg.norm(gap, axis=1) < 2.2 * half).all()
    assert np.median(gap[:, 1]) < 0


def test_fruits_are_a_hundredth_to_a_fiftieth_of_the_crown_wide(fruit, volume):
    width = 2 * np.linalg.norm(fruit.rights, axis=1) * 0.9 / (2 * volume.radius_px.max() * 10 / 360)
    assert 0.01 < width.min() < width.max() < 0.022


def test_clusters_are_larger(tree, volume, views, fruit):
    tall = hang_fruit(tree, volume, views, FruitParams(aspect=110 / 60), np.random.default_rng(0))
    assert tall.ups[:, 1].mean() > 1.5 * fruit.ups[:, 1].mean()


def test_fruits_stand_apart_and_more_outside_than_within(fruit, volume):
    centres = one_of_each(fruit).centres
    gaps = np.linalg.norm(centres[:, None] - centres[None], axis=2) + 9 * np.eye(len(centres))
    assert gaps.min() > 2 * fruit.ups[:, 1].min()
    assert (volume.reach(centres) > 0.6).mean() > 0.6


def test_leaves_show_no_fruit_and_keep_their_colours(leaves, atlas, fruit):
    both, wider = with_fruit(leaves, atlas, fruit, fruit_picture())
    there = fruit_among(both, wider)
    assert there.sum() == len(fruit)
    moved = both.tiles[: len(leaves)] != leaves.tiles
    assert moved.mean() < 1 / 16
    assert np.array_equal(np.delete(wider.colours, wider.fruit, 0), np.delete(atlas.colours, wider.fruit, 0))


def test_the_fruit_s_own_colour_is_in_its_tile(leaves, atlas, fruit):
    _, wider = with_fruit(leaves, atlas, fruit, fruit_picture())
    left, top = np.rint(wider.boxes[wider.fruit, :2] * 1024).astype(int)
    tile = wider.image[top : top + 256, left : left + 256]
    assert np.abs(tile[tile[..., 3] > 200][:, :3].astype(int) - ORANGE).max() <= 2
    assert not tile[[0, -1], :, 3].any()
    assert not tile[:, [0, -1], 3].any()


def test_fruit_alone_hangs_on_a_bare_tree(fruit):
    alone, atlas = with_fruit(no_leaves(), None, fruit, fruit_picture())
    assert fruit_among(alone, atlas).all()
    assert tile_alphas(atlas).shape == (1, 256, 256)
    assert len(cards(alone, atlas).triangles) == 2 * len(fruit)


def test_leaf_area_counts_no_fruit(leaves, atlas, fruit):
    both, wider = with_fruit(leaves, atlas, fruit, fruit_picture())
    assert leaf_area(both, wider) == pytest.approx(leaf_area(leaves, atlas), rel=0.02)
    assert leaf_area(*with_fruit(no_leaves(), None, fruit, fruit_picture())) == 0


def kept_of(both: Leaves, wider: Atlas, count: int) -> np.ndarray:
    surface = Surface(cards(both, wider), wider.image)
    view = framing([surface], 100)
    values = silhouettes([surface], view).astype(np.float64)
    kept = thin_leaves(both, wider, count, Coverage(view, values))
    assert len(kept) == count
    return fruit_among(kept, wider)


def test_a_thinned_tree_keeps_its_fruit(leaves, atlas, fruit):
    both = with_fruit(leaves, atlas, fruit, fruit_picture())
    assert kept_of(*both, 4 * len(fruit)).sum() == len(fruit)
    assert kept_of(*both, 40).sum() == 10
    assert kept_of(*with_fruit(no_leaves(), None, fruit, fruit_picture()), 40).sum() == 40


def test_the_same_numbers_hang_the_same_fruit(tree, volume, views, fruit):
    again = hang_fruit(tree, volume, views, FruitParams(aspect=100 / 90), np.random.default_rng(0))
    assert np.array_equal(again.centres, fruit.centres)
    assert np.array_equal(again.rights, fruit.rights)


def test_no_fruit_hangs_where_there_is_no_room(tree, volume, views):
    nowhere = [replace(views[0], mask=np.zeros_like(views[0].mask))]
    assert len(hang_fruit(tree, volume, nowhere, FruitParams(), np.random.default_rng(0))) == 0


@pytest.mark.parametrize("wrong", [{"width": (0.02, 0.01)}, {"fewest": 300}, {"apart": -1.0}])
def test_params_out_of_range_are_refused(wrong):
    with pytest.raises(ValueError, match="must"):
        FruitParams(**wrong)
