"""Drawings of sprays: several leaves, needles or flowers on a twig, on a transparent square."""

from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.leaf.palette import Indices, rgb_from_lab

Floats = NDArray[np.float64]
Image = NDArray[np.uint8]
Shape = Literal["broad", "needles", "blossom"]

MARGIN = 0.035
"""Transparent border, share of the square's side, so that mip levels of neighbours do not mix."""
SUBPIXEL_BITS = 4
"""cv2 draws at 1/16 px."""
SHADES = np.array([-14.0, -7.0, -3.0, 0.0, 3.0, 7.0])
"""Lightness steps, CIE Lab, that one piece is painted in: heart, edge, dark half, plain, light half, midrib."""
HEART, EDGE, DARK, PLAIN, LIGHT, RIB = range(6)
LEAVES, FLOWERS, TUFTS = 200, 220, 36
"""Pieces that a spray is tried to be drawn of; those that would hide each other or leave the square are left out."""


class _Easel:
    """A square canvas drawn at twice its size; positions are 0 to 1, x right, y down.

    Holds the paints (p, 6, 3): one pixel of the photo a piece, in the six steps of SHADES. The clear ground has
    the mean colour, so that edges and mip levels show no halo.
    """

    def __init__(self, side: int, members: Floats, pieces: int, rng: np.random.Generator) -> None:
        self.side = 2 * side
        mean = members.mean(axis=0)
        picked = 0.55 * members[rng.integers(len(members), size=pieces)] + 0.45 * mean
        self.paints = rgb_from_lab(picked[:, None, :] + SHADES[:, None] * np.array([1.0, 0.0, 0.0]))
        wood = np.array([0.6 * mean[0], 0.5 * mean[1] + 4.0, 0.5 * mean[2] + 6.0])
        ground, self.wood = rgb_from_lab(np.stack([mean, wood]))
        self.canvas = np.empty((self.side, self.side, 4), dtype=np.uint8)
        self.canvas[:] = (*ground.tolist(), 0)

    def _corners(self, points: Floats) -> NDArray[np.int32]:
        """Points (..., 2) in cv2's fixed point."""
        return np.asarray(np.rint(points * (self.side << SUBPIXEL_BITS)), dtype=np.int32)

    def polygon(self, points: Floats, paint: Image) -> None:
        """Fill a polygon (n, 2)."""
        cv2.fillPoly(self.canvas, [self._corners(points)], (*paint.tolist(), 255), cv2.LINE_8, SUBPIXEL_BITS)

    def lines(self, polylines: Floats, paint: Image, width: float) -> None:
        """Draw polylines (m, n, 2), their width a share of the square's side."""
        colour, thickness = (*paint.tolist(), 255), max(1, round(width * self.side))
        cv2.polylines(self.canvas, list(self._corners(polylines)), False, colour, thickness, cv2.LINE_8, SUBPIXEL_BITS)

    def cells(self, points: Floats) -> Indices:
        """Canvas cells of points (..., 2), which lie inside the square."""
        column_row = (points * self.side).astype(np.int64)
        return np.asarray(column_row[..., 1] * self.side + column_row[..., 0])

    def taken(self, cells: Indices) -> float:
        """Share of the cells that are painted already."""
        return float(np.count_nonzero(self.canvas.reshape(-1, 4)[cells, 3])) / cells.size

    def tile(self) -> Image:
        """Shrink to (side, side, 4), straight alpha, the margin clear."""
        half = (self.side // 2, self.side // 2)
        tile = np.asarray(cv2.resize(self.canvas, half, interpolation=cv2.INTER_AREA), dtype=np.uint8)
        edge = round(MARGIN * half[0])
        for border in (tile[:edge], tile[-edge:], tile[:, :edge], tile[:, -edge:]):
            border[..., 3] = 0
        return tile


def draw_spray(shape: Shape, side: int, members: Floats, rng: np.random.Generator) -> Image:
    """Draw a spray whose twig rises from the bottom's middle, in colours drawn from members (m, 3), CIE Lab.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha; the clear part has the spray's mean colour.
    """
    match shape:
        case "broad":
            return _draw_leaves(side, members, rng)
        case "needles":
            return _draw_needles(side, members, rng)
        case "blossom":
            return _draw_blossom(side, members, rng)


def _inside(points: Floats) -> NDArray[np.bool_]:
    """Which pieces (p, n, 2) lie wholly in the rounded square that a spray fills (p,)."""
    reach = np.abs(points - 0.5) * 2
    return np.asarray((reach**3).sum(axis=2).max(axis=1) <= (1 - 2 * MARGIN) ** 3)


def _twig(rng: np.random.Generator) -> Floats:
    """Draw the twig (9, 2): from the bottom's middle upward with a bend."""
    t = np.linspace(0, 1, 9)
    bend, lean = rng.uniform(-0.06, 0.06), rng.uniform(-0.1, 0.1)
    return np.stack([0.5 + bend * np.sin(np.pi * t) + lean * t, 0.97 - 0.67 * t], axis=1)


def _heading(angle: Floats) -> Floats:
    """Turn angles from straight up, clockwise, into unit vectors (..., 2)."""
    return np.stack([np.sin(angle), -np.cos(angle)], axis=-1)


def _along(twig: Floats, share: Floats) -> Floats:
    """Points (..., 2) at shares of the twig's length."""
    return np.stack([np.interp(share * 8, np.arange(9), twig[:, axis]) for axis in range(2)], axis=-1)


def _draw_leaves(side: int, members: Floats, rng: np.random.Generator) -> Image:
    """Draw broad leaves to both sides of a twig and its side twigs, each unless others hold its place."""
    easel, twig = _Easel(side, members, LEAVES, rng), _twig(rng)
    share, turn = rng.uniform(0.02, 1.0, LEAVES), np.where(np.arange(LEAVES) % 2, 1.0, -1.0)
    angle = turn * rng.uniform(0.35, 1.75, LEAVES) * (1.1 - 0.8 * share) + rng.normal(0, 0.15, LEAVES)
    out = rng.uniform(0.0, 0.32, LEAVES) * np.sqrt(1 - (1.6 * share - 0.8) ** 2)
    base = _along(twig, share) + out[:, None] * _heading(turn * 1.1)
    outline, spine = _leaf_outlines(base, angle, rng)
    stalk = np.stack([_along(twig, np.maximum(0.0, share - 0.1)), base], axis=1)
    kept = np.flatnonzero(_inside(outline))
    rim, core = easel.cells(outline[kept]), easel.cells(spine[kept, 2:7])
    for piece, rim_cells, core_cells in zip(kept.tolist(), rim, core, strict=True):
        if easel.taken(rim_cells) <= 0.6 and easel.taken(core_cells) <= 0.8:
            easel.lines(stalk[piece : piece + 1], easel.wood, 0.008)
            _draw_leaf(easel, outline[piece], spine[piece], easel.paints[piece])
    easel.lines(twig[None, :7], easel.wood, 0.012)
    return easel.tile()


def _leaf_outlines(base: Floats, angle: Floats, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Outline ovate leaves: edges (p, 16, 2), left up and right down, and midribs (p, 8, 2)."""
    size, slimness = rng.uniform(0.2, 0.3, (2, len(base), 1, 1)) * np.array([1.0, 2.3]).reshape(2, 1, 1, 1)
    t = np.linspace(0, 1, 8)[:, None]
    half = 0.5 * slimness * size * np.sin(np.pi * t**0.75) ** 0.9 * _heading(angle + np.pi / 2)[:, None]
    spine = base[:, None] + t * size * _heading(angle)[:, None]
    return np.concatenate([spine - half, (spine + half)[:, ::-1]], axis=1), spine


def _draw_leaf(easel: _Easel, outline: Floats, spine: Floats, paint: Image) -> None:
    """Draw one leaf: a dark edge, two halves folded along the midrib, and the midrib."""
    base = spine[0]
    easel.polygon(outline, paint[EDGE])
    easel.polygon(base + 0.94 * (outline - base), paint[LIGHT])
    easel.polygon(base + 0.94 * (np.vstack([spine, outline[8:]]) - base), paint[DARK])
    easel.lines(spine[None, ::7], paint[RIB], 0.006)


def _draw_needles(side: int, members: Floats, rng: np.random.Generator) -> Image:
    """Draw a flat spray of side twigs, each with needles to both sides."""
    easel, twig = _Easel(side, members, TUFTS, rng), _twig(rng)
    share, turn = (np.arange(TUFTS) + rng.random(TUFTS)) / TUFTS, np.where(np.arange(TUFTS) % 2, 1.0, -1.0)
    angle = turn * rng.uniform(0.6, 1.3, TUFTS) * (1.2 - 0.9 * share)
    length = rng.uniform(0.3, 0.44, TUFTS) * (1.15 - 0.5 * share)
    needles = _needles(_along(twig, share), angle, length, rng)
    for tuft, paint in zip(needles, easel.paints, strict=True):
        kept = tuft[_inside(tuft)]
        for start, shade in enumerate((DARK, PLAIN, LIGHT)):
            easel.lines(kept[start::3], paint[shade], 0.015)
    easel.lines(twig[None], easel.wood, 0.012)
    return easel.tile()


def _needles(base: Floats, angle: Floats, length: Floats, rng: np.random.Generator) -> Floats:
    """Seat needles (p, 20, 2, 2) on side twigs; they point forward the more the nearer they are to its tip."""
    along = np.repeat(np.linspace(0.1, 1.0, 10), 2)
    shape = (len(base), len(along))
    turn = np.tile([-1.0, 1.0], 10) * rng.uniform(0.5, 0.95, shape) * (1.1 - 0.75 * along)
    foot = base[:, None] + (along * length[:, None])[..., None] * _heading(angle)[:, None]
    tip = foot + rng.uniform(0.08, 0.12, shape)[..., None] * _heading(angle[:, None] + turn)
    return np.stack([foot, tip], axis=2)


def _draw_blossom(side: int, members: Floats, rng: np.random.Generator) -> Image:
    """Draw five-petalled flowers in loose clusters on a twig, each unless others hold its place."""
    easel, twig = _Easel(side, members, FLOWERS, rng), _twig(rng)
    share, radius = rng.uniform(0.1, 1.0, FLOWERS), rng.uniform(0.05, 0.085, (FLOWERS, 1, 1))
    centre = _along(twig, share) + rng.normal(0, 0.17, (FLOWERS, 2))
    start = rng.uniform(0, 2 * np.pi, (FLOWERS, 1))
    spokes = radius * _heading(start + np.arange(5) * 2 * np.pi / 5)
    stalk = np.stack([_along(twig, np.maximum(0, share - 0.2)), centre], axis=1)
    rim = centre[:, None] + 1.6 * spokes
    kept = np.flatnonzero(_inside(rim))
    easel.lines(twig[None], easel.wood, 0.012)
    easel.lines(stalk[kept[:20]], easel.wood, 0.006)
    for piece in kept.tolist():
        if easel.taken(easel.cells(rim[piece])) <= 0.4:
            _draw_flower(easel, centre[piece], spokes[piece], easel.paints[piece])
    return easel.tile()


def _draw_flower(easel: _Easel, centre: Floats, spokes: Floats, paint: Image) -> None:
    """Draw one flower: five round petals and a darker heart."""
    circle = float(np.hypot(*spokes[0])) * _heading(np.linspace(0, 2 * np.pi, 10))
    for spoke, shade in zip(spokes, (PLAIN, LIGHT, DARK, LIGHT, PLAIN), strict=True):
        easel.polygon(centre + spoke + 0.7 * circle, paint[shade])
    easel.polygon(centre + 0.25 * circle, paint[HEART])
