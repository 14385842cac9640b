"""Outlines that a sibling is to fill: named shapes, and how a shape is fitted to a tree."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from treestroke.core.types import Floats

_POINTS = 96
FOOT = 0.05
"""Share of a shape's height, from its lowest point up, in the middle of which the trunk enters."""
LEAST_TRUNK = 0.12
"""Least height of a trunk below a shape, as a share of the tree's."""


@dataclass(frozen=True, eq=False)
class Envelope:
    """The outline that a sibling is to fill.

    Attributes
    ----------
    points
        (n, 2) a closed line in any unit, x right and y down.
    on_ground
        Whether it reaches the ground, so that no trunk shows below.
    """

    points: Floats
    on_ground: bool = False


def _regular(corners: int) -> Floats:
    turn = 2 * np.pi * np.arange(corners) / corners
    return np.stack([np.sin(turn), -np.cos(turn)], axis=1)


def _heart() -> Floats:
    turn = 2 * np.pi * np.arange(_POINTS) / _POINTS
    up = 13 * np.cos(turn) - 5 * np.cos(2 * turn) - 2 * np.cos(3 * turn) - np.cos(4 * turn)
    return np.stack([16 * np.sin(turn) ** 3, -up], axis=1)


SHAPES: Mapping[str, Floats] = MappingProxyType(
    {
        "heart": _heart(),
        "triangle": np.array([[0.0, -1.0], [0.6, 0.0], [-0.6, 0.0]]),
        "circle": _regular(_POINTS),
        "pentagon": _regular(5),
    }
)
"""Outlines by name, (n, 2), x right and y down."""


def fitted(envelope: Envelope, height: float, crown_foot: float) -> Floats:
    """Fit an outline to a tree of a ``height``: a line (n, 2), metres from the root, x right and y up.

    It reaches from the ``crown_foot``, or from the ground, to the tree's top, as wide as it then is; the trunk enters
    in the middle of its lowest part.
    """
    x, y = envelope.points.T
    foot = 0.0 if envelope.on_ground else max(crown_foot, LEAST_TRUNK * height)
    scale = (height - foot) / max(float(np.ptp(y)), 1e-9)
    lowest = _span(envelope.points, float(y.max()) - FOOT * float(np.ptp(y)))
    return np.stack([(x - lowest) * scale, foot + (y.max() - y) * scale], axis=1)


def _span(points: Floats, level: float) -> float:
    """Return the middle between the first and last place at which a closed line (n, 2) crosses a level y."""
    after = np.roll(points, -1, axis=0)
    crosses = (points[:, 1] - level) * (after[:, 1] - level) <= 0
    start, end = points[crosses], after[crosses]
    rise = np.where(end[:, 1] == start[:, 1], 1.0, end[:, 1] - start[:, 1])
    x = start[:, 0] + (level - start[:, 1]) / rise * (end[:, 0] - start[:, 0])
    return float((x.min() + x.max()) / 2)
