import numpy as np
import pytest

from treestroke.core.mesh.grain import bark_grain


def test_grain_has_mean_0_and_deviation_1() -> None:
    grain = bark_grain((128, 64), np.random.default_rng(3))
    assert (grain.mean(), grain.std()) == pytest.approx((0.0, 1.0), abs=1e-9)


def test_grain_repeats_without_seam() -> None:
    grain = bark_grain((256, 128), np.random.default_rng(3))
    inside = np.abs(np.diff(grain, axis=1)).mean()
    assert np.abs(grain[:, 0] - grain[:, -1]).mean() < 1.5 * inside


def test_fissures_run_upright() -> None:
    grain = bark_grain((256, 128), np.random.default_rng(3))
    assert np.abs(np.diff(grain, axis=1)).mean() > 1.5 * np.abs(np.diff(grain, axis=0)).mean()
