import numpy as np
import pytest

from treestroke.core.film.spectra import swings

TIME = np.arange(240) / 30.0


def test_frequencies_are_found() -> None:
    series = np.stack([np.sin(2.0 * np.pi * hertz * TIME + 0.3) for hertz in (0.7, 1.4, 3.1)], axis=1)
    found = swings(series, 30.0)
    assert found.frequency_hz == pytest.approx([0.7, 1.4, 3.1], abs=0.05)
    assert (found.sureness > 0.9).all()


def test_a_damped_swing_has_its_damping() -> None:
    rng = np.random.default_rng(4)
    state, series = np.zeros(2), []
    omega, zeta, step = 2.0 * np.pi * 1.5, 0.1, 1.0 / 600.0
    for _ in range(60 * 600):
        push = rng.normal(0.0, 40.0)
        state[1] += step * (push - omega**2 * state[0] - 2.0 * zeta * omega * state[1])
        state[0] += step * state[1]
        series.append(state[0])
    found = swings(np.array(series[::20])[:, None], 30.0)
    assert found.frequency_hz[0] == pytest.approx(1.5, abs=0.2)
    assert 0.01 < found.damping[0] < 0.25


def test_a_steady_swing_has_no_damping_that_could_be_told() -> None:
    assert np.isnan(swings(np.sin(2.0 * np.pi * 1.5 * TIME)[:, None], 30.0).damping[0])


def test_noise_and_stillness_are_not_sure() -> None:
    rng = np.random.default_rng(1)
    found = swings(np.stack([rng.normal(size=240), np.zeros(240)], axis=1), 30.0)
    steady = swings(np.sin(2.0 * np.pi * 1.5 * TIME)[:, None], 30.0)
    assert found.sureness[0] < steady.sureness[0]
    assert found.sureness[1] == 0.0
