"""Sprays of broad leaves: a species' own leaf shape, or ovate leaves where the species is unknown."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.paint.canvas import DARK, EDGE, LIGHT, RIB, Canvas, fits_canvas
from treestroke.core.paint.leaf_shapes import LeafShape, leaf_shape
from treestroke.core.paint.shoots import along, angle_of, draw_shoots, heading
from treestroke.core.paint.species import LeafArrangement, Species
from treestroke.core.types import Floats, Picture

LEAVES, OVATE_LEAVES = 150, 200
"""Leaves tried for a spray of a known and of an unknown species; those that would hide others are left out."""
BREADTH_SEEN = (0.62, 1.08)
"""Least and greatest apparent breadth of a leaf, relative to its own: most are tilted against the picture's plane."""
INSET = 0.93
"""Size of a leaf's inside relative to its outline; the rim between them is darker."""


@dataclass(frozen=True, eq=False)
class LeafPoses:
    """Poses of p leaves: foot (p, 2), angle (p,), rad, clockwise from straight up, and size (p,).

    Feet and sizes are shares of the spray's side.
    """

    foot: Floats
    angle: Floats
    size: Floats


def draw_species_leaves(species: Species, side: int, colours: Floats, rng: np.random.Generator) -> Picture:
    """Draw a forked twig with a species' leaves along its shoots, leaving out leaves that would hide others.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha, in colours drawn from (m, 3), CIE Lab.

    Raises
    ------
    ValueError
        The species has no leaf shape of its own.
    """
    if species.leaf_shape is None:
        raise ValueError("a spray of leaves needs a species with a leaf shape")
    leaf, canvas = leaf_shape(species.leaf_shape), Canvas(side, colours, LEAVES, rng)
    shoots = draw_shoots(rng, species.shoots, *shoot_room(species.length))
    poses = leaf_poses(shoots, species.arrangement, species.length, rng)
    outlines, details = _posed(leaf, poses, rng)
    canvas.lines(shoots, canvas.wood, 0.01)
    fitting = np.flatnonzero(fits_canvas(outlines))
    middles = outlines[fitting].mean(axis=1, keepdims=True)
    rims, cores = canvas.cells(outlines[fitting]), canvas.cells(0.5 * outlines[fitting] + 0.5 * middles)
    for index, rim, core in zip(fitting.tolist(), rims, cores, strict=True):
        if canvas.painted_share(rim) <= 0.6 and canvas.painted_share(core) <= 0.7:
            _draw_leaf(canvas, leaf, outlines[index], details[index], canvas.paints[index])
            if canvas.is_full():
                break
    return canvas.tile()


def shoot_room(length: float) -> tuple[float, float]:
    """Return how long shoots may be, and how far from the middle they may reach, so that leaves at their tips fit."""
    return 0.78 - 0.6 * length, 0.5 - 0.6 * length


def leaf_poses(shoots: Floats, arrangement: LeafArrangement, length: float, rng: np.random.Generator) -> LeafPoses:
    """Place leaves on shoots (m, 9, 2), shares of the side: first one at each tip, then at random on the nodes."""
    shoot = np.concatenate([np.arange(len(shoots)), rng.integers(len(shoots), size=LEAVES - len(shoots))])
    span = np.sqrt((np.diff(shoots, axis=1) ** 2).sum(axis=2)).sum(axis=1)
    nodes = np.clip(np.rint(span / (0.32 * length)), 2, 9)[shoot]
    node = np.floor(rng.random(LEAVES) * nodes)
    share = (node + 1) / nodes
    turn = np.where(node % 2 == 1, 1.0, -1.0) if arrangement == "alternate" else rng.choice([-1.0, 1.0], LEAVES)
    if arrangement == "tufted":
        share = 1.0 - 0.75 * rng.random(LEAVES) ** 1.5
        turn = rng.uniform(-1.6, 1.6, LEAVES)
    share[: len(shoots)], turn[: len(shoots)] = 1.0, 0.0
    foot = along(shoots[shoot], share)
    ahead = foot - along(shoots[shoot], share - 0.1)
    angle = angle_of(ahead) + turn * rng.uniform(0.6, 1.15, LEAVES) + rng.normal(0, 0.18, LEAVES)
    return LeafPoses(foot, angle, length * rng.uniform(0.7, 1.1, LEAVES) * (1.0 - 0.2 * (share == 1.0)))


