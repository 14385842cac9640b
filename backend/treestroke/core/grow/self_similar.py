"""Growth by self-similarity: small branches are copies of the first part of their parent branches.

Depth retrieval from two sketches, section 6 (equation 8, table 1): a branch's first part is copied to one of
its nodes at an angle t with it, and at an angle f with the sibling before. The paper's stated limits are that small
branches spread unevenly and that their number is not controlled; hence these changes:

- Copies are scaled: 0.3 of a stem would be too long, so a copy's length is bounded by a share of the crown's size and
  falls toward the parent branch's tip. Copies bow and rise a little, as twigs do.
- Buds stand closer where the crown is emptier, and of several copies within the ranges the one that reaches the
  emptiest part of the crown is taken. Buds whose copies are all crowded or cut to a stub are removed.
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
"""Small branches of a level per branch of the level before, where there is room."""
SPARE = 1.3
"""Buds tried per small branch."""
TRIED = 8
"""Copies tried per bud."""
LIGHT = 0.03
"""Score of growing straight up, where growing into empty crown scores 1."""
TAPER = (1.4, 0.6)
"""Length of a copy at the parent branch's bud and at its tip, over that of the copied part."""
SCATTER = (0.8, 1.6)
"""Bounds of a random factor on that length."""
BOW = 0.05
"""Standard deviation of a branch's bow, over its length."""
SHORTEST = 0.06
"""Least length of a small branch of the first level, over the crown's size; at most half its parent branch's."""
FILLED, STRETCHED = 1.2, 2.0
"""Distance around a branch that its small branches fill, over their length, and most that they are stretched for it."""
PIECES, MOST_PIECES, LEAST_PIECES = 8, 20, 4
"""Pieces of a small branch at the first level, halved with each level; most pieces; pieces at the last level."""
SLACK = 0.03
"""How much further out than its bud (`CrownVolume.reach`) a small branch may grow on a limb outside the volume."""
GIRTH, TWIG = 0.0175, 0.00028
"""Radius of a stem whose sketch has no width, and of the thinnest twigs, as shares of the tree's height."""

SLENDER = 20.0
"""Length over which a drawn stem tapers at its end, in radii of the brush; otherwise it would end as a club."""


@dataclass(frozen=True)
class SelfSimilarParams:
    """How small branches grow.

    Attributes
    ----------
    share
        Share of the parent branch's points that is copied (the paper's s).
    cos_angle
        Least and greatest cosine of the angle between parent and small branch (cos t1, cos t2).
    cos_turn
        Least and greatest cosine of the angle, about the parent, between a small branch and the next (cos f1, cos f2).
    levels
        Levels of small branches (l).
    most
        Most small branches of all levels.
    longest
        Greatest length of a small branch, over the crown's size (the side of a cube as large).
    spacing
        Least distance of buds on a drawn branch, over the crown's size; halved with each level.
    crowded
        Wood around a small branch, over its even share, above which its bud is removed.
    stub
        Least share of a small branch that must lie in the crown; with less it is removed.
    rise
        How far a tip is raised, over its branch's length.
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
    """Small branches: the node (n,) that each leaves, points (n, m + 1, 3) from there on, and joints kept (n,)."""

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
    """The rules for the small branches of one level.

    ``lengths`` (k,) are those of each parent branch's copies and ``longest`` their upper bound, metres; ``even_share``
    is the wood, metres, that a cell would hold if all were equal.
    """

    lengths: Floats
    longest: float
    even_share: float
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
    their level, lie where the crown is shown (`CrownVolume.shown`). ``report("grow", fraction)`` is called level by
    level. Deterministic.
    """
    skeleton, cells = main.skeleton, crown_cells(volume)
    cells.add_wood(skeleton.points, edge_lengths(skeleton) * volume.shown(skeleton.points))
    points, parents, born = [skeleton.points], [skeleton.parents], [np.zeros(len(main), dtype=np.int64)]
    left, count, branches = params.most, len(main), parents_from_main(main, params.share, _pieces(1, len(main), params))
    for number in range(1, params.levels + 1 if cells.count else 1):
        quota = int(np.ceil(left / (FAN ** np.arange(params.levels - number + 1)).sum()))
        shoots = _grown_level(branches, cells, _Plan(number, quota, params), rng)
        joints = _numbered(shoots, branches, count)
        own = joints[:, 1:] >= 0
        points.append(shoots.points[:, 1:][own])
        parents.append(joints[:, :-1][own])
        born.append(np.full(len(points[-1]), number))
        left, count = left - len(shoots.nodes), count + len(points[-1])
        branches = parents_from_small(shoots.points, joints, params.share, _pieces(number + 1, len(points[-1]), params))
        report("grow", number / params.levels)
    return _finished(np.concatenate(points), np.concatenate(parents), np.concatenate(born), skeleton)


