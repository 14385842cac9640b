import numpy as np
import pytest

from treestroke.core.paint.species import AUTO, SPECIES
from treestroke.core.paint.sprays import draw_spray

MEMBERS = np.array([[45.0, -20.0, 25.0], [55.0, -18.0, 28.0], [50.0, -22.0, 20.0]])


def covered(shape) -> float:
    """Mean share of a tile that eight sprays cover."""
    drawn = [draw_spray(shape, 128, MEMBERS, np.random.default_rng(seed))[..., 3] for seed in range(8)]
    return float(np.mean([(alpha > 127).mean() for alpha in drawn]))


@pytest.mark.parametrize("shape", ["broad", "blossom"])
def test_a_spray_covers_near_half_its_tile_and_leaves_gaps(shape):
    assert 0.36 <= covered(shape) <= 0.58


@pytest.mark.parametrize("shape", ["needles", "scales", "frond", "strap"])
def test_what_is_fine_leaves_most_of_its_tile_open(shape):
    assert 0.12 <= covered(shape) <= 0.35


@pytest.mark.parametrize("shape", ["needles", "scales", "frond"])
def test_fine_sprays_keep_their_gaps_where_they_are_small(shape):
    # Seen 16 px wide, a leaf is a blot, while a comb still has more edge than a blot of its area.
    def edge(shape) -> float:
        alpha = draw_spray(shape, 256, MEMBERS, np.random.default_rng(1))[..., 3].astype(float) / 255
        small = alpha.reshape(16, 16, 16, 16).mean(axis=(1, 3))
        return float((np.abs(np.diff(small, axis=0)).sum() + np.abs(np.diff(small, axis=1)).sum()) / small.sum())

    assert edge(shape) > 1.2 * edge("broad")


@pytest.mark.parametrize("shape", ["needles", "scales"])
def test_conifers_sprays_are_narrow_and_do_not_fall_apart_where_they_are_small(shape):
    # Seen 16 px wide and cut, as in a view of the whole tree, a broad or torn spray reads as a lobed leaf.
    # Their cards are slim too, so that a spray may be broader in its tile.
    alphas = [draw_spray(shape, 256, MEMBERS, np.random.default_rng(seed))[..., 3] for seed in range(8)]
    small = [alpha.reshape(16, 16, 16, 16).mean(axis=(1, 3)) >= 127 for alpha in alphas]
    assert np.mean([cut.mean() / (alpha >= 127).mean() for cut, alpha in zip(small, alphas, strict=True)]) > 0.9
    for cut in small:
        rows, columns = np.nonzero(cut)
        assert np.std(columns) < 0.75 * np.std(rows)


@pytest.mark.parametrize("shape", ["broad", "needles", "scales", "frond", "strap", "blossom"])
def test_the_border_is_clear(shape):
    alpha = draw_spray(shape, 128, MEMBERS, np.random.default_rng(0))[..., 3]
    assert max(alpha[0].max(), alpha[-1].max(), alpha[:, 0].max(), alpha[:, -1].max()) == 0


def test_clear_pixels_have_the_leaves_colour():
    tile = draw_spray("broad", 128, MEMBERS, np.random.default_rng(0)).astype(float)
    opaque, clear = tile[tile[..., 3] > 250][:, :3], tile[tile[..., 3] == 0][:, :3]
    assert np.abs(opaque.mean(axis=0) - clear.mean(axis=0)).max() < 16


def test_the_same_seed_draws_the_same_spray():
    first, second = (draw_spray("needles", 64, MEMBERS, np.random.default_rng(5)) for _ in range(2))
    assert np.array_equal(first, second)


def test_no_two_sprays_have_the_same_outline():
    shown = [draw_spray("broad", 64, MEMBERS, np.random.default_rng(seed))[..., 3] > 127 for seed in range(6)]
    overlaps = [(a & b).sum() / (a | b).sum() for i, a in enumerate(shown) for b in shown[:i]]
    assert max(overlaps) < 0.8


def of(name: str, seed: int = 0) -> np.ndarray:
    """Draw a species' spray."""
    shape = "needles" if SPECIES.get(name, AUTO).needles else "broad"
    return draw_spray(shape, 128, MEMBERS, np.random.default_rng(seed), SPECIES.get(name, AUTO))


@pytest.mark.parametrize("name", SPECIES)
def test_a_species_fills_a_quarter_to_three_quarters_of_its_tile(name):
    covered = [(of(name, seed)[..., 3] > 127).mean() for seed in range(4)]
    assert min(covered) >= (0.15 if SPECIES[name].needles == "short" else 0.25)  # short needles leave gaps
    assert max(covered) <= 0.75


def test_a_pine_s_brush_is_as_broad_as_long_and_has_a_frayed_rim():
    alphas = [draw_spray("needles", 256, MEMBERS, np.random.default_rng(k), SPECIES["pine"])[..., 3] for k in range(4)]
    for alpha in alphas:
        rows, columns = np.nonzero(alpha > 127)
        distance = np.hypot(rows - rows.mean(), columns - columns.mean())
        assert 0.8 < np.std(columns) / np.std(rows) < 1.7
        near, far = (np.count_nonzero((distance >= a) & (distance < a + 20)) / (a + 10) for a in (20, 80))
        assert far < 0.6 * near


@pytest.mark.parametrize("name", SPECIES)
def test_a_species_leaves_the_border_clear(name):
    alpha = of(name)[..., 3]
    assert max(alpha[0].max(), alpha[-1].max(), alpha[:, 0].max(), alpha[:, -1].max()) == 0


def test_species_differ_from_each_other_and_from_a_tree_of_unknown_kind():
    shown = [of(name)[..., 3] > 127 for name in ("auto", *SPECIES)]
    overlaps = [(a & b).sum() / (a | b).sum() for i, a in enumerate(shown) for b in shown[:i]]
    assert max(overlaps) < 0.85


def test_needles_have_more_edge_for_their_area_than_leaves():
    def edge(name: str) -> float:
        opaque = (of(name)[..., 3] > 127).astype(int)
        return (np.abs(np.diff(opaque, axis=0)).sum() + np.abs(np.diff(opaque, axis=1)).sum()) / opaque.sum()

    assert min(edge("pine"), edge("larch"), edge("spruce")) > edge("plane")
