"""Gaussian mixtures over colours (docs/decisions/0005 says why they are our own)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats

TABLE_BITS = 5
"""Bits of a channel in the look-up table of colours: 32,768 densities replace those of millions of pixels."""
FLOOR = 4.0
"""Added to every variance, squared steps of 255: no component is narrower than the camera's noise."""
MOST_ROUNDS = 60
"""Greatest number of rounds of a fit."""
ENOUGH = 3e-3
"""A fit ends when a round increases the mean log likelihood by less."""
MIDDLE = 127.5
"""Subtracted from channels before they are squared, so that no digits are lost: the middle of their range."""
RARE = 0.75
"""Power of a group's size by which its squared spread is divided: at 0 common colours are split first, at 1 rare ones.
"""
_ROWS, _COLUMNS = np.triu_indices(3)

Start = Callable[[Floats, int], Floats]
"""Divides samples (n, 3) into k groups, from which a fit starts: shares (n, k), 0 or 1."""


@dataclass(frozen=True, eq=False)
class Mixture:
    """A mixture of k Gaussians over sRGB colours, 0 to 255.

    Attributes
    ----------
    weights
        (k,) not negative, summing to 1.
    means
        (k, 3) sRGB, 0 to 255.
    covariances
        (k, 3, 3) positive definite.
    """

    weights: Floats
    means: Floats
    covariances: Floats

    def __len__(self) -> int:
        return len(self.weights)

    def select(self, kept: NDArray[np.bool_]) -> "Mixture":
        """Keep some components, a mask (k,) with at least one, and scale their weights to sum to 1 again."""
        weights = self.weights[kept]
        return Mixture(weights / weights.sum(), self.means[kept], self.covariances[kept])


def far_apart(samples: Floats, count: int) -> Floats:
    """Assign each sample (n, 3) to the nearest of k samples drawn far from each other: shares (n, k), 0 or 1.

    The draw is seeded. Rare colours get components of their own, as a limb's among leaves must.

    Source: k-means++, Arthur and Vassilvitskii 2007.
    """
    rng = np.random.default_rng(0)
    chosen = int(rng.integers(len(samples)))
    nearest = ((samples - samples[chosen]) ** 2).sum(axis=1)
    seeds = np.zeros(len(samples), dtype=np.int64)
    for seed in range(1, count):
        up_to = np.cumsum(nearest)
        chosen = int(np.searchsorted(up_to, rng.uniform(0, up_to[-1]), side="right"))
        away = ((samples - samples[chosen]) ** 2).sum(axis=1)
        seeds[away < nearest] = seed
        nearest = np.minimum(nearest, away)
    return np.asarray(np.eye(count)[seeds])


def by_splitting(samples: Floats, count: int) -> Floats:
    """Split the group that is most spread out across its longest axis at its mean, until there are k groups.

    Returns shares (n, k), 0 or 1. Nothing is drawn, so that nearly equal colours, of the same photo at another size or
    with a camera's noise, are divided nearly alike.

    Source: Orchard and Bouman 1991, "Color quantization of images", section III; we weigh a group's size by
    `RARE`.
    """
    groups, axes = [np.arange(len(samples))], [_longest_axis(samples)]
    for _ in range(1, count):
        widest = max(range(len(groups)), key=lambda group: axes[group][0])
        members, (_, middle, axis) = groups[widest], axes[widest]
        ahead = (samples[members] - middle) @ axis > 0
        groups[widest : widest + 1] = [members[~ahead], members[ahead]]
        axes[widest : widest + 1] = [_longest_axis(samples[part]) for part in groups[widest : widest + 2]]
    share = np.zeros((len(samples), count))
    for group, members in enumerate(groups):
        share[members, group] = 1.0
    return share


def _longest_axis(samples: Floats) -> tuple[float, Floats, Floats]:
    """Return how far samples (n, 3) are spread along their longest axis, their mean (3,) and that axis (3,)."""
    middle = samples.mean(axis=0)
    squares, axes = np.linalg.eigh((samples - middle).T @ (samples - middle))
    return float(squares[-1]) / len(samples) ** RARE, middle, axes[:, -1]


