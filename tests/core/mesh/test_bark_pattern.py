from typing import get_args

import numpy as np
import pytest

from treestroke.core.mesh.bark_pattern import BarkForm, bark_pattern

FORMS = get_args(BarkForm)


@pytest.mark.parametrize("form", FORMS)
def test_a_pattern_has_mean_0_and_deviation_1(form: BarkForm) -> None:
    pattern = bark_pattern((128, 64), np.random.default_rng(3), form)
    assert (pattern.mean(), pattern.std()) == pytest.approx((0.0, 1.0), abs=1e-9)


@pytest.mark.parametrize("form", FORMS)
def test_a_pattern_repeats_without_seam(form: BarkForm) -> None:
    pattern = bark_pattern((256, 128), np.random.default_rng(3), form)
    for lines in (pattern, pattern.T):
        step = np.abs(np.diff(lines, axis=0)).mean(axis=1)
        assert np.abs(lines[0] - lines[-1]).mean() < 1.5 * step.max()


def test_fissures_run_upright() -> None:
    pattern = bark_pattern((256, 128), np.random.default_rng(3))
    assert np.abs(np.diff(pattern, axis=1)).mean() > 1.5 * np.abs(np.diff(pattern, axis=0)).mean()


def test_bands_and_lenticels_run_around_the_stem() -> None:
    pattern = bark_pattern((256, 128), np.random.default_rng(3), "banded")
    assert np.abs(np.diff(pattern, axis=0)).mean() > 3 * np.abs(np.diff(pattern, axis=1)).mean()


def test_lenticels_are_few_and_dark() -> None:
    pattern = bark_pattern((256, 128), np.random.default_rng(3), "banded")
    assert ((pattern - pattern.mean()) ** 3).mean() < -0.5


def test_scales_are_smaller_than_plates() -> None:
    plates, scales = (bark_pattern((512, 256), np.random.default_rng(3), form) < -1 for form in ("plated", "scaly"))
    assert np.abs(np.diff(scales.astype(int), axis=1)).sum() > 1.5 * np.abs(np.diff(plates.astype(int), axis=1)).sum()


def test_forms_differ() -> None:
    patterns = [bark_pattern((128, 64), np.random.default_rng(3), form).ravel() for form in FORMS]
    alike = np.corrcoef(patterns) - np.eye(len(FORMS))
    assert alike.max() < 0.9
