"""The circle tracer: it finds branches that leave the traced ones, also where no stroke was drawn.

Source: Tan et al. 2008, section 2, "Visible branch tracing", and its figure 3. We add two tests that dark gaps
between leaves fail: a branch is a ribbon, with no other wood on either side, and no thicker than its parent.
"""

from collections import deque
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from treestroke.core.geometry.polyline import resample
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.trace.skeleton_builder import SkeletonBuilder
from treestroke.core.trace.thickness import half_widths
from treestroke.core.types import Floats, Mask

SOLID_SHARE = 0.92
"""Least share of branch pixels on the way to an arc's centre; the paper asks for all, but a JPEG has specks."""
RIBBON_SHARE = 0.7
"""Least share of that way where both sides of the branch are seen."""
APART = 0.5
"""Distance from everything traced, in radii of the circle, at which an arc leads to something new."""
MAX_STEPS = 400
"""Greatest number of positions of the circle."""


@dataclass(frozen=True, eq=False)
class Circle:
    """The moving circle: its radius, px, and the mask (h, w) of pixels that look like wood."""

    radius_px: float
    wood: Mask

    @cached_property
    def rim(self) -> Floats:
        """Points (n, 2), px, one pixel apart on the circle about the origin."""
        count = max(16, int(2 * np.pi * self.radius_px))
        return _on_circle(np.linspace(0.0, 2 * np.pi, count, endpoint=False), self.radius_px)

    def arcs(self, centre: Floats) -> Floats:
        """Return the middles (k, 2), px, of the runs of wood on the circle about ``centre`` (2,), px."""
        seen = sample_nearest(self.wood, centre + self.rim, False)
        if seen.all() or not seen.any():
            return np.empty((0, 2))
        first = int(np.flatnonzero(~seen)[0])
        edges = np.diff(np.concatenate([[0], np.roll(seen, -first).astype(np.int8), [0]]))
        middle = (np.flatnonzero(edges == 1) + np.flatnonzero(edges == -1) - 1) / 2 + first
        return centre + _on_circle(middle * (2 * np.pi / len(seen)), self.radius_px)


def _on_circle(angle: Floats, radius_px: float) -> Floats:
    """Return the points (n, 2), px, at angles (n,), radians, on a circle about the origin."""
    return radius_px * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def trace_forks(builder: SkeletonBuilder, circle: Circle, seeds: list[int]) -> None:
    """Move the circle along the seeds (joint indices) and on along every branch that it finds, breadth first.

    Source: Tan et al. 2008, section 2, "Visible branch tracing".
    """
    queue = deque(seeds)
    for _ in range(MAX_STEPS):
        if not queue:
            return
        joint = queue.popleft()
        arcs = circle.arcs(builder.points[joint])
        ends = arcs[_are_new(arcs, builder, circle.radius_px)]
        if len(ends) == 0:
            continue
        for line in _solid_lines(builder.points[joint], ends, builder.radii[joint], circle):
            half_width = _half_width(line, builder.radii[joint], circle)
            if half_width > 0:
                queue.append(builder.add_chain(joint, resample(line, circle.radius_px / 4), half_width, stroke=-1))


def _solid_lines(centre: Floats, ends: Floats, parent_px: float, circle: Circle) -> Floats:
    """Return the straight lines (m, n, 2), in steps of about 1 px, from a centre to ends (k, 2) that run on wood."""
    steps = np.linspace(0.0, 1.0, max(4, round(circle.radius_px)) + 1)[:, None]
    lines = centre + steps * (ends[:, None] - centre)
    outside = lines[:, min(int(parent_px) + 1, len(steps) - 4) :]
    return np.asarray(lines[sample_nearest(circle.wood, outside, False).mean(axis=1) >= SOLID_SHARE])


def _half_width(line: Floats, parent_px: float, circle: Circle) -> float:
    """Return the half-width, px, of the branch that a line (n, 2) follows out of its parent; 0 without a branch."""
    outer = line[max(len(line) // 2, int(parent_px)) :]
    if len(outer) < 4:
        return 0.0
    widths, _ = half_widths(outer, circle.wood, 1.2 * parent_px + 1.0)
    seen = ~np.isnan(widths)
    return float(np.median(widths[seen])) if seen.mean() >= RIBBON_SHARE else 0.0


def _are_new(ends: Floats, builder: SkeletonBuilder, radius_px: float) -> Mask:
    """Return a mask (k,) of the arcs' middles (k, 2) that lie apart from everything traced so far."""
    points, radii = builder.arrays()
    away = np.hypot(ends[:, :1] - points[:, 0], ends[:, 1:] - points[:, 1])
    return np.asarray((away > np.maximum(APART * radius_px, 1.5 * radii)).all(axis=1))