def fit_mixture(colours: NDArray[np.uint8], components: int, start: Start = far_apart) -> Mixture:
    """Fit a mixture to colours (n, 3), sRGB, 0 to 255, by expectation maximisation.

    Fewer than twice as many distinct colours as components give fewer components. Equal colours give an equal mixture.

    Source: Dempster, Laird and Rubin 1977.
    """
    samples = colours.reshape(-1, 3).astype(np.float64)
    distinct = len(np.unique(samples @ (1.0, 256.0, 65536.0)))
    if distinct < 2 * components:
        components = max(1, distinct // 2)
    terms = _terms(samples)
    share, before = start(samples, components), -np.inf
    for _ in range(MOST_ROUNDS):
        mixture = _most_likely(share, terms)
        parts = _log_components(mixture, terms)
        total = log_sum(parts)
        likelihood = float(total.mean())
        if likelihood - before < ENOUGH:
            break
        share, before = np.exp(parts - total[:, None]), likelihood
    return mixture


def _most_likely(share: Floats, terms: Floats) -> Mixture:
    """Return the most likely mixture, given the shares (n, k) of samples in its components and their terms (10, n)."""
    count = share.sum(axis=0) + 1e-9
    moments = (terms @ share).T / count[:, None]
    means = moments[:, 1:4]
    squares = np.empty((len(count), 3, 3))
    squares[:, _ROWS, _COLUMNS] = squares[:, _COLUMNS, _ROWS] = moments[:, 4:]
    covariances = squares - means[:, :, None] * means[:, None, :] + FLOOR * np.eye(3)
    return Mixture(count / count.sum(), means + MIDDLE, covariances)


def join_mixtures(mixtures: Sequence[Mixture], shares: Sequence[float]) -> Mixture:
    """Combine mixtures, each weighted by its share of the whole."""
    total = float(sum(shares))
    weights = np.concatenate([m.weights * (share / total) for m, share in zip(mixtures, shares, strict=True)])
    means = np.concatenate([m.means for m in mixtures])
    return Mixture(weights, means, np.concatenate([m.covariances for m in mixtures]))


def log_components(mixture: Mixture, colours: Floats) -> Floats:
    """Logarithm (n, k) of each weighted component's density at colours (n, 3), sRGB, 0 to 255."""
    return _log_components(mixture, _terms(colours))


def _log_components(mixture: Mixture, terms: Floats) -> Floats:
    """Logarithm (n, k) of each weighted component's density at colours of these terms (10, n)."""
    means, inverse = mixture.means - MIDDLE, np.linalg.inv(mixture.covariances)
    twisted = np.einsum("kij,kj->ki", inverse, means)
    constant = np.log(np.maximum(mixture.weights, 1e-12)) - 0.5 * np.linalg.slogdet(mixture.covariances)[1]
    constant -= 1.5 * np.log(2 * np.pi) + 0.5 * np.einsum("ki,ki->k", twisted, means)
    twice = np.where(_ROWS == _COLUMNS, -0.5, -1.0)
    form = np.column_stack([constant, twisted, twice * inverse[:, _ROWS, _COLUMNS]])
    return np.asarray((form @ terms).T)


def _terms(colours: Floats) -> Floats:
    """Terms (10, n) of a quadratic in colours (n, 3): one, the three channels, their six products."""
    about = colours.T - MIDDLE
    return np.concatenate([np.ones((1, about.shape[1])), about, about[_ROWS] * about[_COLUMNS]])


def component_shares(mixture: Mixture, colours: Floats) -> Floats:
    """Share (n, k) of each colour (n, 3), sRGB, 0 to 255, that each component explains; a colour's shares sum to 1.

    Source: the expectation step of Dempster, Laird and Rubin 1977.
    """
    parts = log_components(mixture, colours)
    return np.asarray(np.exp(parts - log_sum(parts)[:, None]))


def log_density(mixture: Mixture, colours: Floats) -> Floats:
    """Logarithm (n,) of the mixture's density at colours (n, 3), sRGB, 0 to 255."""
    return log_sum(log_components(mixture, colours))


def log_sum(parts: Floats) -> Floats:
    """Logarithm (n,) of the sum of the exponentials of each row (n, k) of dimensionless logarithms.

    It equals scipy.special.logsumexp, whose import takes longer than all uses of this.
    """
    peak = parts.max(axis=1)
    return np.asarray(peak + np.log(np.exp(parts - peak[:, None]).sum(axis=1)))


def distance(mixture: Mixture, colour: Floats) -> float:
    """Mahalanobis distance, dimensionless, of a colour (3,), sRGB, 0 to 255, from the mixture's nearest component.

    Source: Mahalanobis 1936.
    """
    away = colour - mixture.means
    return float(np.sqrt(np.einsum("ki,kij,kj->k", away, np.linalg.inv(mixture.covariances), away).min()))


def table_colours() -> Floats:
    """Return the colours (32768, 3), sRGB, 0 to 255, at the centres of the look-up table's cells."""
    steps = (np.arange(2**TABLE_BITS) + 0.5) * 2 ** (8 - TABLE_BITS)
    return np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)


def table_index(colours: NDArray[np.uint8]) -> NDArray[np.uint16]:
    """Return the index (...,) in the look-up table of each colour (..., 3), sRGB."""
    index = np.zeros(colours.shape[:-1], dtype=np.uint16)
    for plane in cv2.split(colours.reshape(-1, 1, 3)):
        index <<= TABLE_BITS
        index |= np.asarray(plane, dtype=np.uint8).reshape(index.shape) >> (8 - TABLE_BITS)
    return index
