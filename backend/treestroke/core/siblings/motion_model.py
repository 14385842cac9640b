"""How a filmed tree's branches turn, learnt so that a sibling's turn alike: not the same, but of the same kind.

Source: Li et al. 2011, sections 5.1 and 5.2: for each axis the real and the imaginary parts of the lowest frequencies,
shifted to be positive and scaled to add up to 1, are samples of a Dirichlet distribution. The paper draws each branch
alone; here what all branches do together, the gusts, is taken out before, and each sibling's branch takes its part of
it: a tree of branches that swing each for themselves looks nervous (docs/decisions/0019).
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.siblings.dirichlet import Dirichlet, fit_dirichlet
from treestroke.core.types import Floats, Indices

LOWEST = 0.2
"""Share of the frequencies, from the lowest, that are kept (Li et al.: "the first 20 % or so")."""
_THINNEST = 0.02  # share of the greatest thickness: thinner branches turn no more


@dataclass(frozen=True, eq=False)
class Turns:
    """How the branches of a tree turn, as a model sees them; f frames, m branches.

    Attributes
    ----------
    along
        (m, 3) direction of each branch at rest, unit length.
    axes
        (m, 2, 3) the two axes about which each turns, unit length.
    thickness
        (m,) radius over the tree's greatest.
    """

    along: Floats
    axes: Floats
    thickness: Floats


@dataclass(frozen=True, eq=False)
class _Spectra:
    """The real or the imaginary parts of one axis' spectra, as shares.

    ``shares`` is their distribution; ``least`` and ``total`` (m,) are what was taken off each example's and what the
    rest was divided by.
    """

    shares: Dirichlet
    least: Floats
    total: Floats


@dataclass(frozen=True, eq=False)
class MotionModel:
    """What was learnt of how a tree's branches turn.

    Attributes
    ----------
    frames
        Length of the series.
    gusts
        (f,) what all branches do together, of standard deviation 1.
    push
        (3,) the direction of the gusts, its length the turn of the thickest branch, radians.
    softer
        Exponent by which thinner branches turn more.
    thickness
        (m,) of the example's branches.
    """

    frames: int
    gusts: Floats
    push: Floats
    softer: float
    thickness: Floats
    _spectra: tuple[tuple[_Spectra, _Spectra], ...]

    def draw(self, branches: Turns, rng: np.random.Generator) -> Floats:
        """Draw turns (f, m, 3), radians, for branches; the series is one period, so that it loops.

        Each takes its size from an example's branch that is about as thick.
        """
        like = self._like(branches.thickness, rng)
        start = int(rng.integers(self.frames))
        strength = np.maximum(branches.thickness, _THINNEST) ** -self.softer
        lean = np.cross(branches.along, self.push) * strength[:, None]
        turns = np.roll(self.gusts, start)[:, None, None] * lean
        for axis, (real, imaginary) in enumerate(self._spectra):
            parts = [_drawn(spectra, like, rng) for spectra in (real, imaginary)]
            spectrum = np.zeros((self.frames // 2 + 1, len(like)), dtype=np.complex128)
            spectrum[1 : parts[0].shape[1] + 1] = (parts[0] + 1j * parts[1]).T
            series = np.fft.irfft(spectrum, self.frames, axis=0)
            turns = turns + series[:, :, None] * branches.axes[:, axis]
        return np.asarray(turns)

    def _like(self, thickness: Floats, rng: np.random.Generator) -> Indices:
        """Choose for each branch an example's branch (m,) among the few that are nearest in thickness."""
        order = np.argsort(self.thickness, kind="stable")
        at = np.searchsorted(self.thickness[order], thickness) + rng.integers(-2, 3, len(thickness))
        return np.asarray(order[np.clip(at, 0, len(order) - 1)])


def learn_motion(turns: Floats, branches: Turns) -> MotionModel:
    """Learn how branches turn, from their turns (f, m, 3), radians, at even times.

    Raises
    ------
    ValueError
        There is no branch, or fewer than 10 frames.
    """
    if turns.shape[1] == 0 or len(turns) < 10:
        raise ValueError("motion is learnt of branches that turn in 10 frames or more")
    turns = turns - turns.mean(axis=0)
    thin = np.maximum(branches.thickness, _THINNEST)
    gusts, push, softer = _together(turns, branches.along, thin)
    common = gusts[:, None, None] * (np.cross(branches.along, push) * (thin**-softer)[:, None])
    count = max(2, int(LOWEST * (len(turns) // 2)))
    own = np.einsum("fmx,max->fma", turns - common, branches.axes)
    spectrum = np.fft.rfft(own, axis=0)[1 : count + 1]
    spectra = tuple(
        (_as_shares(spectrum[:, :, axis].real.T), _as_shares(spectrum[:, :, axis].imag.T)) for axis in range(2)
    )
    return MotionModel(len(turns), gusts, push, softer, branches.thickness, spectra)


def _together(turns: Floats, along: Floats, thin: Floats) -> tuple[Floats, Floats, float]:
    """Return what all branches do together: its series (f,), its direction (3,), and how softer thin branches are."""
    flat = turns.reshape(len(turns), -1)
    series, _, _ = np.linalg.svd(flat, full_matrices=False)
    gusts = series[:, 0] * np.sqrt(len(turns))
    part = (flat.T @ gusts / len(turns)).reshape(-1, 3)
    turned = np.linalg.norm(part, axis=1)
    sure = turned > 1e-6
    softer = 0.0
    if np.ptp(thin[sure]) > 0:
        softer = float(np.clip(-np.polyfit(np.log(thin[sure]), np.log(turned[sure]), 1)[0], 0.0, 1.5))
    weights = thin**-softer
    # turn = weight * (along x push): linear in the push
    cross = np.stack([np.cross(along, axis) for axis in np.eye(3)], axis=2) * weights[:, None, None]
    push = np.linalg.lstsq(cross.reshape(-1, 3), part.reshape(-1), rcond=None)[0]
    return gusts, push, softer


def _as_shares(parts: Floats) -> _Spectra:
    """Shift and scale rows (m, k) so that they are positive and add up to 1, and fit their distribution."""
    least = parts.min(axis=1)
    above = parts - least[:, None]
    total = np.maximum(above.sum(axis=1), 1e-12)
    return _Spectra(fit_dirichlet(above / total[:, None]), least, total)


def _drawn(spectra: _Spectra, like: Indices, rng: np.random.Generator) -> Floats:
    """Draw rows (m, k), shifted and scaled back as the example's branches that they are like."""
    shares = spectra.shares.sample(len(like), rng)
    return np.asarray(shares * spectra.total[like][:, None] + spectra.least[like][:, None])
