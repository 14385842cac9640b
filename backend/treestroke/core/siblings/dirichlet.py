"""Dirichlet distributions of shares that add up to one, fitted by maximum likelihood (Minka 2003)."""

from dataclasses import dataclass

import numpy as np
from scipy.special import digamma, polygamma

from treestroke.core.types import Floats

LEAST_SHARE = 1e-3
"""Smaller shares count as this: the likelihood of a share of nothing has no bounds."""
ROUNDS, CLOSE = 200, 1e-9
"""Most rounds of Newton's method, and relative change that ends them."""
PRIOR = 3.0
"""How many samples the guess weighs beside those that are fitted: a few that happen to be alike would fit a
distribution without any spread."""
GUESSED_PRECISION = 12.0
"""Precision of the guess, whose mean is that of the samples: shares of a third scatter by 0.13."""


@dataclass(frozen=True, eq=False)
class Dirichlet:
    """A Dirichlet distribution.

    Attributes
    ----------
    concentration
        (k,) its parameters (paper: beta), all positive; their sum is the precision.
    """

    concentration: Floats

    @property
    def precision(self) -> float:
        """How close samples are to the mean."""
        return float(self.concentration.sum())

    @property
    def mean(self) -> Floats:
        """(k,) the mean shares."""
        return np.asarray(self.concentration / self.precision)

    def sample(self, count: int, rng: np.random.Generator) -> Floats:
        """Draw shares (count, k)."""
        return rng.dirichlet(self.concentration, count)


def fit_dirichlet(shares: Floats) -> Dirichlet:
    """Fit a Dirichlet distribution to shares (n, k), each row adding up to 1, by the greatest posterior.

    Few samples are joined by a guess of their own mean and a medium spread, worth `PRIOR` samples.

    Source: Minka 2003, Newton's method for the likelihood (section 1, equations 9 to 18), with steps in the logarithm
    where a step would leave the positive numbers.

    Raises
    ------
    ValueError
        There is no sample.
    """
    if len(shares) == 0:
        raise ValueError("a distribution is fitted to one sample or more")
    shares = np.maximum(shares, LEAST_SHARE)
    shares = shares / shares.sum(axis=1, keepdims=True)
    mean, count = shares.mean(axis=0), len(shares) + PRIOR
    guess = digamma(GUESSED_PRECISION * mean) - digamma(GUESSED_PRECISION)
    seen = (np.log(shares).sum(axis=0) + PRIOR * guess) / count
    found = GUESSED_PRECISION * mean
    for _ in range(ROUNDS):
        step = _newton_step(found, seen)
        after = np.where(found - step > 0, found - step, found / 2)
        done = np.abs(after - found).max() <= CLOSE * found.max()
        found = after
        if done:
            break
    return Dirichlet(found)


def _newton_step(found: Floats, seen: Floats) -> Floats:
    """Return Newton's step (k,) from a concentration (k,) for the samples' mean logarithms (k,).

    The Hessian is a diagonal and a constant, so that its inverse needs no matrix (Minka 2003, equations 13 to 18).
    """
    gradient = digamma(found.sum()) - digamma(found) + seen
    diagonal = -polygamma(1, found)
    constant = float(polygamma(1, found.sum()))
    shift = (gradient / diagonal).sum() / (1 / constant + (1 / diagonal).sum())
    return np.asarray((gradient - shift) / diagonal)
