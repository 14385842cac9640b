"""The thickness of a branch, measured where the photo shows it."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import normals
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.types import Floats


def half_widths(line_px: Floats, wood: NDArray[np.bool_], most_px: float) -> tuple[Floats, Floats]:
    """Measure the half-width and the middle of the wood, a mask (h, w), across a line (n, 2), px.

    Across the line, the run of wood pixels that contains the line is followed to both sides (gaps of one pixel are
    ignored); a run longer than ``most_px`` on either side is not a branch but dark leaves beside it.

    Source: Tan et al. 2008, section 2, which takes the largest circle of branch pixels at the root only.

    Returns
    -------
    Half-widths (n,), px, and signed offsets (n,), px, from the line to the run's middle along the line's normals;
    both NaN where no branch is seen.
    """
    reach = max(2, int(np.ceil(most_px)))
    offsets = np.arange(-reach, reach + 1)
    across = sample_nearest(wood, line_px[:, None] + offsets[:, None] * normals(line_px)[:, None], False)
    left, right = _run(across[:, reach::-1]), _run(across[:, reach:])
    # Both runs count the pixel under the line.
    seen = (left + right > 0) & (left < reach) & (right < reach)
    halves, middles = (left + right - 1) / 2.0, (right - left) / 2.0
    return _steady(np.where(seen, halves, np.nan)), _steady(np.where(seen, middles, np.nan))


def non_increasing(values: Floats) -> Floats:
    """Return the non-increasing values (n,), px, nearest to the given ones (n,) in the sum of squares.

    By the min-max formula of isotonic regression (Robertson, Wright and Dykstra 1988, section 1.4), which suffices for
    the few values along a stroke: importing scipy's would take longer than all tracing.
    """
    count = np.arange(len(values))
    sums = np.concatenate([[0.0], np.cumsum(values)])
    means = (sums[None, 1:] - sums[:-1, None]) / np.maximum(count[None] - count[:, None] + 1, 1)
    means[count[:, None] > count[None]] = -np.inf
    onward = np.maximum.accumulate(means[:, ::-1], axis=1)[:, ::-1]
    return np.asarray(np.minimum.accumulate(onward, axis=0).diagonal())


def _run(seen: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the length (n,), px, of the run of wood that starts in the first column, ignoring one-pixel gaps."""
    closed = seen | np.roll(seen, -1, axis=1) | (np.arange(seen.shape[1]) == 0)
    closed[:, -1] = seen[:, -1]
    length = np.where(closed.all(axis=1), seen.shape[1], closed.argmin(axis=1))
    return np.where(seen[:, :2].any(axis=1), length, 0).astype(np.int64)


def _steady(widths: Floats) -> Floats:
    """Return the moving median (n,) of measurements (n,); NaN where over half of those around are NaN."""
    window = min((len(widths) - 1) | 1, 9)
    seen = ~np.isnan(widths)
    if not seen.any():
        return widths
    filled = np.interp(np.arange(len(widths)), np.flatnonzero(seen), widths[seen])
    share = np.convolve(seen.astype(float), np.ones(window) / window, mode="same")
    around = np.pad(filled, window // 2, mode="edge")
    return np.where(share >= 0.5, np.median(sliding_window_view(around, window), axis=1), np.nan)
