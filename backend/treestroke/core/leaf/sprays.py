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
LIGHT_SCATTER = 4.0
"""Standard deviation of the pieces' lightness, CIE Lab: leaves turn to the light each in its own way."""
LEAVES, FLOWERS = 200, 220
"""Pieces that a spray is tried to be drawn of; those that would hide each other or leave the square are left out."""
NEEDLES = 120
"""Needles of a shoot."""
ROOM = 0.36
"""How far shoots reach from the square's middle, so that the leaves at their tips have room."""


class _Easel:
    """A square canvas drawn at twice its size; positions are 0 to 1, x right, y down.

    Holds the paints (p, 6, 3): one pixel of the photo a piece, in the six steps of SHADES. The clear ground has
    the mean colour, so that edges and mip levels show no halo.
    """

    def __init__(self, side: int, members: Floats, pieces: int, rng: np.random.Generator) -> None:
        self.side = 2 * side
        mean = members.mean(axis=0)
        picked = 0.7 * members[rng.integers(len(members), size=pieces)] + 0.3 * mean
        picked[:, 0] += rng.normal(0, LIGHT_SCATTER, pieces)
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
    return np.stack([0.5 + bend * np.sin(np.pi * t) + lean * t, 0.97 - 0.7 * t], axis=1)


def _heading(angle: Floats) -> Floats:
    """Turn angles from straight up, clockwise, into unit vectors (..., 2)."""
    return np.stack([np.sin(angle), -np.cos(angle)], axis=-1)


def _along(lines: Floats, share: Floats) -> Floats:
    """Points (..., 2) at shares (...) of the length of lines (..., 9, 2), each of its own or all of one line."""
    place = np.clip(share, 0, 1) * 8
    piece = np.minimum(place, 7).astype(np.int64)
    lines = np.broadcast_to(lines, (*share.shape, 9, 2))
    start, end = (np.take_along_axis(lines, (piece + k)[..., None, None], axis=-2)[..., 0, :] for k in (0, 1))
    return np.asarray(start + (place - piece)[..., None] * (end - start))


def _draw_leaves(side: int, members: Floats, rng: np.random.Generator) -> Image:
    """Draw a forked twig with broad leaves along its shoots, each leaf unless others hold its place."""
    easel, shoots = _Easel(side, members, LEAVES, rng), _shoots(rng, int(rng.integers(6, 10)), 0.66)
    shoot = rng.integers(len(shoots), size=LEAVES)
    share, turn = rng.uniform(0.15, 1.0, LEAVES), np.where(np.arange(LEAVES) % 2, 1.0, -1.0)
    share[: len(shoots)], shoot[: len(shoots)] = 1.0, np.arange(len(shoots))
    base = _along(shoots[shoot], share)
    ahead = base - _along(shoots[shoot], share - 0.1)
    spread = turn * rng.uniform(0.3, 1.3, LEAVES) * (1.15 - share)
    angle = np.arctan2(ahead[:, 0], -ahead[:, 1]) + spread + rng.normal(0, 0.2, LEAVES)
    outline, spine = _leaf_outlines(base, angle, rng)
    easel.lines(shoots, easel.wood, 0.01)
    kept = np.flatnonzero(_inside(outline))
    rim, core = easel.cells(outline[kept]), easel.cells(spine[kept, 2:7])
    for piece, rim_cells, core_cells in zip(kept.tolist(), rim, core, strict=True):
        if easel.taken(rim_cells) <= 0.6 and easel.taken(core_cells) <= 0.75:
            _draw_leaf(easel, outline[piece], spine[piece], easel.paints[piece])
    return easel.tile()