def _pieces(level: int, parent_count: int, params: SelfSimilarParams) -> int:
    """Count the pieces of a level's small branches: fewer where they are small, more where few parents bear many."""
    if level >= params.levels:
        return LEAST_PIECES
    usual = min(parent_count, round(params.most / FAN ** (params.levels - level)))
    return int(np.clip(SPARE * params.most / max(usual, 1), PIECES >> (level - 1), MOST_PIECES))


def _numbered(shoots: _Shoots, branches: ParentBranches, first: int) -> Indices:
    """Assign numbers to joints (n, m + 1) of small branches, from ``first`` on, behind their node's; -1 where cut."""
    joints = np.full((len(shoots.nodes), shoots.points.shape[1]), -1, dtype=np.int64)
    joints[:, 0] = branches.joints[shoots.nodes]
    own = np.arange(1, joints.shape[1]) <= shoots.kept[:, None]
    joints[:, 1:][own] = first + np.arange(np.count_nonzero(own))
    return joints


def _finished(points: Floats, parents: Indices, born: Indices, main: Skeleton) -> Grown:
    """Set the tree's radii: drawn ones stay where they are known, the others follow the pipe model."""
    height = float(np.ptp(points[:, 1]))
    known = np.concatenate([main.radii, np.zeros(len(points) - len(main))])
    known[0] = known[0] if known[0] > 0 else max(GIRTH * height, float(known.max()))
    radii = pipe_radii(points, parents, known, max(TWIG * height, 1e-6), SLENDER)
    return Grown(Skeleton(points, radii, parents), born, np.zeros((0, 3), dtype=np.int64))


def _grown_level(branches: ParentBranches, cells: CrownCells, plan: _Plan, rng: np.random.Generator) -> _Shoots:
    """Let the small branches of a level grow, on all parent branches at a time, each from its tip down."""
    spacing = plan.params.spacing * cells.size * 0.5 ** (plan.number - 1)
    buds = _buds(branches, cells, round(SPARE * plan.most), spacing)
    level = _level_rules(branches, branches.branch[buds], cells, plan)
    rank, before = _ranks(branches.branch[buds]), np.zeros((len(branches.lengths), 3))
    grown, left = [_best(buds[:0], branches, before, level, rng)], plan.most
    for turn in range(int(rank.max(initial=-1)) + 1):
        shoots = _best(buds[rank == turn], branches, before, level, rng).at(slice(left))
        own = np.arange(1, shoots.points.shape[1]) <= shoots.kept[:, None]
        cells.add_wood(shoots.points[:, 1:][own], np.sqrt((np.diff(shoots.points, axis=1) ** 2).sum(axis=2))[own])
        before[branches.branch[shoots.nodes]] = shoots.points[:, -1] - shoots.points[:, 0]
        grown, left = [*grown, shoots], left - len(shoots.nodes)
    return _Shoots(
        *(np.concatenate([getattr(shoots, name) for shoots in grown]) for name in ("nodes", "points", "kept"))
    )


