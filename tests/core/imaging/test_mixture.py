from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from treestroke.core.imaging.mixture import (
    Mixture,
    Start,
    by_splitting,
    component_shares,
    distance,
    far_apart,
    fit_mixture,
    join_mixtures,
    log_components,
    log_density,
    table_colours,
    table_index,
)

GREEN, SKY = (60, 120, 30), (120, 170, 240)


def blob(colour: tuple[int, int, int], count: int = 600, spread: float = 6.0, seed: int = 0) -> np.ndarray:
    noise = np.random.default_rng(seed).normal(0, spread, (count, 3))
    return np.clip(np.array(colour) + noise, 0, 255).astype(np.uint8)


def lone(mean: tuple[float, float, float], deviation: float = 2.0) -> Mixture:
    return Mixture(np.ones(1), np.array([mean], float), np.eye(3)[None] * deviation**2)


def test_two_colours_are_told_apart_with_their_shares() -> None:
    found = fit_mixture(np.vstack([blob(GREEN, 900), blob(SKY, 300)]), 2)
    order = np.argsort(found.weights)[::-1]
    assert found.weights[order] == pytest.approx([0.75, 0.25], abs=0.01)
    assert found.means[order] == pytest.approx(np.array([GREEN, SKY], float), abs=1.5)


def test_equal_colours_give_an_equal_mixture() -> None:
    first, second = (fit_mixture(blob(GREEN, 200), 3) for _ in range(2))
    assert np.array_equal(first.means, second.means)
    assert np.array_equal(first.covariances, second.covariances)


def test_noise_hardly_changes_a_mixture_from_splitting() -> None:
    colours = np.vstack([blob(GREEN, 900, 25), blob(SKY, 300, 10, 1), blob((150, 140, 60), 500, 30, 2)])
    noisy = np.clip(colours + np.random.default_rng(3).integers(-1, 2, colours.shape), 0, 255).astype(np.uint8)
    fits = (fit_mixture(samples, 8, by_splitting) for samples in (colours, noisy))
    first, second = (log_density(mixture, colours.astype(float)) for mixture in fits)
    assert np.abs(first - second).mean() < 0.05


@pytest.mark.parametrize("start", [far_apart, by_splitting])
@pytest.mark.parametrize(("distinct", "components"), [(1, 1), (3, 1), (6, 3), (40, 10)])
def test_few_distinct_colours_give_few_components(distinct: int, components: int, start: Start) -> None:
    colours = np.repeat(blob(GREEN, distinct, spread=30), 5, axis=0)
    assert len(np.unique(colours, axis=0)) == distinct
    assert len(fit_mixture(colours, 10, start)) == components


def test_one_pixel_is_enough() -> None:
    assert fit_mixture(np.array([GREEN], np.uint8), 4).means == pytest.approx(np.array([GREEN], float))


def test_density_sums_to_one_over_all_colours() -> None:
    mixture = join_mixtures([lone((100, 120, 140), 20), lone((140, 90, 120), 16)], [1, 3])
    cell = 8.0**3
    assert np.exp(log_density(mixture, table_colours())).sum() * cell == pytest.approx(1.0, abs=1e-3)


@given(st.floats(0, 255), st.floats(0.1, 0.9))
def test_the_density_is_the_sum_of_its_components(level: float, share: float) -> None:
    mixture = join_mixtures([lone((50, 60, 70), 30), lone((150, 160, 70), 25)], [share, 1 - share])
    colour = np.array([[level, 90.0, 60.0]])
    assert np.exp(log_density(mixture, colour)) == pytest.approx(np.exp(log_components(mixture, colour)).sum(axis=1))


def test_density_far_away_stays_finite() -> None:
    assert np.isfinite(log_density(lone((0, 0, 0), 0.5), np.full((1, 3), 255.0))).all()


def test_selected_components_weigh_one_again() -> None:
    mixture = join_mixtures([lone((1, 2, 3)), lone((4, 5, 6)), lone((7, 8, 9))], [2, 1, 1])
    kept = mixture.select(np.array([True, False, True]))
    assert kept.weights == pytest.approx([2 / 3, 1 / 3])
    assert kept.means.tolist() == [[1, 2, 3], [7, 8, 9]]


def test_joined_mixtures_take_their_shares() -> None:
    pair = join_mixtures([lone((1, 2, 3)), lone((4, 5, 6))], [1, 1])
    assert join_mixtures([pair, lone((7, 8, 9))], [1, 3]).weights == pytest.approx([0.125, 0.125, 0.75])


def test_distance_is_in_deviations_of_the_nearest_component() -> None:
    mixture = join_mixtures([lone((10, 10, 10), 2), lone((90, 90, 90), 4)], [0.99, 0.01])
    assert distance(mixture, np.array([16.0, 10.0, 10.0])) == pytest.approx(3.0)
    assert distance(mixture, np.array([90.0, 98.0, 90.0])) == pytest.approx(2.0)


def test_every_colour_finds_its_cell_in_the_table() -> None:
    colours = np.random.default_rng(3).integers(0, 256, (20, 30, 3), dtype=np.uint8)
    assert np.abs(table_colours()[table_index(colours)] - colours).max() <= 4


def test_fits_are_as_likely_as_those_of_scikit_learn(maple_photo: Path) -> None:
    from sklearn.mixture import GaussianMixture  # takes seconds, which every run of other tests would spend too

    colours = cv2.imread(str(maple_photo)).reshape(-1, 3)
    learnt, unseen = colours[::400], colours[200::400].astype(float)
    oracle = GaussianMixture(8, reg_covar=4.0, tol=3e-3, random_state=0).fit(learnt.astype(float))
    assert log_density(fit_mixture(learnt, 8), unseen).mean() > oracle.score(unseen) - 0.05


def test_a_colour_is_shared_out_whole_and_by_weight_where_components_are_alike() -> None:
    mixture = join_mixtures([lone((50, 60, 70), 9), lone((50, 60, 70), 9), lone((200, 60, 70), 9)], [1, 3, 4])
    assert component_shares(mixture, np.array([[50.0, 60, 70], [200.0, 60, 70]])) == pytest.approx(
        np.array([[0.25, 0.75, 0], [0, 0, 1]]), abs=1e-6
    )
