"""Drawings of sprays: several leaves, needles or flowers on a twig, on a transparent square."""

from typing import Literal

import numpy as np

from treestroke.core.paint.conifers import draw_shoot_of_needles
from treestroke.core.paint.easel import DARK, EDGE, HEART, LIGHT, PLAIN, RIB, Easel, inside
from treestroke.core.paint.leafage import draw_leafage
from treestroke.core.paint.shoots import along, angle_of, draw_shoots, draw_twig, heading
from treestroke.core.paint.species import AUTO, Species
from treestroke.core.types import Floats, Picture

Shape = Literal["broad", "needles", "blossom"]

LEAVES, FLOWERS = 200, 220
"""Pieces that a spray is tried to be drawn of; those that would hide each other or leave the square are left out."""
NEEDLES = 120
"""Needles of a shoot."""


def draw_spray(shape: Shape, side: int, members: Floats, rng: np.random.Generator, species: Species = AUTO) -> Picture:
    """Draw a spray whose twig rises from the bottom's middle, in colours drawn from members (m, 3), CIE Lab.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha; the clear part has the spray's mean colour.
    """
    match shape:
        case "broad":
            return (
                _draw_leaves(side, members, rng) if species.blade is None else draw_leafage(species, side, members, rng)
            )
        case "needles" if species.needles is not None:
            return draw_shoot_of_needles(species.needles, side, members, rng)
        case "needles":
            return _draw_needles(side, members, rng)
        case "blossom":
            return _draw_blossom(side, members, rng)


def _draw_leaves(side: int, members: Floats, rng: np.random.Generator) -> Picture:
    """Draw a forked twig with broad leaves along its shoots, each leaf unless others hold its place."""
    easel, shoots = Easel(side, members, LEAVES, rng), draw_shoots(rng, int(rng.integers(6, 10)), 0.66)
    shoot = rng.integers(len(shoots), size=LEAVES)
    share, turn = rng.uniform(0.15, 1.0, LEAVES), np.where(np.arange(LEAVES) % 2, 1.0, -1.0)
    share[: len(shoots)], shoot[: len(shoots)] = 1.0, np.arange(len(shoots))
    base = along(shoots[shoot], share)
    ahead = base - along(shoots[shoot], share - 0.1)
    spread = turn * rng.uniform(0.3, 1.3, LEAVES) * (1.15 - share)
    angle = angle_of(ahead) + spread + rng.normal(0, 0.2, LEAVES)
    outline, spine = _leaf_outlines(base, angle, rng)
    easel.lines(shoots, easel.wood, 0.01)
    kept = np.flatnonzero(inside(outline))
    rim, core = easel.cells(outline[kept]), easel.cells(spine[kept, 2:7])
    for piece, rim_cells, core_cells in zip(kept.tolist(), rim, core, strict=True):
        if easel.taken(rim_cells) <= 0.6 and easel.taken(core_cells) <= 0.75:
            _draw_leaf(easel, outline[piece], spine[piece], easel.paints[piece])
    return easel.tile()


