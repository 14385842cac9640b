import numpy as np
import pytest

from treestroke.core.paint.atlas import Atlas, LeafStyle, leaf_atlas, tile_labs
from treestroke.core.paint.palette import foliage_palette
from treestroke.core.paint.seasons import Recolour, recolour_for, size_and_density
from treestroke.core.paint.species import AUTO, SPECIES

BROAD = [name for name, species in SPECIES.items() if not species.evergreen]


def coloured(photo, mask, colour) -> np.ndarray:
    """Paint the foliage in another colour, keeping its noise."""
    rough = photo[mask].astype(float) - photo[mask].mean(axis=0)
    other = photo.copy()
    other[mask] = np.clip(np.array(colour) + rough, 0, 255)
    return other


def recoloured(photo, mask, season, species="auto") -> np.ndarray:
    """Return the mean colour (3,) of a season's leaves, without drawing them."""
    palette, kind = foliage_palette(photo, mask, 16, np.random.default_rng(0)), SPECIES.get(species, AUTO)
    recolour = recolour_for(season, kind, palette, "needles" if kind.needles else "leaves")
    if recolour is not None:
        palette = recolour.palette(palette, 16, np.random.default_rng(0))
    return palette.centres.T @ palette.shares


def atlas_of(photo, mask, season, species="auto", shown=True, seed=0) -> Atlas:
    kind = "needles" if SPECIES.get(species, AUTO).needles else "leaves"
    return leaf_atlas(
        photo, mask, kind, np.random.default_rng(seed), LeafStyle(SPECIES.get(species, AUTO), season, shown)
    )


@pytest.mark.parametrize("name", ["auto", *BROAD])
def test_autumn_is_redder_than_summer_and_not_blue(name, photo, mask):
    summer, autumn = (recoloured(photo, mask, season, name) for season in ("summer", "autumn"))
    assert autumn[1] > summer[1] + 8
    assert autumn[2] > 20


@pytest.mark.parametrize("name", ["auto", *[name for name in BROAD if name != "cherry"]])
def test_spring_is_lighter_and_yellower_green_than_summer(name, photo, mask):
    orange = coloured(photo, mask, (210, 110, 40))
    spring, summer = (recoloured(orange, mask, season, name) for season in ("spring", "summer"))
    assert spring[0] > summer[0] + 5
    assert spring[2] > summer[2] + 5
    assert spring[1] < -3


@pytest.mark.parametrize("colour", [(210, 110, 40), (225, 222, 218), (170, 60, 50)])
def test_summer_is_green_whatever_the_photo_shows(colour, photo, mask):
    summer = recoloured(coloured(photo, mask, colour), mask, "summer")
    assert -25 < summer[1] < -8
    assert 12 < summer[2] < 40


def test_a_green_tree_keeps_its_own_green_in_summer(photo, mask):
    own = atlas_of(photo, mask, "photo")
    assert np.array_equal(atlas_of(photo, mask, "summer").image, own.image)


def test_a_tree_of_unknown_kind_keeps_the_autumn_of_its_photo(photo, mask):
    red = coloured(photo, mask, (170, 60, 50))
    assert recoloured(red, mask, "autumn") == pytest.approx(recoloured(red, mask, "photo"))
    assert recoloured(red, mask, "autumn", "birch")[1] < recoloured(red, mask, "photo")[1] - 15


@pytest.mark.parametrize("season", ["spring", "summer", "autumn"])
@pytest.mark.parametrize("name", ["pine", "spruce"])
def test_evergreens_stay_green(name, season, photo, mask):
    own, now = recoloured(photo, mask, "photo", name), recoloured(photo, mask, season, name)
    assert np.abs(now - own).max() < 8
    assert now[1] < -8


def test_a_larch_turns_gold(photo, mask):
    gold = recoloured(photo, mask, "autumn", "larch")
    assert gold[1] > 3
    assert gold[2] > 38


def test_a_cherry_blossoms_in_spring(photo, mask):
    blossom = tile_labs(atlas_of(photo, mask, "spring", "cherry"))
    assert blossom[:, 0].mean() > 75
    assert np.hypot(blossom[:, 1], blossom[:, 2]).mean() < 14


def test_blossom_becomes_leaves_in_summer(photo, mask):
    white = np.where(mask[..., None], 225, photo).astype(np.uint8)
    leaves = tile_labs(atlas_of(white, mask, "summer"))
    assert leaves[:, 1].max() < -5


def test_a_season_keeps_what_is_light_and_what_is_dark(photo, mask):
    palette = foliage_palette(photo, mask, 16, np.random.default_rng(0))
    recolour = recolour_for("autumn", AUTO, palette, False)
    assert recolour is not None
    labs = np.array([[30.0, -20, 30], [45, -20, 30], [60, -20, 30]])
    light = recolour.at(labs, np.full(3, 0.5))[:, 0]
    assert (np.diff(light) > 4).all()


def test_positions_run_through_the_ramp():
    ramp = np.array([[50.0, -10, 30], [60, 0, 40], [50, 20, 30]])
    recolour = Recolour(np.array([40.0, 0, 0]), ramp, np.zeros(3))
    assert recolour.at(np.full((3, 3), 40.0), np.array([0, 0.5, 1])) == pytest.approx(ramp)


def test_autumn_s_tiles_differ_in_hue(photo, mask):
    labs = tile_labs(atlas_of(photo, mask, "autumn"))
    assert np.ptp(labs[:, 1]) > 12


def test_a_bare_photo_gives_the_season_s_colours_and_none_of_its_own(photo, mask):
    blue = coloured(photo, mask, (60, 90, 200))
    atlas = atlas_of(blue, mask, "summer", shown=False)
    assert (tile_labs(atlas)[:, 1] < -8).all()
    assert atlas.recolour is not None
    skies = atlas.recolour.at(np.array([[30.0, 0, -40], [90, 0, 0]]), np.full(2, 0.5))
    assert skies[0] == pytest.approx(skies[1])


def test_spring_has_fewer_and_smaller_leaves_and_evergreens_have_all():
    assert size_and_density("spring", AUTO, "leaves") == (0.8, 0.6)
    assert size_and_density("autumn", SPECIES["oak"], "leaves") == (1.0, 0.85)
    assert size_and_density("summer", AUTO, "leaves") == size_and_density("photo", AUTO, "leaves") == (1.0, 1.0)
    assert (
        size_and_density("spring", SPECIES["pine"], "needles")
        == size_and_density("autumn", AUTO, "needles")
        == (1.0, 1.0)
    )
