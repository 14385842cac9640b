import numpy as np

from treestroke.core.grow.library import TYPE_2
from treestroke.core.grow.placements import turn_library


def test_a_quarter_turn_takes_forward_to_the_right() -> None:
    turned = turn_library(TYPE_2, 4).vectors
    np.testing.assert_allclose(turned[:, 1, :, 0], turned[:, 0, :, 2], atol=1e-12)
    np.testing.assert_allclose(turned[:, 1, :, 1], turned[:, 0, :, 1], atol=1e-12)
    np.testing.assert_allclose(turned[:, 1, :, 2], -turned[:, 0, :, 0], atol=1e-12)


def test_turning_keeps_lengths_and_heights() -> None:
    turned = turn_library(TYPE_2, 12).vectors
    np.testing.assert_allclose(np.linalg.norm(turned, axis=3), np.linalg.norm(turned[:, :1], axis=3).repeat(12, 1))
    np.testing.assert_allclose(turned[..., 1], turned[:, :1, :, 1].repeat(12, 1))
