"""Growth by self-similarity: small branches are copies of the first part of those that bear them.

Depth retrieval from two sketches, section 6 (equation 8, table 1): a branch's first part is copied to one of
its nodes at an angle t with it, and at an angle f with the sibling before. The paper names as its limits that small
branches spread unevenly and that nothing rules their number; so, with these changes:

- Copies are scaled: 0.3 of a stem would be a giant, so that a copy is never longer than a share of the crown, and
  shorter toward its bearer's tip. They bow and rise a little, as twigs do.
- Buds stand the closer, the emptier the crown is around them, and of several copies within the ranges each takes the
  one that reaches the emptiest part of the crown. Buds whose every copy is crowded or cut to a stub are removed.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.grow.crown_cells import CrownCells, crown_cells
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.parent_branches import ParentBranches, across, parents_from_main, parents_from_small
from treestroke.core.grow.radii import pipe_radii
from treestroke.core.progress import Report, silent
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices

FAN = 5.0
"""Small branches of a level for each of the level before, where all find room."""
SPARE = 1.3
"""Buds tried for each small branch that is wanted."""
TRIED = 8
"""Copies tried for each bud."""
LIGHT = 0.03
"""Worth of growing straight up, where growing into empty crown is worth 1."""
TAPER = (1.4, 0.6)
"""Length at the bearer's bud and at its tip, over that of the copied part."""
SCATTER = (0.8, 1.6)
"""Random factor on it."""
BOW = 0.05
"""Standard deviation of a branch's bow, over its length."""
SHORTEST = 0.06
"""Least length of a small branch of the first level, over the crown's size, unless that is half its bearer's."""
FILLED, STRETCHED = 1.2, 2.0
"""How far about a branch its small ones fill the crown, over their length, and how far they are stretched to do so."""
PIECES, MOST_PIECES, LEAST_PIECES = 8, 20, 4
"""Pieces of a small branch of the first level, halved with each further one; most; and those of the last level."""
SLACK = 0.03
"""How much further out than its bud a small branch may reach where a limb was drawn beyond the crown's solid."""
GIRTH, TWIG = 0.0175, 0.00028
"""Radius of a stem whose sketch has no width, and of the thinnest twigs, as shares of the tree's height."""

SLENDER = 20.0
"""Radii of a brush over which its stroke's end gets thin: a brush as broad at its end as before would leave a club."""


@dataclass(frozen=True)
class SelfSimilarParams:
    """How small branches grow.

    Attributes
    ----------
    share
        Part of the bearer's points that is copied (the paper's s).
    cos_angle
        Least and greatest cosine of the angle between bearer and small branch (cos t1, cos t2).
    cos_turn
        Least and greatest cosine of the angle, about the bearer, between a small branch and the next (cos f1, cos f2).
    levels
        Levels of small branches (l).
    most
        Small branches in all, where there is room.
    longest
        Greatest length of a small branch, over the crown's size (the side of a cube as large).
    spacing
        Least distance of buds on a drawn branch, over the crown's size; halved with each level.
    crowded
        Wood around a small branch, over its fair share, from which on its bud is removed.
    stub
        Share of a small branch that must lie in the crown, else it is none.
    rise
        How far a tip rises, over its branch's length.
    """

    share: float = 0.3
    cos_angle: tuple[float, float] = (0.5, 0.9)
    cos_turn: tuple[float, float] = (-0.5, 0.5)
    levels: int = 2
    most: int = 2000
    longest: float = 0.25
    spacing: float = 0.012
    crowded: float = 2.0
    stub: float = 0.4
    rise: float = 0.12

    def __post_init__(self) -> None:
        if not 0 < self.share <= 1 or not 0 < self.stub <= 1:
            raise ValueError(f"shares must be over 0, at most 1, got {self.share} and {self.stub}")
        if not all(-1 <= low <= high <= 1 for low, high in (self.cos_angle, self.cos_turn)):
            raise ValueError(f"cosines must be -1 to 1, the smaller first, got {self.cos_angle} and {self.cos_turn}")
        if self.levels < 0 or self.most < 0 or min(self.longest, self.spacing, self.crowded) <= 0 or self.rise < 0:
            raise ValueError(f"numbers must not be negative and sizes over 0, got {self}")


