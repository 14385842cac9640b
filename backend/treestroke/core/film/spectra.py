"""How branches swing: frequency and damping by the spectrum of their turns."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.types import Floats

SLOWEST_HZ, FASTEST_HZ = 0.2, 8.0
_PADDED = 8  # times the length of the series
_FEWEST_SWINGS = 2.0  # swings within the video from which a frequency is trusted
_CLEAR = 12.0  # peak over the median of the spectrum, at which a frequency is as sure as can be


@dataclass(frozen=True, eq=False)
class Swings:
    """How n series swing.

    Attributes
    ----------
    frequency_hz
        (n,) of the highest peak.
    damping
        (n,) share of the critical damping, by the peak's width at half its power; NaN where the video is too short to
        tell it from the spread that its length alone gives.
    sureness
        (n,) 0 to 1: by how far the peak stands out, and how many swings the video holds.
    """

    frequency_hz: Floats
    damping: Floats
    sureness: Floats


def swings(series: Floats, frames_per_second: float) -> Swings:
    """Measure the swings of series (f, n), of any unit, at even times."""
    count = len(series)
    time = np.linspace(-1.0, 1.0, count)[:, None]
    level = series - series.mean(axis=0)
    level = level - time * (time * level).sum(axis=0) / (time**2).sum()
    power = np.abs(np.fft.rfft(level * np.hanning(count)[:, None], _PADDED * count, axis=0)) ** 2
    hertz = np.fft.rfftfreq(_PADDED * count, 1.0 / frames_per_second)
    band = (hertz >= SLOWEST_HZ) & (hertz <= min(FASTEST_HZ, 0.5 * frames_per_second))
    power, hertz = power[band], hertz[band]
    peak = power.argmax(axis=0)
    found = hertz[peak]
    highest = power[peak, np.arange(power.shape[1])]
    stands_out = highest / np.maximum(np.median(power, axis=0), 1e-30)
    seconds = count / frames_per_second
    often = np.clip(found * seconds / _FEWEST_SWINGS - 1.0, 0.0, 1.0)
    clear = np.clip(np.log(np.maximum(stands_out, 1.0)) / np.log(_CLEAR**2), 0.0, 1.0)
    sure = np.where(highest > 0, often * clear, 0.0)
    return Swings(found, _damping(power, np.asarray(hertz, dtype=np.float64), peak, seconds), sure)


def _damping(power: Floats, hertz: Floats, peak: np.ndarray, seconds: float) -> Floats:
    """Return half the width at half the power over the frequency, without what a Hann window of this length adds."""
    spread = 1.44 / seconds
    out = np.full(power.shape[1], np.nan)
    for index, at in enumerate(peak.tolist()):
        below = np.flatnonzero(power[:, index] < 0.5 * power[at, index])
        left, right = below[below < at], below[below > at]
        if not len(left) or not len(right):
            continue
        width = float(hertz[right[0]] - hertz[left[-1]])
        if width > 1.2 * spread:
            out[index] = float(np.sqrt(width**2 - spread**2)) / (2.0 * hertz[at])
    return out
