"""Shapes of single leaves, drawn by hand: polygons and veins in units of the leaf's own length.

Positions have the foot of the stalk at (0, 0), the tip at (0, 1) and x to the right. A half outline runs from a leaf's
foot to its tip along the right edge.
"""

from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np

from treestroke.core.types import Floats

LeafShapeName = Literal[
    "ash",
    "beech",
    "birch",
    "cherry",
    "elm",
    "horse_chestnut",
    "linden",
    "locust",
    "maple",
    "oak",
    "plane",
    "poplar",
    "walnut",
    "willow",
]

MAPLE = (
    (0.00, 0.09), (0.08, 0.02), (0.20, 0.00), (0.37, 0.04), (0.31, 0.12), (0.28, 0.19), (0.42, 0.22), (0.57, 0.28),
    (0.51, 0.36), (0.64, 0.57), (0.47, 0.53), (0.42, 0.62), (0.31, 0.52), (0.18, 0.47), (0.19, 0.62), (0.30, 0.74),
    (0.17, 0.77), (0.10, 0.88), (0.00, 1.00),
)  # fmt: skip
"""Right half of a sugar maple's leaf: five pointed lobes, rounded bays between them, a few large teeth."""
PLANE = (
    (0.00, 0.07), (0.12, 0.00), (0.27, 0.04), (0.47, 0.02), (0.42, 0.13), (0.40, 0.20), (0.58, 0.25), (0.59, 0.36),
    (0.72, 0.50), (0.55, 0.52), (0.49, 0.60), (0.31, 0.57), (0.30, 0.68), (0.37, 0.76), (0.22, 0.80), (0.13, 0.91),
    (0.00, 1.00),
)  # fmt: skip
"""Right half of a plane's leaf: broader than long, shallow bays, few coarse teeth."""
OAK = (
    (0.00, 0.00), (0.05, 0.06), (0.13, 0.12), (0.15, 0.18), (0.09, 0.23), (0.10, 0.28), (0.22, 0.33), (0.26, 0.40),
    (0.22, 0.45), (0.13, 0.46), (0.14, 0.52), (0.28, 0.58), (0.34, 0.66), (0.29, 0.72), (0.17, 0.70), (0.17, 0.76),
    (0.26, 0.83), (0.24, 0.90), (0.15, 0.90), (0.11, 0.94), (0.07, 0.99), (0.00, 1.00),
)  # fmt: skip
"""Right half of a white oak's leaf: round lobes that grow larger toward the tip."""
LINDEN = (
    (0.00, 0.10), (0.08, 0.02), (0.19, 0.00), (0.31, 0.04), (0.41, 0.14), (0.46, 0.28), (0.45, 0.42), (0.38, 0.57),
    (0.27, 0.71), (0.15, 0.82), (0.06, 0.89), (0.02, 0.95), (0.00, 1.00),
)  # fmt: skip
"""Right half of a linden's leaf: a broad heart with a drawn-out tip."""
POPLAR = (
    (0.00, 0.03), (0.16, 0.00), (0.34, 0.05), (0.44, 0.15), (0.46, 0.24), (0.39, 0.40), (0.29, 0.56), (0.18, 0.71),
    (0.10, 0.83), (0.04, 0.93), (0.00, 1.00),
)  # fmt: skip
"""Right half of a poplar's leaf: a triangle with rounded corners."""
BIRCH = (
    (0.00, 0.00), (0.14, 0.06), (0.29, 0.18), (0.37, 0.30), (0.34, 0.43), (0.26, 0.57), (0.17, 0.71), (0.09, 0.84),
    (0.03, 0.94), (0.00, 1.00),
)  # fmt: skip
"""Right half of a birch's leaf: a rhomb with a drawn-out tip."""
_MIDRIB = np.linspace(0.0, 1.0, 8)[:, None] * np.array([0.0, 1.0])
"""Points of a straight midrib of length 1 from the origin upward."""