@dataclass(frozen=True, eq=False)
class _Shoots:
    """Small branches: the bearers' node (n,) of each, points (n, m + 1, 3) from there on, and joints kept (n,)."""

    nodes: Indices
    points: Floats
    kept: Indices

    def at(self, index: Indices | slice) -> "_Shoots":
        return _Shoots(self.nodes[index], self.points[index], self.kept[index])


@dataclass(frozen=True)
class _Plan:
    """A level's number, from 1, and how many small branches it may have at most."""

    number: int
    most: int
    params: SelfSimilarParams


@dataclass(frozen=True, eq=False)
class _Level:
    """What small branches of one level follow.

    ``lengths`` (k,) are those of each parent branch's copies and ``longest`` their upper bound, metres; ``fair`` is the
    wood, metres, that a cell would hold if all were equal.
    """

    lengths: Floats
    longest: float
    fair: float
    cells: CrownCells
    params: SelfSimilarParams


def grow_small(
    main: Branched,
    volume: CrownVolume,
    params: SelfSimilarParams,
    rng: np.random.Generator,
    report: Report = silent,
) -> Grown:
    """Fill the crown of a 3D tree (metres; radius 0 where unknown) with small branches.

    The joints of ``main`` come first, in their order and where they were, born 0; those of small branches, born at
    their level, lie in both views. ``report("grow", fraction)`` is called level by level. Deterministic.
    """
    skeleton, cells = main.skeleton, crown_cells(volume)
    cells.lay(skeleton.points, edge_lengths(skeleton) * volume.shown(skeleton.points))
    points, parents, born = [skeleton.points], [skeleton.parents], [np.zeros(len(main), dtype=np.int64)]
    left, count, bearers = params.most, len(main), parents_from_main(main, params.share, _pieces(1, len(main), params))
    for number in range(1, params.levels + 1 if cells.count else 1):
        quota = int(np.ceil(left / (FAN ** np.arange(params.levels - number + 1)).sum()))
        shoots = _sprouted(bearers, cells, _Plan(number, quota, params), rng)
        joints = _numbered(shoots, bearers, count)
        own = joints[:, 1:] >= 0
        points.append(shoots.points[:, 1:][own])
        parents.append(joints[:, :-1][own])
        born.append(np.full(len(points[-1]), number))
        left, count = left - len(shoots.nodes), count + len(points[-1])
        bearers = parents_from_small(shoots.points, joints, params.share, _pieces(number + 1, len(points[-1]), params))
        report("grow", number / params.levels)
    return _finished(np.concatenate(points), np.concatenate(parents), np.concatenate(born), skeleton)


def _pieces(level: int, bearing: int, params: SelfSimilarParams) -> int:
    """Count the pieces of a level's small branches: fewer where they are small, more where few are to bear many."""
    if level >= params.levels:
        return LEAST_PIECES
    usual = min(bearing, round(params.most / FAN ** (params.levels - level)))
    return int(np.clip(SPARE * params.most / max(usual, 1), PIECES >> (level - 1), MOST_PIECES))


def _numbered(shoots: _Shoots, bearers: ParentBranches, first: int) -> Indices:
    """Give numbers to joints (n, m + 1) of small branches, from ``first`` on, behind their node's; -1 where cut."""
    joints = np.full((len(shoots.nodes), shoots.points.shape[1]), -1, dtype=np.int64)
    joints[:, 0] = bearers.joints[shoots.nodes]
    own = np.arange(1, joints.shape[1]) <= shoots.kept[:, None]
    joints[:, 1:][own] = first + np.arange(np.count_nonzero(own))
    return joints


