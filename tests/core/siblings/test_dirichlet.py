"""Tests of fitted Dirichlet distributions."""

import numpy as np
import pytest

from treestroke.core.siblings.dirichlet import Dirichlet, fit_dirichlet


def test_a_fit_to_many_samples_finds_the_distribution_that_they_come_from() -> None:
    true = Dirichlet(np.array([8.0, 3.0, 1.5]))
    found = fit_dirichlet(true.sample(4000, np.random.default_rng(1)))
    assert found.concentration == pytest.approx(true.concentration, rel=0.06)


def test_a_few_alike_samples_give_their_mean_and_still_some_spread() -> None:
    found = fit_dirichlet(np.full((3, 3), [0.5, 0.3, 0.2]))
    assert found.mean == pytest.approx([0.5, 0.3, 0.2], abs=0.03)
    assert found.precision < 100


def test_shares_of_nothing_are_fitted_too() -> None:
    found = fit_dirichlet(np.array([[1.0, 0.0, 0.0], [0.6, 0.4, 0.0]]))
    assert np.isfinite(found.concentration).all()
    assert (found.concentration > 0).all()


def test_without_samples_there_is_no_fit() -> None:
    with pytest.raises(ValueError, match="one sample"):
        fit_dirichlet(np.empty((0, 3)))