def _level_rules(branches: ParentBranches, branch: Indices, cells: CrownCells, plan: _Plan) -> _Level:
    """Set a level's lengths, longer where branches stand far apart, and the even share of wood in the cells they reach.

    ``branch`` (b,) is that of each bud.
    """
    params = plan.params
    size, copied = cells.size * 0.5 ** (plan.number - 1), params.share * branches.lengths
    apart = np.sqrt(cells.cubic_metres / (np.pi * max(float(branches.weight.sum()), 1e-12)))
    stretch = np.clip(apart / max(FILLED * float(copied[branch].mean()), 1e-12), 1, STRETCHED) if len(branch) else 1.0
    lengths = np.maximum(stretch * copied, np.minimum(SHORTEST * size, copied / params.share / 2))
    longest = params.longest * size
    likely = np.minimum(lengths[branch], longest).sum() / SPARE
    reached = max(1, int((cells.around() > 0).sum()))
    return _Level(lengths, longest, float(cells.wood.sum() + likely) / min(reached, cells.count), cells, params)


def _buds(branches: ParentBranches, cells: CrownCells, count: int, spacing: float) -> Indices:
    """Choose up to ``count`` nodes, closer to each other where the crown is emptier."""
    inside = cells.inside(branches.points, np.inf)
    around = cells.at(branches.points, cells.around())
    weight = branches.weight * inside
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


def _best(nodes: Indices, branches: ParentBranches, before: Floats, level: _Level, rng: np.random.Generator) -> _Shoots:
    """Try copies at each node (b,), take the one that reaches the emptiest part of the crown, and drop poor ones."""
    params, cells, wood = level.params, level.cells, level.cells.around()
    directions = _directions(branches.along[nodes], before[branches.branch[nodes]], params, rng)
    points = _copies(nodes, branches, directions, level, rng)
    own, shape = points[:, :, 1:].reshape(-1, 3), (*points.shape[:2], points.shape[2] - 1)
    reach = np.repeat(cells.volume.reach(branches.points[nodes]) + SLACK, shape[1] * shape[2])
    inside = np.cumprod(cells.inside(own, reach).reshape(shape), axis=2)
    around = cells.at(own, wood).reshape(shape)
    kept = inside.sum(axis=2)
    value = (inside * level.even_share / (level.even_share + around)).mean(axis=2) + LIGHT * directions[..., 1]
    crowd = (inside * around).sum(axis=2) / np.maximum(kept, 1)
    fit = (kept >= params.stub * shape[2]) & (crowd <= params.crowded * level.even_share)
    best = np.argmax(np.where(fit, value, -np.inf), axis=1)
    grows = np.flatnonzero(fit.any(axis=1))
    return _Shoots(nodes[grows], points[grows, best[grows]], kept[grows, best[grows]])


def _directions(along: Floats, before: Floats, params: SelfSimilarParams, rng: np.random.Generator) -> Floats:
    """Draw directions (b, TRIED, 3) at angles t to the parents' (b, 3), and f about them to the sibling before."""
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
    nodes: Indices, branches: ParentBranches, directions: Floats, level: _Level, rng: np.random.Generator
) -> Floats:
    """Copy the parents' first parts to nodes (b,) in directions (b, TRIED, 3): points (b, TRIED, m + 1, 3)."""
    tries, shapes = directions.shape[:2], branches.shapes[branches.branch[nodes]]
    share = np.linspace(0, 1, shapes.shape[1])
    bow, roll = rng.normal(0, BOW, (*tries, 2)), rng.uniform(0, 2 * np.pi, tries)
    side, other = across(directions)
    sides = np.cos(roll)[..., None] * side + np.sin(roll)[..., None] * other
    frame = np.stack([directions, sides, np.cross(directions, sides)], axis=2)
    local = np.broadcast_to(shapes[:, None], (*tries, *shapes.shape[1:])).copy()
    local[..., 1:] += bow[:, :, None] * (4 * share * (1 - share))[:, None]
    taper = TAPER[0] + (TAPER[1] - TAPER[0]) * branches.place[nodes]
    length = (
        level.params.share * (branches.lengths[branches.branch[nodes]] * taper)[:, None] * rng.uniform(*SCATTER, tries)
    )
    way = local @ frame + level.params.rise * (share**2)[:, None] * UP
    return np.asarray(branches.points[nodes][:, None, None] + np.minimum(length, level.longest)[..., None, None] * way)