def _shoots(rng: np.random.Generator, count: int, longest: float) -> Floats:
    """Draw a twig and the bent shoots (count + 1, 9, 2) that leave it to both sides, no two sprays alike."""
    twig, t = _twig(rng), np.linspace(0, 1, 9)
    share = (np.arange(count) + rng.uniform(0.1, 0.9, count)) / count
    turn = np.where((np.arange(count) + rng.integers(2)) % 2, 1.0, -1.0)
    length = longest * rng.uniform(0.55, 1.0, count) * (1.0 - 0.45 * share)
    angle = turn * rng.uniform(0.6, 1.25, count) * (1.1 - 0.4 * share)
    bent = angle[:, None] + turn[:, None] * rng.uniform(-0.5, 0.25, (count, 1)) * t
    foot, way = _along(twig, share), length[:, None, None] * t[:, None] * _heading(bent)
    room = np.minimum(1.0, ROOM / np.abs(foot[:, None] - 0.5 + way).max(axis=(1, 2)))
    return np.concatenate([twig[None], foot[:, None] + room[:, None, None] * way])


def _leaf_outlines(base: Floats, angle: Floats, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Outline leaves that end in a drawn-out tip: edges (p, 16, 2), left up and right down, and midribs (p, 8, 2).

    Leaves of one spray are of one form, from slender to broad, in different sizes.
    """
    form, size = rng.uniform(0.5, 0.74), rng.uniform(0.17, 0.31, (len(base), 1, 1))
    breadth = form * rng.uniform(0.8, 1.15, (len(base), 1, 1)) * size
    t = np.linspace(0, 1, 8)[:, None]
    profile = 1.25 * np.sin(np.pi * t**0.8) * (1 - 0.45 * t)
    bend = rng.normal(0, 0.05, (len(base), 1, 1)) * np.sin(np.pi * t) * size
    across = _heading(angle + np.pi / 2)[:, None]
    spine = base[:, None] + t * size * _heading(angle)[:, None] + bend * across
    half = 0.5 * breadth * profile * across
    return np.concatenate([spine - half, (spine + half)[:, ::-1]], axis=1), spine


def _draw_leaf(easel: _Easel, outline: Floats, spine: Floats, paint: Image) -> None:
    """Draw one leaf: a dark edge, two halves folded along the midrib, and the midrib."""
    base = spine[0]
    easel.polygon(outline, paint[EDGE])
    easel.polygon(base + 0.94 * (outline - base), paint[LIGHT])
    easel.polygon(base + 0.94 * (np.vstack([spine, outline[8:]]) - base), paint[DARK])
    easel.lines(spine[None, :7], paint[RIB], 0.005)


def _draw_needles(side: int, members: Floats, rng: np.random.Generator) -> Image:
    """Draw a twig and few shoots as brushes: long thin needles that point forward, frayed at the outline."""
    shoots = _shoots(rng, int(rng.integers(3, 6)), 0.8)
    easel = _Easel(side, members, NEEDLES * len(shoots), rng)
    needles = _needles(shoots, rng.uniform(0.19, 0.24), rng)
    easel.lines(shoots, easel.wood, 0.012)
    paints = easel.paints.reshape(len(shoots), NEEDLES, *easel.paints.shape[1:])
    for brush, paint in zip(needles, paints, strict=True):
        kept = brush[_inside(brush)]
        for start in range(12):
            easel.lines(kept[start::12], paint[start, (DARK, PLAIN, LIGHT)[start // 4]], 0.013)
    return easel.tile()


def _needles(shoots: Floats, length: float, rng: np.random.Generator) -> Floats:
    """Seat needles (m, NEEDLES, 2, 2) on shoots (m, 9, 2), pointing forward, shorter toward a shoot's tip.

    Each shoot becomes a narrow brush: single needles are gone where a card is few pixels wide, the brushes are not.
    """
    along = np.sort(rng.uniform(0.06, 1.0, (len(shoots), NEEDLES)), axis=1)
    lines = np.repeat(shoots[:, None], NEEDLES, axis=1)
    foot = _along(lines, along)
    ahead = foot - _along(lines, along - 0.1)
    spread = rng.choice([-1.0, 1.0], along.shape) * rng.uniform(0.25, 0.9, along.shape) * (1.1 - 0.5 * along)
    angle = np.arctan2(ahead[..., 0], -ahead[..., 1]) + spread
    tip = foot + (length * (1.15 - 0.4 * along) * rng.uniform(0.7, 1.1, along.shape))[..., None] * _heading(angle)
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