def _leaf_outlines(base: Floats, angle: Floats, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Outline leaves that end in a drawn-out tip: edges (p, 16, 2), left up and right down, and midribs (p, 8, 2).

    Leaves of one spray are of one form, from slender to broad, in different sizes.
    """
    form, size = rng.uniform(0.5, 0.74), rng.uniform(0.17, 0.31, (len(base), 1, 1))
    breadth = form * rng.uniform(0.8, 1.15, (len(base), 1, 1)) * size
    t = np.linspace(0, 1, 8)[:, None]
    profile = 1.25 * np.sin(np.pi * t**0.8) * (1 - 0.45 * t)
    bend = rng.normal(0, 0.05, (len(base), 1, 1)) * np.sin(np.pi * t) * size
    across = heading(angle + np.pi / 2)[:, None]
    spine = base[:, None] + t * size * heading(angle)[:, None] + bend * across
    half = 0.5 * breadth * profile * across
    return np.concatenate([spine - half, (spine + half)[:, ::-1]], axis=1), spine


def _draw_leaf(easel: Easel, outline: Floats, spine: Floats, paint: Picture) -> None:
    """Draw one leaf: a dark edge, two halves folded along the midrib, and the midrib."""
    base = spine[0]
    easel.polygon(outline, paint[EDGE])
    easel.polygon(base + 0.94 * (outline - base), paint[LIGHT])
    easel.polygon(base + 0.94 * (np.vstack([spine, outline[8:]]) - base), paint[DARK])
    easel.lines(spine[None, :7], paint[RIB], 0.005)


def _draw_needles(side: int, members: Floats, rng: np.random.Generator) -> Picture:
    """Draw a twig and few shoots as brushes: long thin needles that point forward, frayed at the outline."""
    shoots = draw_shoots(rng, int(rng.integers(3, 6)), 0.8)
    easel = Easel(side, members, NEEDLES * len(shoots), rng)
    needles = _needles(shoots, rng.uniform(0.19, 0.24), rng)
    easel.lines(shoots, easel.wood, 0.012)
    paints = easel.paints.reshape(len(shoots), NEEDLES, *easel.paints.shape[1:])
    for brush, paint in zip(needles, paints, strict=True):
        kept = brush[inside(brush)]
        for start in range(12):
            easel.lines(kept[start::12], paint[start, (DARK, PLAIN, LIGHT)[start // 4]], 0.013)
    return easel.tile()


def _needles(shoots: Floats, length: float, rng: np.random.Generator) -> Floats:
    """Seat needles (m, NEEDLES, 2, 2) on shoots (m, 9, 2), pointing forward, shorter toward a shoot's tip.

    Each shoot becomes a narrow brush: single needles are gone where a card is few pixels wide, the brushes are not.
    """
    share = np.sort(rng.uniform(0.06, 1.0, (len(shoots), NEEDLES)), axis=1)
    lines = np.repeat(shoots[:, None], NEEDLES, axis=1)
    foot = along(lines, share)
    ahead = foot - along(lines, share - 0.1)
    spread = rng.choice([-1.0, 1.0], share.shape) * rng.uniform(0.25, 0.9, share.shape) * (1.1 - 0.5 * share)
    angle = angle_of(ahead) + spread
    tip = foot + (length * (1.15 - 0.4 * share) * rng.uniform(0.7, 1.1, share.shape))[..., None] * heading(angle)
    return np.stack([foot, tip], axis=2)


def _draw_blossom(side: int, members: Floats, rng: np.random.Generator) -> Picture:
    """Draw five-petalled flowers in loose clusters on a twig, each unless others hold its place."""
    easel, twig = Easel(side, members, FLOWERS, rng), draw_twig(rng)
    share, radius = rng.uniform(0.1, 1.0, FLOWERS), rng.uniform(0.05, 0.085, (FLOWERS, 1, 1))
    centre = along(twig, share) + rng.normal(0, 0.17, (FLOWERS, 2))
    start = rng.uniform(0, 2 * np.pi, (FLOWERS, 1))
    spokes = radius * heading(start + np.arange(5) * 2 * np.pi / 5)
    stalk = np.stack([along(twig, np.maximum(0, share - 0.2)), centre], axis=1)
    rim = centre[:, None] + 1.6 * spokes
    kept = np.flatnonzero(inside(rim))
    easel.lines(twig[None], easel.wood, 0.012)
    easel.lines(stalk[kept[:20]], easel.wood, 0.006)
    for piece in kept.tolist():
        if easel.taken(easel.cells(rim[piece])) <= 0.4:
            _draw_flower(easel, centre[piece], spokes[piece], easel.paints[piece])
    return easel.tile()


def _draw_flower(easel: Easel, centre: Floats, spokes: Floats, paint: Picture) -> None:
    """Draw one flower: five round petals and a darker heart."""
    circle = float(np.hypot(*spokes[0])) * heading(np.linspace(0, 2 * np.pi, 10))
    for spoke, shade in zip(spokes, (PLAIN, LIGHT, DARK, LIGHT, PLAIN), strict=True):
        easel.polygon(centre + spoke + 0.7 * circle, paint[shade])
    easel.polygon(centre + 0.25 * circle, paint[HEART])
