import numpy as np
import pytest

from treestroke.core.imaging.quilting import QuiltParams, quilt

SMALL = QuiltParams(size=(96, 64), patch=(40, 30), overlap=(12, 8))


def stripes(height: int, width: int) -> np.ndarray:
    """Upright stripes that drift, so that neighbours rarely fit by chance."""
    x = np.arange(width)[None, :] + 3.0 * np.sin(np.arange(height)[:, None] / 9.0)
    return np.sin(x / 2.0)[..., None]


def test_a_quilt_has_the_size_and_the_values_of_its_sample() -> None:
    sample = stripes(120, 80)
    texture = quilt(sample, np.ones((120, 80), bool), SMALL, np.random.default_rng(0))
    assert texture.shape == (96, 64, 1)
    assert texture.min() >= sample.min() - 1e-9
    assert texture.max() <= sample.max() + 1e-9
    assert texture.std() == pytest.approx(sample.std(), rel=0.2)


def test_opposite_edges_fit_as_neighbours_do() -> None:
    texture = quilt(stripes(160, 100), np.ones((160, 100), bool), SMALL, np.random.default_rng(1))[..., 0]
    inside = np.quantile(np.abs(np.diff(texture, axis=1)), 0.9)
    assert np.abs(texture[:, 0] - texture[:, -1]).mean() < inside
    assert np.abs(texture[0] - texture[-1]).mean() < 0.5


def test_pixels_that_are_not_clean_are_avoided() -> None:
    sample = np.zeros((120, 80, 1))
    sample[:50] = 5.0
    clean = np.ones((120, 80), bool)
    clean[:50] = False
    assert quilt(sample, clean, SMALL, np.random.default_rng(0)).max() < 5.0 * 0.9


def test_a_sample_smaller_than_a_patch_is_refused() -> None:
    with pytest.raises(ValueError, match="holds no patch"):
        quilt(np.zeros((30, 80, 1)), np.ones((30, 80), bool), SMALL, np.random.default_rng(0))


def test_patches_within_their_overlaps_are_refused() -> None:
    with pytest.raises(ValueError, match="two overlaps"):
        QuiltParams(size=(96, 64), patch=(24, 30), overlap=(12, 8))