def _posed(leaf: LeafShape, poses: LeafPoses, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Place a tilted, bent copy of a leaf at each pose: its outlines' points (p, n, 2) and those of its other lines.

    The half that is drawn dark is the lower one.
    """
    count = len(poses.size)
    lower = np.where(np.sin(poses.angle) > 0, -1.0, 1.0)
    breadth = (lower * rng.uniform(*BREADTH_SEEN, count))[:, None]
    bend = rng.normal(0, 0.06, count)[:, None]

    def copies(lines: tuple[Floats, ...]) -> Floats:
        """Points (p, n, 2), shares of the side, of the lines' n points in every copy."""
        x, y = np.concatenate(lines).T
        across = (x * breadth + bend * np.sin(np.pi * y)) * poses.size[:, None]
        ahead = y * poses.size[:, None]
        right, up = heading(poses.angle + np.pi / 2), heading(poses.angle)
        return np.asarray(poses.foot[:, None] + across[..., None] * right[:, None] + ahead[..., None] * up[:, None])

    return copies(leaf.outlines), copies((*leaf.halves, *leaf.veins, leaf.stalk))


def _draw_leaf(canvas: Canvas, leaf: LeafShape, outline: Floats, details: Floats, paint: Picture) -> None:
    """Draw one leaf: its stalk, then each leaflet's dark rim, its two halves folded along the midrib, and its veins."""
    edges = np.split(outline, np.cumsum([len(line) for line in leaf.outlines])[:-1])
    lines = np.split(details, np.cumsum([len(line) for line in (*leaf.halves, *leaf.veins)]))
    halves, veins, stalk = lines[: len(edges)], lines[len(edges) : -1], lines[-1]
    canvas.lines(stalk[None], paint[DARK], 0.006)
    for edge, half in zip(edges, halves, strict=True):
        middle = edge.mean(axis=0)
        canvas.polygon(edge, paint[EDGE])
        canvas.polygon(middle + INSET * (edge - middle), paint[LIGHT])
        canvas.polygon(middle + INSET * (half - middle), paint[DARK])
    for vein in veins:
        canvas.lines(vein[None], paint[RIB], 0.003)


def draw_ovate_leaves(length: float, side: int, colours: Floats, rng: np.random.Generator) -> Picture:
    """Draw a forked twig with ovate leaves along its shoots, leaving out leaves that would hide others.

    ``length`` is that of a leaf in the mean, a share of the side.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha, in colours drawn from (m, 3), CIE Lab.
    """
    canvas = Canvas(side, colours, OVATE_LEAVES, rng)
    shoots = draw_shoots(rng, int(rng.integers(6, 10)), *shoot_room(length))
    shoot = rng.integers(len(shoots), size=OVATE_LEAVES)
    share, turn = rng.uniform(0.15, 1.0, OVATE_LEAVES), np.where(np.arange(OVATE_LEAVES) % 2, 1.0, -1.0)
    share[: len(shoots)], shoot[: len(shoots)] = 1.0, np.arange(len(shoots))
    base = along(shoots[shoot], share)
    ahead = base - along(shoots[shoot], share - 0.1)
    spread = turn * rng.uniform(0.3, 1.3, OVATE_LEAVES) * (1.15 - share)
    angle = angle_of(ahead) + spread + rng.normal(0, 0.2, OVATE_LEAVES)
    outlines, midribs = _ovate_outlines(base, angle, length, rng)
    canvas.lines(shoots, canvas.wood, 0.01)
    fitting = np.flatnonzero(fits_canvas(outlines))
    rims, cores = canvas.cells(outlines[fitting]), canvas.cells(midribs[fitting, 2:7])
    for index, rim, core in zip(fitting.tolist(), rims, cores, strict=True):
        if canvas.painted_share(rim) <= 0.6 and canvas.painted_share(core) <= 0.75:
            _draw_ovate_leaf(canvas, outlines[index], midribs[index], canvas.paints[index])
    return canvas.tile()


def _ovate_outlines(base: Floats, angle: Floats, length: float, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Outline leaves with a drawn-out tip: edges (p, 16, 2), left side up and right side down, and midribs (p, 8, 2).

    All leaves of a spray share one form, from slender to broad, in different sizes.
    """
    form, size = rng.uniform(0.5, 0.74), length * rng.uniform(0.7, 1.3, (len(base), 1, 1))
    breadth = form * rng.uniform(0.8, 1.15, (len(base), 1, 1)) * size
    t = np.linspace(0, 1, 8)[:, None]
    profile = 1.25 * np.sin(np.pi * t**0.8) * (1 - 0.45 * t)
    bend = rng.normal(0, 0.05, (len(base), 1, 1)) * np.sin(np.pi * t) * size
    across = heading(angle + np.pi / 2)[:, None]
    midrib = base[:, None] + t * size * heading(angle)[:, None] + bend * across
    half = 0.5 * breadth * profile * across
    return np.concatenate([midrib - half, (midrib + half)[:, ::-1]], axis=1), midrib


def _draw_ovate_leaf(canvas: Canvas, outline: Floats, midrib: Floats, paint: Picture) -> None:
    """Draw one leaf: a dark rim, two halves folded along the midrib, and the midrib."""
    base = midrib[0]
    canvas.polygon(outline, paint[EDGE])
    canvas.polygon(base + 0.94 * (outline - base), paint[LIGHT])
    canvas.polygon(base + 0.94 * (np.vstack([midrib, outline[8:]]) - base), paint[DARK])
    canvas.lines(midrib[None, :7], paint[RIB], 0.005)
