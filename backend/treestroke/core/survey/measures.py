"""Measures of a tree as foresters take them, each with its range and what it rests on."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from treestroke.core.geometry.envelope import Envelope
from treestroke.core.skeleton.measure import edge_lengths, generations
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import heaviest_children
from treestroke.core.types import Floats

BREAST_HEIGHT = 1.3
"""Metres above the root at which a trunk's diameter is taken."""
SPREAD_SHARE = 0.01
"""Share of a crown's foliage that may reach beyond its width or depth to either side: single leaves make no width."""
ENDS_PX = 3.0
"""How far off the ends of a line of known length may be drawn together, px at a long side of 1500."""
RANGES = {
    "height": (0.03, 0.02),
    "crown_width": (0.12, 0.05),
    "crown_depth": (0.2, 0.35),
    "trunk_diameter": (0.15, 0.35),
    "hidden_trunk_diameter": (0.4, 0.6),
    "crown_volume": (0.35, 0.25),
    "leaf_area": (0.5, 0.5),
}
"""Shares by which a measure may be too large, and too small, with the scale taken as exact. They hold all figures of 4
trees that are known in 3D; for trees unlike those they are a guess."""

Basis = Literal["given", "measured", "derived"]
"""Taken from what the person says; seen in the photo; following from what was grown where the photo shows nothing."""


@dataclass(frozen=True)
class Measure:
    """One figure, e.g. metres; ``low`` and ``high`` bound what it may be in truth. None where there is none to take."""

    value: float | None
    unit: str
    low: float | None
    high: float | None
    basis: Basis
    meaning: str


@dataclass(frozen=True)
class Scale:
    """Metres a pixel of the photo, whether a line of known length says so, and the share by which that may be off."""

    metres_per_pixel: float
    known: bool
    error: float


@dataclass(frozen=True, eq=False)
class Measures:
    """All figures of a tree, and the number of its branches in each order: stems, what leaves them, and so on."""

    scale: Scale
    figures: Mapping[str, Measure]
    branches_by_order: tuple[int, ...]


def measure_tree(
    skeleton: Skeleton,
    height: float,
    trunk_seen: bool,
    foliage: Floats | None,
    leaf_area: float,
    envelope: Envelope,
    scale: Scale,
) -> Measures:
    """Take a tree's measures.

    Parameters
    ----------
    skeleton
        The grown tree, metres.
    height
        From its root to the top of its foliage in the photo, metres.
    trunk_seen
        Whether the photo shows how thick it is at breast height.
    foliage
        (m, 3) places of its leaves, metres; None on a bare tree, whose twigs then are the crown.
    leaf_area
        One side of all leaves, square metres.
    envelope
        The crown's solid.
    scale
        What metres rest on.
    """
    crown = skeleton.points if foliage is None else foliage
    figures = {
        "height": _height(height, scale),
        "crown_width": _figure(_spread(crown[:, 0]), "m", "crown_width", scale, "measured", WIDTH),
        "crown_depth": _depth(_spread(crown[:, 2]), envelope, scale),
        "trunk_diameter": _trunk(skeleton, trunk_seen, scale),
        "crown_volume": _volume(envelope, scale),
        "leaf_area": _figure(leaf_area, "m²", "leaf_area", scale, "derived", LEAF_AREA),
    }
    return Measures(scale, figures, _by_order(skeleton))


HEIGHT = "from the root to the topmost leaf or twig"
WIDTH = "of the crown from side to side as the front shows it, without the outermost hundredth of the leaves"
DEPTH = "of the crown along the view, which no single picture shows: as grown"
DEPTH_SEEN = "of the crown from back to front as its left side shows it, without the outermost hundredth of the leaves"
DIAMETER = f"of the thickest stem {BREAST_HEIGHT} m above the root"
VOLUME = "of the solid whose level sections are circles as wide as the crown's front"
VOLUME_OF_TWO = "of the solid whose level sections are ellipses as wide as the crown's front, as deep as its left side"
LEAF_AREA = "one side of all leaves, as grown: the photo shows the outermost only"


def _height(height: float, scale: Scale) -> Measure:
    """Take a height that was given as it is."""
    if not scale.known:
        return Measure(height, "m", height, height, "given", HEIGHT)
    return _figure(height, "m", "height", scale, "measured", HEIGHT)


def _figure(value: float | None, unit: str, name: str, scale: Scale, basis: Basis, meaning: str) -> Measure:
    """Bound a figure by its own range and by the scale's, as often as metres are in its unit."""
    if value is None:
        return Measure(None, unit, None, None, basis, meaning)
    power = {"m": 1, "m²": 2, "m³": 3}[unit]
    less, more = RANGES[name]
    low, high = (1 - less) * (1 - scale.error) ** power, (1 + more) * (1 + scale.error) ** power
    return Measure(value, unit, value * low, value * high, basis, meaning)


def _spread(places: Floats) -> float:
    """Measure from side to side without the outermost few."""
    low, high = np.quantile(places, (SPREAD_SHARE, 1 - SPREAD_SHARE))
    return float(high - low)


def _depth(depth: float, envelope: Envelope, scale: Scale) -> Measure:
    """Take a depth that was drawn as sure as a width."""
    if envelope.depth is None:
        return _figure(depth, "m", "crown_depth", scale, "derived", DEPTH)
    return _figure(depth, "m", "crown_width", scale, "measured", DEPTH_SEEN)


def _volume(envelope: Envelope, scale: Scale) -> Measure:
    """Add up the solid's level sections, circles or ellipses."""
    deep, meaning = envelope.radius_px, VOLUME
    if envelope.depth is not None:
        deep, meaning = envelope.depth.radius_px, VOLUME_OF_TWO
    volume = float(np.pi * (envelope.radius_px * deep).sum() * envelope.camera.metres_per_pixel**3)
    return _figure(volume, "m³", "crown_volume", scale, "derived", meaning)


def _trunk(skeleton: Skeleton, seen: bool, scale: Scale) -> Measure:
    name: str = "trunk_diameter" if seen else "hidden_trunk_diameter"
    return _figure(_trunk_diameter(skeleton), "m", name, scale, "measured" if seen else "derived", DIAMETER)


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