def _finished(points: Floats, parents: Indices, born: Indices, main: Skeleton) -> Grown:
    """Give the tree its radii: drawn ones stay where they are known, the rest carries its twigs (da Vinci)."""
    height = float(np.ptp(points[:, 1]))
    known = np.concatenate([main.radii, np.zeros(len(points) - len(main))])
    known[0] = known[0] if known[0] > 0 else max(GIRTH * height, float(known.max()))
    radii = pipe_radii(points, parents, known, max(TWIG * height, 1e-6), SLENDER)
    return Grown(Skeleton(points, radii, parents), born, np.zeros((0, 3), dtype=np.int64))


def _sprouted(bearers: ParentBranches, cells: CrownCells, plan: _Plan, rng: np.random.Generator) -> _Shoots:
    """Let the small branches of a level grow, on all parent branches at a time, each from its tip down."""
    spacing = plan.params.spacing * cells.size * 0.5 ** (plan.number - 1)
    buds = _buds(bearers, cells, round(SPARE * plan.most), spacing)
    level = _ruled(bearers, bearers.branch[buds], cells, plan)
    rank, before = _ranks(bearers.branch[buds]), np.zeros((len(bearers.lengths), 3))
    grown, left = [_best(buds[:0], bearers, before, level, rng)], plan.most
    for turn in range(int(rank.max(initial=-1)) + 1):
        shoots = _best(buds[rank == turn], bearers, before, level, rng).at(slice(left))
        own = np.arange(1, shoots.points.shape[1]) <= shoots.kept[:, None]
        cells.lay(shoots.points[:, 1:][own], np.sqrt((np.diff(shoots.points, axis=1) ** 2).sum(axis=2))[own])
        before[bearers.branch[shoots.nodes]] = shoots.points[:, -1] - shoots.points[:, 0]
        grown, left = [*grown, shoots], left - len(shoots.nodes)
    return _Shoots(*(np.concatenate([getattr(one, name) for one in grown]) for name in ("nodes", "points", "kept")))


def _ruled(bearers: ParentBranches, branch: Indices, cells: CrownCells, plan: _Plan) -> _Level:
    """Set the lengths of a level, longer where branches stand far apart, and what wood is fair in the cells they reach.

    ``branch`` (b,) is that of each bud.
    """
    params = plan.params
    size, copied = cells.size * 0.5 ** (plan.number - 1), params.share * bearers.lengths
    apart = np.sqrt(cells.cubic_metres / (np.pi * max(float(bearers.weight.sum()), 1e-12)))
    stretch = np.clip(apart / max(FILLED * float(copied[branch].mean()), 1e-12), 1, STRETCHED) if len(branch) else 1.0
    lengths = np.maximum(stretch * copied, np.minimum(SHORTEST * size, copied / params.share / 2))
    longest = params.longest * size
    likely = np.minimum(lengths[branch], longest).sum() / SPARE
    reached = max(1, int((cells.around() > 0).sum()))
    return _Level(lengths, longest, float(cells.wood.sum() + likely) / min(reached, cells.count), cells, params)


def _buds(bearers: ParentBranches, cells: CrownCells, count: int, spacing: float) -> Indices:
    """Choose up to so many nodes, the closer to each other the emptier the crown is around them."""
    inside = cells.inside(bearers.points, np.inf)
    around = cells.at(bearers.points, cells.around())
    weight = bearers.weight * inside
    total = float(weight.sum())
    if total <= 0 or count <= 0:
        return np.zeros(0, dtype=np.int64)
    mean = float((weight * around).sum()) / total
    ends = np.cumsum(weight * mean / (mean + around))
    count = min(count, max(1, int(total / spacing)))
    return np.unique(np.searchsorted(ends, (np.arange(count) + 0.5) * ends[-1] / count))


def _ranks(branch: Indices) -> Indices:
    """Count, for each of the nodes in order (n,), those behind it on the same branch."""
    last = np.append(np.flatnonzero(np.diff(branch)), len(branch) - 1)
    return np.asarray(last[np.searchsorted(last, np.arange(len(branch)))] - np.arange(len(branch)))


