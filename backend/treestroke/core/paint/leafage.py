"""Sprays of one species' leaves."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.paint.blades import Blade, blade
from treestroke.core.paint.easel import DARK, EDGE, LIGHT, RIB, Easel, inside
from treestroke.core.paint.shoots import along, angle_of, draw_shoots, heading
from treestroke.core.paint.species import Seating, Species
from treestroke.core.types import Floats, Picture

LEAVES = 150
"""Leaves that a spray is tried to be drawn of."""
TIPPED = (0.62, 1.08)
"""Least and greatest breadth of a leaf as it is seen: most are tipped out of the picture's plane."""
INSET = 0.93
"""How far a leaf's inside reaches to its edge, which is darker."""


@dataclass(frozen=True, eq=False)
class LeafSeats:
    """Where leaves may sit: foot (p, 2), angle (p,) from straight up, clockwise, and size (p,), shares of the side."""

    foot: Floats
    angle: Floats
    size: Floats


def draw_leafage(species: Species, side: int, members: Floats, rng: np.random.Generator) -> Picture:
    """Draw a forked twig with a species' leaves along its shoots, each unless others hold its place.

    Raises
    ------
    ValueError
        The species has no leaf of its own.
    """
    if species.blade is None:
        raise ValueError("a spray of leaves needs a species with a leaf")
    leaf, easel = blade(species.blade), Easel(side, members, LEAVES, rng)
    shoots = draw_shoots(rng, species.shoots, 0.78 - 0.6 * species.length, 0.5 - 0.6 * species.length)
    seats = leaf_seats(shoots, species.seating, species.length, rng)
    outlines, rest = _set(leaf, seats, rng)
    easel.lines(shoots, easel.wood, 0.01)
    kept = np.flatnonzero(inside(outlines))
    rims, cores = easel.cells(outlines[kept]), easel.cells(0.5 * outlines[kept] + 0.5 * _middles(outlines[kept]))
    for piece, rim, core in zip(kept.tolist(), rims, cores, strict=True):
        if easel.taken(rim) <= 0.6 and easel.taken(core) <= 0.7:
            _draw_leaf(easel, leaf, outlines[piece], rest[piece], easel.paints[piece])
            if easel.is_full():
                break
    return easel.tile()


def leaf_seats(shoots: Floats, seating: Seating, length: float, rng: np.random.Generator) -> LeafSeats:
    """Seat leaves on shoots (m, 9, 2): first one at each tip, then at random on their nodes."""
    shoot = np.concatenate([np.arange(len(shoots)), rng.integers(len(shoots), size=LEAVES - len(shoots))])
    span = np.sqrt((np.diff(shoots, axis=1) ** 2).sum(axis=2)).sum(axis=1)
    nodes = np.clip(np.rint(span / (0.32 * length)), 2, 9)[shoot]
    node = np.floor(rng.random(LEAVES) * nodes)
    share = (node + 1) / nodes
    turn = np.where(node % 2 == 1, 1.0, -1.0) if seating == "alternate" else rng.choice([-1.0, 1.0], LEAVES)
    if seating == "tufted":
        share = 1.0 - 0.75 * rng.random(LEAVES) ** 1.5
        turn = rng.uniform(-1.6, 1.6, LEAVES)
    share[: len(shoots)], turn[: len(shoots)] = 1.0, 0.0
    foot = along(shoots[shoot], share)
    ahead = foot - along(shoots[shoot], share - 0.1)
    angle = angle_of(ahead) + turn * rng.uniform(0.6, 1.15, LEAVES) + rng.normal(0, 0.18, LEAVES)
    return LeafSeats(foot, angle, length * rng.uniform(0.7, 1.1, LEAVES) * (1.0 - 0.2 * (share == 1.0)))


def _set(leaf: Blade, seats: LeafSeats, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Set a leaf on each seat, tipped and bent: the points of its outlines (p, n, 2), and of all its other lines.

    The half that is drawn dark is the lower one.
    """
    count = len(seats.size)
    lower = np.where(np.sin(seats.angle) > 0, -1.0, 1.0)
    breadth = (lower * rng.uniform(*TIPPED, count))[:, None]
    bend = rng.normal(0, 0.06, count)[:, None]

    def placed(lines: tuple[Floats, ...]) -> Floats:
        x, y = np.concatenate(lines).T
        across = (x * breadth + bend * np.sin(np.pi * y)) * seats.size[:, None]
        ahead = y * seats.size[:, None]
        right, up = heading(seats.angle + np.pi / 2), heading(seats.angle)
        return np.asarray(seats.foot[:, None] + across[..., None] * right[:, None] + ahead[..., None] * up[:, None])

    return placed(leaf.outlines), placed((*leaf.halves, *leaf.veins, leaf.stalk))


def _middles(outlines: Floats) -> Floats:
    """Mean point of each leaf (p, 1, 2)."""
    return np.asarray(outlines.mean(axis=1, keepdims=True))


def _draw_leaf(easel: Easel, leaf: Blade, outline: Floats, rest: Floats, paint: Picture) -> None:
    """Draw one leaf: its stalk, and each leaflet as a dark edge, two halves folded along the midrib, and veins."""
    edges = np.split(outline, np.cumsum([len(line) for line in leaf.outlines])[:-1])
    pieces = np.split(rest, np.cumsum([len(line) for line in (*leaf.halves, *leaf.veins)]))
    halves, veins, stalk = pieces[: len(edges)], pieces[len(edges) : -1], pieces[-1]
    easel.lines(stalk[None], paint[DARK], 0.006)
    for edge, half in zip(edges, halves, strict=True):
        middle = edge.mean(axis=0)
        easel.polygon(edge, paint[EDGE])
        easel.polygon(middle + INSET * (edge - middle), paint[LIGHT])
        easel.polygon(middle + INSET * (half - middle), paint[DARK])
    for vein in veins:
        easel.lines(vein[None], paint[RIB], 0.003)