@dataclass(frozen=True, eq=False)
class LeafShape:
    """One leaf in units of its own length: foot of its stalk at (0, 0), tip at (0, 1), x to the right.

    Attributes
    ----------
    outlines
        (n, 2) polygons, one for each leaflet.
    halves
        (m, 2) the left half of each leaflet, bounded by its midrib.
    veins
        (k, 2) lines, midribs first.
    stalk
        (s, 2) line that carries the leaflets.
    """

    outlines: tuple[Floats, ...]
    halves: tuple[Floats, ...]
    veins: tuple[Floats, ...]
    stalk: Floats


@cache
def leaf_shape(name: LeafShapeName) -> LeafShape:
    """Return the shape of a species' leaf."""
    match name:
        case "maple" | "plane":
            lobes = np.array(MAPLE if name == "maple" else PLANE)
            tips = ((0.34, 0.06), (0.58, 0.52), (0.46, 0.24), (0.24, 0.72))
            return _stalked(_leaflet(lobes, _palmate_veins(lobes[0, 1], tips)), 0.3)
        case "oak":
            return _stalked(_leaflet(np.array(OAK), _side_veins(np.array(OAK), (0.12, 0.3, 0.52, 0.74), 0.14)), 0.06)
        case "linden" | "poplar" | "birch":
            half, stalk = {"linden": (LINDEN, 0.26), "poplar": (POPLAR, 0.34), "birch": (BIRCH, 0.2)}[name]
            edge = _toothed(np.array(half), 0.012 if name == "poplar" else 0.02)
            return _stalked(_leaflet(edge, _side_veins(np.array(half), (0.1, 0.25, 0.4, 0.58), 0.2)), stalk)
        case "beech" | "elm" | "cherry" | "willow":
            return _simple(name)
        case "horse_chestnut":
            return _fan()
        case "ash" | "walnut" | "locust":
            return _feather(name)


def _simple(name: Literal["beech", "elm", "cherry", "willow"]) -> LeafShape:
    """Build a leaf of one oval, from broad (beech) to narrow (willow)."""
    breadth, widest, teeth, stalk, veins = {
        "beech": (0.62, 0.45, 0.008, 0.09, 6),
        "elm": (0.48, 0.5, 0.03, 0.06, 6),
        "cherry": (0.46, 0.46, 0.015, 0.2, 4),
        "willow": (0.19, 0.4, 0.0, 0.06, 0),
    }[name]
    half = _oval(breadth, widest)
    starts = tuple(np.linspace(0.08, 0.7, veins).tolist())
    return _stalked(_leaflet(_toothed(half, teeth), _side_veins(half, starts, 0.17)), stalk)


def _oval(breadth: float, widest: float, points: int = 12) -> Floats:
    """Right half (n, 2) of an oval with a drawn-out tip, widest at this share of its length."""
    t = np.linspace(0.0, 1.0, points)
    rise = np.sin(np.pi * t ** (np.log(0.5) / np.log(widest)))
    return np.stack([0.5 * breadth * np.maximum(rise, 0.0) ** 0.85 * (1.0 - 0.12 * t), t], axis=1)


def _toothed(half: Floats, depth: float) -> Floats:
    """Add forward-pointing saw teeth to a half outline (n, 2), one between any two points."""
    if depth == 0.0:
        return half
    middle = 0.5 * (half[1:] + half[:-1])
    forward = half[1:] - 0.25 * (half[1:] - half[:-1])
    outward = np.where(middle[:, :1] > 0.03, 1.0, 0.0) * np.array([depth, 0.0])
    teeth = np.stack([half[:-1], middle, forward + outward], axis=1)
    return np.vstack([teeth.reshape(-1, 2), half[-1:]])


def _side_veins(half: Floats, starts: tuple[float, ...], rise: float) -> tuple[Floats, ...]:
    """Lines (3, 2) from the midrib toward both edges of a half outline (n, 2), rising by ``rise`` from each start."""
    veins = []
    for start in starts:
        end = start + rise
        x = 0.8 * float(np.interp(end, half[:, 1], half[:, 0]))
        veins += [np.array([[0.0, start], [0.5 * x * side, start + 0.4 * rise], [x * side, end]]) for side in (-1, 1)]
    return tuple(veins)


def _palmate_veins(foot: float, tips: tuple[tuple[float, float], ...]) -> tuple[Floats, ...]:
    """Lines (2, 2) from a palmate leaf's foot into its lobes."""
    return tuple(
        np.array([[0.0, foot], [side * 0.9 * x, foot + 0.9 * (y - foot)]]) for x, y in tips for side in (-1, 1)
    )


