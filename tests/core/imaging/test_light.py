import numpy as np
import pytest

from treestroke.core.imaging.light import (
    LEAST_LIGHTNESS,
    LIT,
    brightened,
    evened,
    exposed,
    linear_light,
    luminance_of_lightness,
    srgb_light,
)
from treestroke.core.paint.palette import lab_from_rgb


def test_linear_light_and_back_is_the_same_colour():
    values = np.arange(256.0)
    assert np.array_equal(srgb_light(linear_light(values)), values)


def test_luminance_is_that_of_grey_of_this_lightness():
    greys = np.repeat(np.array([3, 20, 90, 180, 255], np.uint8)[:, None], 3, axis=1)
    lightness = lab_from_rgb(greys)[:, 0]
    assert luminance_of_lightness(lightness) == pytest.approx(linear_light(greys[:, 0].astype(float)), abs=2e-3)


def dusk(lightness: float) -> np.ndarray:
    """A noisy green picture (60, 60, 3) whose median has about this lightness."""
    rng = np.random.default_rng(0)
    linear = (
        luminance_of_lightness(np.array(lightness)) * np.array([0.8, 1.1, 0.6]) * rng.lognormal(0, 0.4, (60, 60, 1))
    )
    return srgb_light(linear)


@pytest.mark.parametrize("lightness", [6.0, 13.0, 20.0])
def test_a_dark_tree_is_brought_to_where_it_can_be_seen(lightness):
    tree = np.ones((60, 60), bool)
    before, after = (lab_from_rgb(picture) for picture in (dusk(lightness), exposed(dusk(lightness), tree)))
    assert np.quantile(after[..., 0], LIT) == pytest.approx(LEAST_LIGHTNESS, abs=1.5)
    assert np.quantile(after[..., 0], LIT) > np.quantile(before[..., 0], LIT) + 2
    hue = [np.arctan2(*lab.reshape(-1, 3).mean(axis=0)[:0:-1]) for lab in (before, after)]
    assert hue[1] == pytest.approx(hue[0], abs=0.1)


def test_a_well_exposed_tree_stays_however_dark_its_surroundings():
    picture, tree = dusk(40.0), np.zeros((60, 60), bool)
    tree[20:40] = True
    picture[~tree] = 3
    assert np.array_equal(exposed(picture, tree), picture)
    assert np.array_equal(exposed(picture, np.zeros_like(tree)), picture)


def test_noise_in_black_is_not_blown_up():
    assert exposed(np.full((8, 8, 3), 1, np.uint8), np.ones((8, 8), bool)).max() < 30


def test_brightening_keeps_hue_white_and_order():
    ramp = np.linspace(0, 1, 50)[:, None] * np.array([1.0, 0.5, 0.25])
    bright = brightened(ramp, 6.0)
    assert bright[-1] == pytest.approx(ramp[-1])
    assert (np.diff(bright[:, 0]) > 0).all()
    assert bright[1:, 1] / bright[1:, 0] == pytest.approx(np.full(49, 0.5))
    assert bright[1, 0] / ramp[1, 0] > 5


def test_evening_removes_the_shade_of_boughs_but_not_leaves():
    rng = np.random.default_rng(0)
    leaf = rng.choice([0.12, 0.2], (200, 200))
    shade = np.where(np.arange(200) < 100, 1.0, 0.4)[:, None]
    tree = np.ones((200, 200), bool)
    flat = evened(srgb_light((leaf * shade)[..., None] * np.array([0.8, 1.0, 0.5])), tree)
    lit, shaded = (linear_light(flat[rows].astype(float))[..., 1] for rows in (slice(0, 70), slice(130, 200)))
    assert lit.mean() == pytest.approx(shaded.mean(), rel=0.1)
    assert lit.std() / lit.mean() == pytest.approx(leaf.std() / leaf.mean(), rel=0.1)


def test_evening_changes_only_the_tree():
    picture, tree = dusk(40.0), np.zeros((60, 60), bool)
    tree[:30] = True
    assert np.array_equal(evened(picture, tree)[30:], picture[30:])
    assert np.array_equal(evened(picture, np.zeros_like(tree)), picture)
