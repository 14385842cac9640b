"""Gaussian mixtures over colours."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.mixture import GaussianMixture

Floats = NDArray[np.float64]

TABLE_BITS = 5
"""Colours are looked up in a table of 2^5 steps a channel: 32,768 densities stand for millions of pixels."""


@dataclass(frozen=True, eq=False)
class Mixture:
    """A mixture of k Gaussians over sRGB colours, 0 to 255.

    Attributes
    ----------
    weights
        (k,) not negative, summing to 1.
    means
        (k, 3).
    covariances
        (k, 3, 3) positive definite.
    """

    weights: Floats
    means: Floats
    covariances: Floats

    def __len__(self) -> int:
        return len(self.weights)

    def select(self, kept: NDArray[np.bool_]) -> "Mixture":
        """Keep some components (k,), their weights scaled to sum to 1 again; at least one must stay."""
        weights = self.weights[kept]
        return Mixture(weights / weights.sum(), self.means[kept], self.covariances[kept])


def fit_mixture(colours: NDArray[np.uint8], components: int) -> Mixture:
    """Fit a mixture to colours (n, 3), by expectation maximisation from a k-means start.

    Fewer distinct colours than components give fewer components. The start is seeded, so equal colours
    give an equal mixture.
    """
    samples = colours.reshape(-1, 3).astype(np.float64)
    distinct = len(np.unique(samples, axis=0))
    if distinct < 2 * components:
        components = max(1, distinct // 2)
    model = GaussianMixture(components, reg_covar=4.0, max_iter=60, tol=3e-3, init_params="k-means++", random_state=0)
    model.fit(samples if len(samples) > 1 else np.repeat(samples, 2, axis=0))
    return Mixture(model.weights_, model.means_, model.covariances_)


def join_mixtures(mixtures: Sequence[Mixture], shares: Sequence[float]) -> Mixture:
    """Add mixtures up, each with its share of the whole."""
    total = float(sum(shares))
    weights = np.concatenate([m.weights * (share / total) for m, share in zip(mixtures, shares, strict=True)])
    means = np.concatenate([m.means for m in mixtures])
    return Mixture(weights, means, np.concatenate([m.covariances for m in mixtures]))


def log_components(mixture: Mixture, colours: Floats) -> Floats:
    """Logarithm of each weighted component's density (n, k) at colours (n, 3)."""
    columns = []
    for weight, mean, covariance in zip(mixture.weights, mixture.means, mixture.covariances, strict=True):
        factor = np.linalg.cholesky(covariance)
        white = (colours - mean) @ np.linalg.inv(factor).T
        constant = np.log(max(weight, 1e-12)) - np.log(np.diag(factor)).sum() - 1.5 * np.log(2 * np.pi)
        columns.append(constant - 0.5 * (white[:, 0] ** 2 + white[:, 1] ** 2 + white[:, 2] ** 2))
    return np.stack(columns, axis=1)


def log_density(mixture: Mixture, colours: Floats) -> Floats:
    """Logarithm of the mixture's density (n,) at colours (n, 3)."""
    parts = log_components(mixture, colours)
    peak = parts.max(axis=1)
    return np.asarray(peak + np.log(np.exp(parts - peak[:, None]).sum(axis=1)))


def distance(mixture: Mixture, colour: Floats) -> float:
    """Mahalanobis distance of a colour (3,) from the mixture's nearest component."""
    away = colour - mixture.means
    return float(np.sqrt(np.einsum("ki,kij,kj->k", away, np.linalg.inv(mixture.covariances), away).min()))


def table_colours() -> Floats:
    """Give the colours (32768, 3) at the centres of the look-up table's cells."""
    steps = (np.arange(2**TABLE_BITS) + 0.5) * 2 ** (8 - TABLE_BITS)
    return np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)


def table_index(colours: NDArray[np.uint8]) -> NDArray[np.int32]:
    """Give each pixel's cell (...,) in the look-up table, for colours (..., 3)."""
    cell = (colours >> (8 - TABLE_BITS)).astype(np.int32)
    return (cell[..., 0] << (2 * TABLE_BITS)) | (cell[..., 1] << TABLE_BITS) | cell[..., 2]
