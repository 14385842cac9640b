"""The circle tracer: find branches that leave what is already traced, also where no stroke was drawn.

Source: Tan et al. 2008, section 2, "Visible branch tracing", and its figure 3. We add two tests that dark gaps
between leaves fail: a branch is a ribbon (clear of other wood on both sides) no thicker than what bears it.
"""

from collections import deque
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import resample
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.trace.draft import Draft
from treestroke.core.trace.thickness import half_widths
from treestroke.core.types import Floats

SOLID_SHARE = 0.92
"""Share of branch pixels on the way to an arc's centre; the paper asks for all, a JPEG has specks."""
RIBBON_SHARE = 0.7
"""Share of that way where both sides of the branch are seen."""
APART = 0.5
"""Distance from everything traced, in radii of the circle, at which an arc leads to something new."""
MOST_STEPS = 400


@dataclass(frozen=True, eq=False)
class Circle:
    """The circle that moves: its radius, px, and the wood (h, w) that it looks at."""

    radius_px: float
    wood: NDArray[np.bool_]

    @cached_property
    def rim(self) -> Floats:
        """Points (n, 2), px, a pixel apart on the circle about the origin."""
        count = max(16, int(2 * np.pi * self.radius_px))
        return _on_circle(np.linspace(0.0, 2 * np.pi, count, endpoint=False), self.radius_px)

    def arcs(self, centre: Floats) -> Floats:
        """Middles (k, 2), px, of the runs of wood on the circle about ``centre``."""
        seen = sample_nearest(self.wood, centre + self.rim, False)
        if seen.all() or not seen.any():
            return np.empty((0, 2))
        first = int(np.flatnonzero(~seen)[0])
        edges = np.diff(np.concatenate([[0], np.roll(seen, -first).astype(np.int8), [0]]))
        middle = (np.flatnonzero(edges == 1) + np.flatnonzero(edges == -1) - 1) / 2 + first
        return centre + _on_circle(middle * (2 * np.pi / len(seen)), self.radius_px)


def _on_circle(angle: Floats, radius_px: float) -> Floats:
    """Points (n, 2), px, at angles (n,), radians, on a circle about the origin."""
    return radius_px * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def trace_forks(draft: Draft, circle: Circle, seeds: list[int]) -> None:
    """Move the circle along the seeds (joints of the draft) and on along every branch that it finds, breadth first."""
    queue = deque(seeds)
    for _ in range(MOST_STEPS):
        if not queue:
            return
        joint = queue.popleft()
        arcs = circle.arcs(draft.points[joint])
        ends = arcs[_are_new(arcs, draft, circle.radius_px)]
        if len(ends) == 0:
            continue
        for way in _solid_ways(draft.points[joint], ends, draft.radii[joint], circle):
            breadth = _breadth(way, draft.radii[joint], circle)
            if breadth > 0:
                queue.append(draft.grow(joint, resample(way, circle.radius_px / 4), breadth, stroke=-1))


def _solid_ways(centre: Floats, ends: Floats, bearer_px: float, circle: Circle) -> Floats:
    """Walk straight from a centre to ends (k, 2) on the circle, in steps of about 1 px; keep ways (m, n, 2) of wood."""
    steps = np.linspace(0.0, 1.0, max(4, round(circle.radius_px)) + 1)[:, None]
    ways = centre + steps * (ends[:, None] - centre)
    free = ways[:, min(int(bearer_px) + 1, len(steps) - 4) :]
    return np.asarray(ways[sample_nearest(circle.wood, free, False).mean(axis=1) >= SOLID_SHARE])


def _breadth(way: Floats, bearer_px: float, circle: Circle) -> float:
    """Half-width, px, of the branch that the way (n, 2) follows out of its bearer; 0 where it follows none."""
    outer = way[max(len(way) // 2, int(bearer_px)) :]
    if len(outer) < 4:
        return 0.0
    widths, _ = half_widths(outer, circle.wood, 1.2 * bearer_px + 1.0)
    seen = ~np.isnan(widths)
    return float(np.median(widths[seen])) if seen.mean() >= RIBBON_SHARE else 0.0


def _are_new(ends: Floats, draft: Draft, radius_px: float) -> NDArray[np.bool_]:
    """Tell which arcs' middles (k, 2) lie apart from everything traced so far."""
    points, radii = draft.table()
    away = np.hypot(ends[:, :1] - points[:, 0], ends[:, 1:] - points[:, 1])
    return np.asarray((away > np.maximum(APART * radius_px, 1.5 * radii)).all(axis=1))
