"""Two climbers at equal height: how far along one chain to be while another is walked.

Points of equal height pair up (paper, section 5.1, rule 1). Drawn branches rise and droop and wiggle, so the partner of
a point is not known from its height alone: among all ways of walking both chains the one is taken that keeps the
heights together and turns back least, by dynamic programming over (place on the one, place on the other).
"""

import numpy as np

from treestroke.core.geometry.polyline import Floats, Indices

NEAR = 3.0
"""Units of height that two climbers may be apart almost for free."""
WORST = 3.0
"""What a unit walked apart costs at most, in terms of NEAR apart: beyond it is wrong anyhow."""
ONWARD, BACKWARD = 0.02, 0.25
"""Cost of each unit that the follower walks: it turns back only where that keeps the heights."""
UNEVEN = 0.3
"""Cost of a unit walked while one has its whole way before it and the other behind it: level chains go side by side."""


def climb(lead: Floats, follow: Floats, start: int) -> Indices:
    """Walk a chain and tell where another climber is meanwhile.

    Parameters
    ----------
    lead, follow
        (n, 2), (m, 2) height and length walked up to each point.
    start
        The follower's point where it begins; the leader begins at its first.

    Returns
    -------
    (n,) the follower's point at each of the leader's.
    """
    cost = _cost(lead, follow)
    steps, edges = np.diff(lead[:, 1], prepend=lead[0, 1]), np.diff(follow[:, 1])
    between = 0.5 * (cost[:, 1:] + cost[:, :-1])
    onward, backward = (
        np.concatenate([np.zeros((len(lead), 1)), np.cumsum((between + price) * edges, axis=1)], axis=1)
        for price in (ONWARD, BACKWARD)
    )
    arrived = cost * steps[:, None]
    ahead, back = onward[0] - onward[0, start], backward[0, start] - backward[0]
    total = np.where(np.arange(len(follow)) < start, back, ahead)
    for row in range(1, len(lead)):
        arrived[row] += total
        ahead = np.minimum.accumulate(arrived[row] - onward[row]) + onward[row]
        back = np.minimum.accumulate((arrived[row] + backward[row])[::-1])[::-1] - backward[row]
        total = np.minimum(ahead, back)
    return _trace_back(start, int(total.argmin()), arrived, onward, backward)


def _cost(lead: Floats, follow: Floats) -> Floats:
    """Price a unit walked at each pair of places (n, m)."""
    apart = (lead[:, None, 0] - follow[None, :, 0]) / NEAR
    shares = [each[:, 1] / max(float(each[-1, 1]), 1e-9) for each in (lead, follow)]
    uneven = shares[0][:, None] - shares[1][None, :]
    return np.asarray(np.minimum(apart * apart, WORST) + UNEVEN * uneven * uneven)


def _trace_back(start: int, end: int, arrived: Floats, onward: Floats, backward: Floats) -> Indices:
    """Find the places (n,) of the cheapest walk from a place to a place."""
    places = np.full(len(arrived), start, dtype=np.int64)
    for row in range(len(arrived) - 1, 0, -1):
        places[row] = end
        reach = np.empty(arrived.shape[1])
        reach[: end + 1] = arrived[row, : end + 1] + (onward[row, end] - onward[row, : end + 1])
        reach[end + 1 :] = arrived[row, end + 1 :] + (backward[row, end + 1 :] - backward[row, end])
        end = int(reach.argmin())
    return places
