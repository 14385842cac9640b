import numpy as np
import pytest

from treestroke.core.leaf.sprays import draw_spray

MEMBERS = np.array([[45.0, -20.0, 25.0], [55.0, -18.0, 28.0], [50.0, -22.0, 20.0]])


@pytest.mark.parametrize("shape", ["broad", "needles", "blossom"])
def test_a_spray_covers_near_half_its_tile_and_leaves_gaps(shape):
    covered = [(draw_spray(shape, 128, MEMBERS, np.random.default_rng(seed))[..., 3] > 127).mean() for seed in range(8)]
    assert 0.36 <= np.mean(covered) <= 0.58


@pytest.mark.parametrize("shape", ["broad", "needles", "blossom"])
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
