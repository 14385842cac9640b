"""Two climbers at equal height: how far along one chain to be while another is walked.

Points of equal height pair up (paper, section 5.1, rule 1). Drawn branches rise and droop and wiggle, so the partner of
a point is not known from its height alone: among all ways of walking both chains the one is taken that keeps the
heights together and turns back least, by dynamic programming over (place on the one, place on the other).
"""

import numpy as np

from treestroke.core.types import Floats, Indices

NEAR = 3.0
"""Units of height apart at which a unit walked costs 1; nearer it is nearly free, further it grows as the square."""
WORST = 3.0
"""What a unit walked apart costs at most: beyond it is wrong anyhow."""
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
    edges = np.diff(follow[:, 1])
    between = 0.5 * (cost[:, 1:] + cost[:, :-1])
    onward, backward = (
        np.concatenate([np.zeros((len(lead), 1)), np.cumsum((between + price) * edges, axis=1)], axis=1)
        for price in (ONWARD, BACKWARD)
    )
    # The second of each pair runs from the follower's last point to its first, as a walk backward does.
    before = np.stack([-onward, backward[:, ::-1]], axis=1)
    stepped = cost * np.diff(lead[:, 1], prepend=lead[0, 1])[:, None]
    left = np.stack([stepped, stepped[:, ::-1]], axis=1) + before
    ahead, back = onward[0] - onward[0, start], backward[0, start] - backward[0]
    total = np.where(np.arange(len(follow)) < start, back, ahead)
    both, reached = np.stack([total, total[::-1]]), np.empty((2, len(follow)))
    forth, turned, ahead, back = both[0], both[0, ::-1], reached[0], reached[1, ::-1]
    for here, short in zip(left[1:], before[1:], strict=True):
        here += both
        np.minimum.accumulate(here, axis=1, out=reached)
        reached -= short
        np.minimum(ahead, back, out=forth)
        both[1] = turned
    return _trace_back(start, int(forth.argmin()), left, before)


def _cost(lead: Floats, follow: Floats) -> Floats:
    """Price a unit walked at each pair of places (n, m)."""
    apart = (lead[:, None, 0] - follow[None, :, 0]) / NEAR
    shares = [each[:, 1] / max(float(each[-1, 1]), 1e-9) for each in (lead, follow)]
    uneven = shares[0][:, None] - shares[1][None, :]
    return np.asarray(np.minimum(apart * apart, WORST) + UNEVEN * uneven * uneven)


def _trace_back(start: int, end: int, left: Floats, before: Floats) -> Indices:
    """Find the places (n,) of the cheapest walk from a place to a place.

    ``left`` (n, 2, m) is what it costs to leave each place onward and, last place first, backward, short of what
    ``before`` (n, 2, m) says of the place that is gone to.
    """
    places = np.full(len(left), start, dtype=np.int64)
    last = left.shape[2] - 1
    for row in range(len(left) - 1, 0, -1):
        places[row] = end
        onward, backward = left[row, 0, : end + 1], left[row, 1, : last - end]
        near = int(onward.argmin())
        if end < last:
            far = int(backward.argmin())
            if backward[far] - before[row, 1, last - end] < onward[near] - before[row, 0, end]:
                near = last - far
        end = near
    return places
