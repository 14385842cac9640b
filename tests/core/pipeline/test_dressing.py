from functools import cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from tests.conftest import DATA, EXAMPLES
from tests.core.pipeline.recipes import model_photo

import treestroke
from treestroke.core.leaf.leaves import fruit_among
from treestroke.core.paint.atlas import tile_labs
from treestroke.core.pipeline.dressing import OwnPictures
from treestroke.core.pipeline.evidence import read_photo
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.service.loading import load_photo, load_strokes
from treestroke.service.model import Model

MAPLE, BARE = EXAMPLES / "sugar_maple_autumn", DATA / "bigleaf_maple_bare"


@cache
def modelled(tree: Path, **settings: str) -> Model:
    return treestroke.model(tree.with_suffix(".jpg"), tree.with_suffix(".strokes.json"), {"iterations": 30, **settings})


def overlap(model: Model) -> float:
    return model.report["score"]["silhouette_iou"]


def hue(model: Model) -> np.ndarray:
    """Mean colour (3,) of the cards, CIE Lab."""
    tree = model.tree
    assert tree.atlas is not None
    assert tree.cards is not None
    return tile_labs(tree.atlas)[tree.cards.tiles].mean(axis=0)


def test_summer_keeps_the_silhouette_of_the_photo() -> None:
    assert overlap(modelled(MAPLE, season="summer")) >= overlap(modelled(MAPLE)) - 0.05


def test_an_autumn_tree_is_green_in_summer() -> None:
    assert hue(modelled(MAPLE))[1] > 25
    assert hue(modelled(MAPLE, season="summer"))[1] < -8


def test_no_tree_has_leaves_when_the_season_is_bare() -> None:
    bare = modelled(MAPLE, season="bare")
    assert bare.tree.leaf is None
    assert bare.tree.taken.foliage == "bare"
    assert bare.tree.branches > 2 * modelled(MAPLE).tree.branches


def test_a_bare_tree_stays_bare_whatever_its_species_unless_a_season_says_otherwise() -> None:
    assert modelled(BARE, species="maple").tree.leaf is None
    leafy = modelled(BARE, species="maple", season="summer")
    assert len(leafy.tree.cards or ()) > 5000
    assert hue(leafy)[1] < -8


def test_the_leaves_of_a_bare_tree_fill_its_crown() -> None:
    assert overlap(modelled(BARE, season="summer")) > 0.85


def test_spring_has_fewer_leaves_for_their_area_than_summer() -> None:
    def area(season: str) -> float:
        cards = modelled(MAPLE, season=season).tree.cards
        assert cards is not None
        return float((np.linalg.norm(cards.rights, axis=1) * np.linalg.norm(cards.ups, axis=1)).sum())

    assert area("spring") < 0.75 * area("summer")


def test_a_conifer_s_name_gives_needles_and_a_broad_leaved_one_s_leaves() -> None:
    assert modelled(MAPLE, species="pine").tree.taken.foliage == "needles"
    assert modelled(MAPLE, species="oak").tree.taken.foliage == "leaves"
    assert modelled(MAPLE, species="pine", foliage="leaves").tree.taken.foliage == "leaves"


def test_foliage_that_is_asked_to_be_bare_stays_so_in_summer() -> None:
    assert modelled(MAPLE, season="summer", foliage="bare").tree.leaf is None


def test_clumps_of_autumn_differ_in_hue() -> None:
    tree = modelled(MAPLE, season="autumn", species="oak").tree
    assert tree.cards is not None
    assert tree.atlas is not None
    red = tile_labs(tree.atlas)[tree.cards.tiles, 1]
    side = np.floor(tree.cards.centres / 1.5).astype(int)
    _, clump = np.unique(side, axis=0, return_inverse=True)
    count = np.bincount(clump)
    means = (np.bincount(clump, red) / count)[count > 60]
    assert means.std() > 2.5 * red.std() / np.sqrt(60)


def test_the_bark_has_a_relief_of_its_texture_s_size() -> None:
    bark = modelled(MAPLE).tree.bark
    assert bark.normal_map is not None
    assert bark.normal_map.shape == bark.texture.shape


def test_a_beech_s_bark_is_smoother_than_an_oak_s() -> None:
    def tilt(species: str) -> float:
        relief = modelled(MAPLE, species=species).tree.bark.normal_map
        assert relief is not None
        return float(np.abs(relief[..., :2].astype(float) - 128).mean())

    assert tilt("beech") < 0.5 * tilt("oak")


def test_the_species_does_not_move_the_wood() -> None:
    plain, oak = modelled(MAPLE).tree.bark.mesh, modelled(MAPLE, species="oak").tree.bark.mesh
    assert np.array_equal(plain.positions, oak.positions)


def test_a_leaf_s_picture_colours_the_tree() -> None:
    picture = np.zeros((120, 90, 4), np.uint8)
    cv2.ellipse(picture, (45, 50), (30, 45), 0, 0, 360, (60, 90, 200, 255), -1)
    given = load_photo(MAPLE.with_suffix(".jpg")), load_strokes(MAPLE.with_suffix(".strokes.json"))
    tree = model_photo(
        read_photo(*given), ModelSettings(iterations=30), np.random.default_rng(0), pictures=OwnPictures(picture)
    )
    assert tree.atlas is not None
    assert (tile_labs(tree.atlas)[:, 2] < -30).all()


@pytest.mark.parametrize("season", ["spring", "autumn"])
def test_a_season_gives_the_same_bytes_again(season: str) -> None:
    tree = BARE.with_suffix(".jpg"), BARE.with_suffix(".strokes.json")
    again = treestroke.model(*tree, {"iterations": 30, "season": season})
    assert again.glb == modelled(BARE, season=season).glb


@pytest.mark.parametrize("settings", [{}, {"season": "bare"}, {"leaf_density": 0.0}], ids=["leafy", "bare", "thin"])
def test_fruit_hangs_on_the_same_tree_with_or_without_leaves(settings: dict[str, Any]) -> None:
    picture = np.zeros((120, 110, 4), np.uint8)
    cv2.circle(picture, (55, 60), 50, (230, 130, 20, 255), -1)
    seen = read_photo(load_photo(MAPLE.with_suffix(".jpg")), load_strokes(MAPLE.with_suffix(".strokes.json")))
    what = seen, ModelSettings(iterations=30, **settings)
    plain = model_photo(*what, np.random.default_rng(0))
    borne = model_photo(*what, np.random.default_rng(0), pictures=OwnPictures(fruit=picture))
    assert borne.cards is not None
    assert borne.atlas is not None
    fruit = fruit_among(borne.cards, borne.atlas)
    assert 120 <= fruit.sum() <= 400
    assert np.array_equal(borne.bark.mesh.positions, plain.bark.mesh.positions)
    assert np.array_equal(borne.bark.texture, plain.bark.texture)
    assert np.array_equal(borne.cards.centres[~fruit], np.zeros((0, 3)) if plain.cards is None else plain.cards.centres)
    assert borne.measures.figures["crown_width"] == plain.measures.figures["crown_width"]


def test_wood_is_lit_as_in_the_photo_only_where_the_photo_shows_it_bare() -> None:
    assert modelled(BARE).tree.bark.mesh.shades is not None
    assert modelled(MAPLE, season="bare").tree.bark.mesh.shades is None  # the light there is that of leaves
