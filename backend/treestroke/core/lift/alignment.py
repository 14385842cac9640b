"""Alignment of two paths by height.

Points of equal height pair up (two-sketches paper, section 5.1, rule 1). Drawn branches rise, droop and wiggle, so a
height is met never or several times. The alignment is therefore a dynamic time warping (Sakoe and Chiba 1978) whose
second path may also go back: of all ways to follow both paths the one is taken that keeps the heights together and
turns back least, by dynamic programming over (position on the leader, position on the follower).
"""

import numpy as np

from treestroke.core.types import Floats, Indices

HEIGHT_SCALE = 3.0
"""Height difference, sketch units, that costs 1 for each unit of the leader's length; it grows as the square."""
MAX_HEIGHT_COST = 3.0
"""Upper bound of the cost of a height difference, for each unit of length."""
FORWARD_COST, BACKWARD_COST = 0.02, 0.25
"""Cost of each unit of length that the follower goes forward or back: it turns back only to keep the heights."""
PROGRESS_COST = 0.3
"""Cost, for each unit of length, of the squared difference of progress (0 to 1): level paths stay side by side."""


def align_heights(leader: Floats, follower: Floats, start: int) -> Indices:
    """Find the follower's point that goes with each point of the leader, at least total cost.

    Parameters
    ----------
    leader, follower
        (n, 2), (m, 2) height and path length at each point, sketch units.
    start
        Index of the follower's first point; the leader begins at its point 0.

    Returns
    -------
    (n,) index of the follower's point at each of the leader's points.

    Source: two-sketches paper, section 5.1, rule 1; Sakoe and Chiba 1978 for the dynamic programming.
    """
    cost = _unit_costs(leader, follower)
    edges = np.diff(follower[:, 1])
    between = 0.5 * (cost[:, 1:] + cost[:, :-1])
    forward, backward = (
        np.concatenate([np.zeros((len(leader), 1)), np.cumsum((between + price) * edges, axis=1)], axis=1)
        for price in (FORWARD_COST, BACKWARD_COST)
    )
    # The second row of each pair runs from the follower's last point to its first: the direction of going back.
    before = np.stack([-forward, backward[:, ::-1]], axis=1)
    stepped = cost * np.diff(leader[:, 1], prepend=leader[0, 1])[:, None]
    leave = np.stack([stepped, stepped[:, ::-1]], axis=1) + before
    ahead, back = forward[0] - forward[0, start], backward[0, start] - backward[0]
    total = np.where(np.arange(len(follower)) < start, back, ahead)
    both, reached = np.stack([total, total[::-1]]), np.empty((2, len(follower)))
    least, reversed_least, ahead, back = both[0], both[0, ::-1], reached[0], reached[1, ::-1]
    for here, arrive in zip(leave[1:], before[1:], strict=True):
        here += both
        np.minimum.accumulate(here, axis=1, out=reached)
        reached -= arrive
        np.minimum(ahead, back, out=least)
        both[1] = reversed_least
    return _trace_back(start, int(least.argmin()), leave, before)


def _unit_costs(leader: Floats, follower: Floats) -> Floats:
    """Return the cost of a unit of length at each pair of points (n, m)."""
    apart = (leader[:, None, 0] - follower[None, :, 0]) / HEIGHT_SCALE
    progress = [path[:, 1] / max(float(path[-1, 1]), 1e-9) for path in (leader, follower)]
    uneven = progress[0][:, None] - progress[1][None, :]
    return np.asarray(np.minimum(apart * apart, MAX_HEIGHT_COST) + PROGRESS_COST * uneven * uneven)


def _trace_back(start: int, end: int, leave: Floats, before: Floats) -> Indices:
    """Return the follower's points (n,) on the cheapest alignment from index ``start`` to ``end``.

    ``leave`` (n, 2, m) is the cost to leave each point forward and, from the last point to the first, backward, less
    the part in ``before`` (n, 2, m) that depends on the point of arrival.
    """
    points = np.full(len(leave), start, dtype=np.int64)
    last = leave.shape[2] - 1
    for row in range(len(leave) - 1, 0, -1):
        points[row] = end
        forward, backward = leave[row, 0, : end + 1], leave[row, 1, : last - end]
        nearest = int(forward.argmin())
        if end < last:
            furthest = int(backward.argmin())
            if backward[furthest] - before[row, 1, last - end] < forward[nearest] - before[row, 0, end]:
                nearest = last - furthest
        end = nearest
    return points
