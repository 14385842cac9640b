"""Measures of a tree as foresters take them, each with its range and its basis."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.skeleton.measure import edge_lengths, generations
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import heaviest_children
from treestroke.core.types import Floats

BREAST_HEIGHT = 1.3
"""Metres above the root at which a trunk's diameter is taken."""
SPREAD_SHARE = 0.01
"""Share of the foliage left out on either side of a width or depth, so that single leaves do not set it."""
ENDS_PX = 3.0
"""Error of a line of known length, both ends together, px at a long side of 1500."""
RANGES = {
    "height": (0.03, 0.02),
    "crown_width": (0.12, 0.05),
    "crown_depth": (0.2, 0.35),
    "trunk_diameter": (0.15, 0.35),
    "hidden_trunk_diameter": (0.4, 0.6),
    "crown_volume": (0.35, 0.25),
    "leaf_area": (0.5, 0.5),
}
"""Shares by which a measure may be too large, and too small, if the scale is exact. They hold for 4 trees known in 3D;
for other kinds of trees they are a guess."""

Basis = Literal["given", "measured", "derived"]
"""Given by the person; seen in a picture; or following from what was grown where no picture shows it."""


@dataclass(frozen=True)
class Measure:
    """One figure; ``low`` and ``high`` bound its true value. None where it cannot be measured."""

    value: float | None
    unit: str
    low: float | None
    high: float | None
    basis: Basis
    meaning: str


@dataclass(frozen=True)
class Scale:
    """Metres per pixel of the picture, whether a line of known length sets it, and its relative error."""

    metres_per_pixel: float
    known: bool
    error: float


@dataclass(frozen=True, eq=False)
class Stature:
    """How large a tree is, and how that is known.

    Attributes
    ----------
    height
        From its root to the top of its foliage, metres.
    scale
        How metres follow from pixels.
    trunk_seen
        Whether it is seen how thick the trunk is at breast height.
    crown
        The crown's volume, as wide as it is seen.
    """

    height: float
    scale: Scale
    trunk_seen: bool
    crown: CrownVolume


@dataclass(frozen=True, eq=False)
class Measures:
    """All figures of a tree, and the number of its branches in each order: stems, what leaves them, and so on."""

    scale: Scale
    figures: Mapping[str, Measure]
    branches_by_order: tuple[int, ...]


def measure_tree(skeleton: Skeleton, stature: Stature, foliage: Floats | None, leaf_area: float) -> Measures:
    """Measure a grown tree (metres) as it was built.

    Parameters
    ----------
    skeleton
        The whole tree.
    stature
        How large it is said to be.
    foliage
        (m, 3) the middles of its leaves, metres; None on a bare tree, whose twigs then are the crown.
    leaf_area
        One side of all leaves, square metres.
    """
    crown, scale = skeleton.points if foliage is None else foliage, stature.scale
    volume = _Quantity("m³", "crown_volume", "derived", f"of the solid {stature.crown.shape}")
    figures = {
        "height": _height(stature.height, scale),
        "crown_width": _figure(_spread(crown[:, 0]), _WIDTH, scale),
        "crown_depth": _figure(_spread(crown[:, 2]), _DEPTH_SEEN if stature.crown.depth_seen else _DEPTH, scale),
        "trunk_diameter": _figure(_trunk_diameter(skeleton), _TRUNK if stature.trunk_seen else _HIDDEN_TRUNK, scale),
        "crown_volume": _figure(stature.crown.cubic_metres, volume, scale),
        "leaf_area": _figure(leaf_area, _LEAF_AREA, scale),
    }
    return Measures(scale, figures, _by_order(skeleton))


@dataclass(frozen=True)
class _Quantity:
    """What a figure is: its unit, its range among `RANGES`, what it rests on and what it means."""

    unit: str
    range: str
    basis: Basis
    meaning: str


_HEIGHT = _Quantity("m", "height", "measured", "from the root to the topmost leaf or twig")
_WIDTH = _Quantity(
    "m",
    "crown_width",
    "measured",
    "of the crown from side to side as the front shows it, without the outermost hundredth of the leaves",
)
_DEPTH = _Quantity(
    "m", "crown_depth", "derived", "of the crown along the view, which no single picture shows: as grown"
)
_DEPTH_SEEN = _Quantity(
    "m",
    "crown_width",
    "measured",
    "of the crown from back to front as its left side shows it, without the outermost hundredth of the leaves",
)
_DIAMETER = f"of the thickest stem {BREAST_HEIGHT} m above the root"
_TRUNK = _Quantity("m", "trunk_diameter", "measured", _DIAMETER)
_HIDDEN_TRUNK = _Quantity("m", "hidden_trunk_diameter", "derived", _DIAMETER)
_LEAF_AREA = _Quantity(
    "m²", "leaf_area", "derived", "one side of all leaves, as grown: the photo shows the outermost only"
)


def _height(height: float, scale: Scale) -> Measure:
    """Return a height; one that was given has no range."""
    if not scale.known:
        return Measure(height, _HEIGHT.unit, height, height, "given", _HEIGHT.meaning)
    return _figure(height, _HEIGHT, scale)


def _figure(value: float | None, quantity: _Quantity, scale: Scale) -> Measure:
    """Bound a figure by its own range and by the scale's, as often as metres are in its unit."""
    if value is None:
        return Measure(None, quantity.unit, None, None, quantity.basis, quantity.meaning)
    power = {"m": 1, "m²": 2, "m³": 3}[quantity.unit]
    less, more = RANGES[quantity.range]
    low, high = (1 - less) * (1 - scale.error) ** power, (1 + more) * (1 + scale.error) ** power
    return Measure(value, quantity.unit, value * low, value * high, quantity.basis, quantity.meaning)


def _spread(places: Floats) -> float:
    """Measure the span of places (n,), metres, without the outermost few."""
    low, high = np.quantile(places, (SPREAD_SHARE, 1 - SPREAD_SHARE))
    return float(high - low)


def _trunk_diameter(skeleton: Skeleton) -> float | None:
    """Measure the thickest stem at breast height; None on a lower tree."""
    parents, points = skeleton.parents, skeleton.points
    stem = generations(skeleton, heaviest_children(skeleton, skeleton.radii)) == 0
    foot = points[np.maximum(parents, 0), 1]
    crosses = np.flatnonzero(stem & (parents >= 0) & (foot <= BREAST_HEIGHT) & (points[:, 1] > BREAST_HEIGHT))
    if crosses.size == 0:
        return None
    share = (BREAST_HEIGHT - foot[crosses]) / (points[crosses, 1] - foot[crosses])
    below = skeleton.radii[parents[crosses]]
    return 2 * float((below + share * (skeleton.radii[crosses] - below)).max())


def _by_order(skeleton: Skeleton) -> tuple[int, ...]:
    """Count the limbs of each order that have a length."""
    successors = heaviest_children(skeleton, skeleton.radii)
    orders = generations(skeleton, successors)
    starts = (skeleton.parents < 0) | (successors[np.maximum(skeleton.parents, 0)] != np.arange(len(skeleton)))
    long = (skeleton.parents < 0) | (edge_lengths(skeleton) > 0)
    return tuple(np.bincount(orders[starts & long]).tolist())