def _leaflet(half: Floats, veins: tuple[Floats, ...] = ()) -> LeafShape:
    """Build a leaf without a stalk from the right half (n, 2) of its outline, mirrored."""
    left = half * np.array([-1.0, 1.0])
    foot = np.array([0.0, half[0, 1]])
    midrib = foot + _MIDRIB * (1.0 - half[0, 1])
    return LeafShape(
        (np.vstack([left, half[::-1][1:-1]]),),
        (np.vstack([left, midrib[::-1][1:-1]]),),
        (0.96 * midrib + 0.04 * foot, *veins),
        np.stack([foot, foot]),
    )


def _stalked(leaf: LeafShape, length: float) -> LeafShape:
    """Put a leaf on a stalk that takes this share of the total length."""
    placed = _placed(leaf, 1.0 - length, 0.0, np.array([0.0, length]))
    return LeafShape(placed.outlines, placed.halves, placed.veins, np.stack([np.zeros(2), placed.stalk[0]]))


def _placed(leaf: LeafShape, size: float, angle: float, foot: Floats) -> LeafShape:
    """Scale a leaf, turn it clockwise by an angle, rad, and move its origin to a foot (2,)."""
    turn = size * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def moved(lines: tuple[Floats, ...]) -> tuple[Floats, ...]:
        """Move lines (n, 2), in units of the leaf's length."""
        return tuple(line @ turn + foot for line in lines)

    return LeafShape(moved(leaf.outlines), moved(leaf.halves), moved(leaf.veins), leaf.stalk @ turn + foot)


def _joined(leaflets: list[LeafShape], stalk: Floats) -> LeafShape:
    """Combine leaflets on a stalk (s, 2) into one leaf; of their veins only the midribs stay."""
    return LeafShape(
        tuple(line for leaf in leaflets for line in leaf.outlines),
        tuple(line for leaf in leaflets for line in leaf.halves),
        tuple(line for leaf in leaflets for line in leaf.veins[:1]),
        stalk,
    )


def _fan() -> LeafShape:
    """Build a horse chestnut's leaf: seven leaflets from one point, the middle ones longest."""
    half = np.array([(0.0, 0.0), (0.04, 0.2), (0.11, 0.45), (0.17, 0.66), (0.16, 0.8), (0.07, 0.92), (0.0, 1.0)])
    foot, leaflet = np.array([0.0, 0.38]), _leaflet(_toothed(half, 0.012))
    fan = ((1.0, 0.0), (0.94, 0.68), (0.94, -0.68), (0.78, 1.33), (0.78, -1.33), (0.52, 2.05), (0.52, -2.05))
    return _joined(
        [_placed(leaflet, 0.62 * size, angle, foot) for size, angle in fan[::-1]], np.stack([np.zeros(2), foot])
    )


def _feather(name: Literal["ash", "walnut", "locust"]) -> LeafShape:
    """Build a pinnate leaf: pairs of leaflets along a stalk, and one at its end."""
    pairs, breadth, length, stalk, lean = {
        "ash": (3, 0.4, 0.34, 0.26, 0.95),
        "walnut": (6, 0.36, 0.27, 0.14, 1.15),
        "locust": (7, 0.58, 0.155, 0.12, 1.3),
    }[name]
    half = _oval(breadth, 0.5 if name == "locust" else 0.42, 8)
    leaflet = _leaflet(half)
    top = 1.0 - 0.9 * length
    places = np.linspace(stalk, top - 0.25 * length, pairs)
    sizes = length * (0.8 + 0.3 * np.sin(np.pi * np.linspace(0.2, 0.9, pairs)))
    leaflets = [
        _placed(leaflet, size, side * (lean - 0.25 * place), np.array([0.0, place]))
        for place, size in zip(places.tolist(), sizes.tolist(), strict=True)
        for side in (-1, 1)
    ]
    leaflets.append(_placed(leaflet, 0.9 * length, 0.0, np.array([0.0, top])))
    return _joined(leaflets, np.array([[0.0, 0.0], [0.0, 0.5 * top], [0.0, top]]))
