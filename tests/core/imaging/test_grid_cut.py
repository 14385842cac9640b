"""Cuts of tiny grids are compared with the cheapest of all labellings, found by enumeration."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from treestroke.core.imaging.grid_cut import SOFTEST_STEP, cut_grid

SMALL = 10_000


def energy(labels: np.ndarray, pixels: np.ndarray, odds: np.ndarray, region: np.ndarray, smoothness: float) -> float:
    """Cost of a labelling: the log odds that it contradicts, and its borders between pixels of the region."""
    total = float(np.where(labels, np.maximum(-odds, 0), np.maximum(odds, 0))[region].sum())
    for axis in (0, 1):
        colours = np.diff(pixels.astype(float), axis=axis)
        price = smoothness / np.maximum(np.linalg.norm(colours, axis=-1), SOFTEST_STEP)
        ends = [np.take(region, range(i, region.shape[axis] - 1 + i), axis) for i in (0, 1)]
        total += float(price[(np.diff(labels.astype(int), axis=axis) != 0) & ends[0] & ends[1]].sum())
    return total


def least_energy(pixels: np.ndarray, odds: np.ndarray, region: np.ndarray, smoothness: float) -> float:
    labels, found = np.zeros(region.shape, dtype=bool), []
    for chosen in product([False, True], repeat=int(region.sum())):
        labels[region] = chosen
        found.append(energy(labels, pixels, odds, region, smoothness))
    return min(found)


def disc(size: int, radius: float) -> np.ndarray:
    y, x = np.mgrid[:size, :size] + 0.5
    return np.hypot(x - size / 2, y - size / 2) < radius


def iou(first: np.ndarray, second: np.ndarray) -> float:
    return float((first & second).sum() / (first | second).sum())


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 5.0, 30.0, 90.0]))
def test_the_cut_is_the_least_of_all_labellings(seed: int, smoothness: float) -> None:
    rng = np.random.default_rng(seed)
    pixels = rng.integers(0, 60, (3, 3, 3), dtype=np.uint8)
    odds = rng.normal(0, 4, (3, 3)).astype(np.float32)
    region = rng.random((3, 3)) < 0.85
    found = cut_grid(pixels, odds, region, smoothness, SMALL)
    best = least_energy(pixels, odds, region, smoothness)
    assert energy(found, pixels, odds, region, smoothness) == pytest.approx(best, abs=1e-4)


@pytest.mark.parametrize("coarse_pixels", [500, 20_000])
def test_nothing_outside_the_region_is_labelled(coarse_pixels: int) -> None:
    region = disc(128, 50)
    found = cut_grid(np.zeros((128, 128, 3), np.uint8), np.full((128, 128), 5, np.float32), region, 30.0, coarse_pixels)
    assert np.array_equal(found, region)


def test_without_smoothness_the_odds_alone_decide() -> None:
    odds = np.random.default_rng(2).normal(size=(20, 30)).astype(np.float32)
    found = cut_grid(np.zeros((20, 30, 3), np.uint8), odds, np.ones((20, 30), dtype=bool), 0.0, SMALL)
    assert np.array_equal(found, odds > 0)


def test_a_speck_is_smoothed_away() -> None:
    odds = np.full((21, 21), -1.0, np.float32)
    odds[10, 10] = 4.0
    pixels, region = np.zeros((21, 21, 3), np.uint8), np.ones((21, 21), dtype=bool)
    assert not cut_grid(pixels, odds, region, 30.0, SMALL).any()
    assert cut_grid(pixels, odds, region, 3.0, SMALL).sum() == 1


@pytest.mark.parametrize("coarse_pixels", [1_500, 6_000, 100_000])
def test_a_bounded_cut_keeps_a_clean_disc(coarse_pixels: int) -> None:
    truth = disc(256, 90)
    pixels = np.where(truth[..., None], np.uint8(60), np.uint8(200)) * np.ones(3, np.uint8)
    odds = np.where(truth, 3.0, -3.0).astype(np.float32)
    found = cut_grid(pixels, odds, np.ones_like(truth), 30.0, coarse_pixels)
    assert iou(found, truth) > 0.995


def test_a_bounded_cut_comes_near_the_full_one_on_a_noisy_disc() -> None:
    truth, rng = disc(200, 70), np.random.default_rng(5)
    odds = (np.where(truth, 1.5, -1.5) + rng.normal(0, 1.5, truth.shape)).astype(np.float32)
    pixels = np.clip(np.where(truth, 80, 160)[..., None] + rng.normal(0, 8, (200, 200, 3)), 0, 255).astype(np.uint8)
    full, bounded = (cut_grid(pixels, odds, np.ones_like(truth), 30.0, most) for most in (100_000, 4_000))
    assert iou(full, bounded) > 0.98


def test_an_empty_region_gives_no_label() -> None:
    none = np.zeros((9, 9), dtype=bool)
    assert not cut_grid(np.zeros((9, 9, 3), np.uint8), np.ones((9, 9), np.float32), none, 30.0, SMALL).any()