def _best(nodes: Indices, bearers: ParentBranches, before: Floats, level: _Level, rng: np.random.Generator) -> _Shoots:
    """Try copies at each node (b,), take the one that reaches the emptiest part of the crown, and drop poor ones."""
    params, cells, wood = level.params, level.cells, level.cells.around()
    directions = _directions(bearers.along[nodes], before[bearers.branch[nodes]], params, rng)
    points = _copies(nodes, bearers, directions, level, rng)
    own, shape = points[:, :, 1:].reshape(-1, 3), (*points.shape[:2], points.shape[2] - 1)
    reach = np.repeat(cells.volume.reach(bearers.points[nodes]) + SLACK, shape[1] * shape[2])
    inside = np.cumprod(cells.inside(own, reach).reshape(shape), axis=2)
    around = cells.at(own, wood).reshape(shape)
    kept = inside.sum(axis=2)
    worth = (inside * level.fair / (level.fair + around)).mean(axis=2) + LIGHT * directions[..., 1]
    crowd = (inside * around).sum(axis=2) / np.maximum(kept, 1)
    fit = (kept >= params.stub * shape[2]) & (crowd <= params.crowded * level.fair)
    best = np.argmax(np.where(fit, worth, -np.inf), axis=1)
    grows = np.flatnonzero(fit.any(axis=1))
    return _Shoots(nodes[grows], points[grows, best[grows]], kept[grows, best[grows]])


def _directions(along: Floats, before: Floats, params: SelfSimilarParams, rng: np.random.Generator) -> Floats:
    """Draw directions (b, TRIED, 3) at the angles t to the bearers' (b, 3), and f about them to the sibling before."""
    b = len(along)
    cos_t, cos_f = rng.uniform(*params.cos_angle, (b, TRIED)), rng.uniform(*params.cos_turn, (b, TRIED))
    turn = np.where(rng.random((b, TRIED)) < 0.5, 1.0, -1.0) * np.arccos(cos_f)
    square = before - (before * along).sum(axis=1, keepdims=True) * along
    first = (square**2).sum(axis=1) < 1e-12
    turn[first] = rng.uniform(0, 2 * np.pi, (b, TRIED))[first]
    side = unit(np.where(first[:, None], across(along)[0], square))
    other = np.cross(along, side)
    out = np.cos(turn)[..., None] * side[:, None] + np.sin(turn)[..., None] * other[:, None]
    return np.asarray(cos_t[..., None] * along[:, None] + np.sqrt(1 - cos_t**2)[..., None] * out)


def _copies(
    nodes: Indices, bearers: ParentBranches, directions: Floats, level: _Level, rng: np.random.Generator
) -> Floats:
    """Copy the bearers' first parts to nodes (b,) in directions (b, TRIED, 3): points (b, TRIED, m + 1, 3)."""
    tries, shapes = directions.shape[:2], bearers.shapes[bearers.branch[nodes]]
    share = np.linspace(0, 1, shapes.shape[1])
    bow, roll = rng.normal(0, BOW, (*tries, 2)), rng.uniform(0, 2 * np.pi, tries)
    side, other = across(directions)
    sides = np.cos(roll)[..., None] * side + np.sin(roll)[..., None] * other
    frame = np.stack([directions, sides, np.cross(directions, sides)], axis=2)
    local = np.broadcast_to(shapes[:, None], (*tries, *shapes.shape[1:])).copy()
    local[..., 1:] += bow[:, :, None] * (4 * share * (1 - share))[:, None]
    taper = TAPER[0] + (TAPER[1] - TAPER[0]) * bearers.place[nodes]
    length = (
        level.params.share * (bearers.lengths[bearers.branch[nodes]] * taper)[:, None] * rng.uniform(*SCATTER, tries)
    )
    way = local @ frame + level.params.rise * (share**2)[:, None] * UP
    return np.asarray(bearers.points[nodes][:, None, None] + np.minimum(length, level.longest)[..., None, None] * way)
