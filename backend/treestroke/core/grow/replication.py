"""Hidden branches: replication blocks grow from the visible branches to the points that are their ends.

Tan, Zeng, Wang, Kang and Quan 2007, section 5.2, with these changes: the primary branch of a block leads to the middle
of the points in its cone (in the paper it replaces an end branch of the same length, which no visible branch near the
crown's surface offers); a point near the new wood is served and pulls no more, so that limbs do not crowd; the inside
of the crown counts as points too, fewer, for what no photo shows.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.crown_volume import CrownVolume, Silhouette, shown_by_all
from treestroke.core.geometry.vectors import unit
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.radii import pipe_radii
from treestroke.core.grow.replication_blocks import NO_SHOOT, TURNS, Blocks, replication_blocks
from treestroke.core.progress import Report, silent
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

SAMPLES = 3
"""Joints along a primary branch, and places on an edge by which it serves points."""
END_SPACING, INSIDE_SPACING = 0.02, 0.05
"""Distance between the points that pull, on leaves and inside the crown, as shares of the tree's height."""
FEWEST_IN_CONE, MOST_IN_CONE = 3, 60
"""Points of a cone below which no block is set, and up to which blocks are compared by them."""
PULLED = 0.05
"""Distance from a shoot's end, as a share of the tree's height, within which a point must pull it to grow."""
BEND = 0.4
"""Share of a primary branch's length over which it still follows the branch that it leaves."""
FREE_LENGTH = 0.6
"""Length of the primary branch of a block that no point pulls, relative to its end branch."""
END_JOINTS = 6
"""Joints of a tip's end branch."""


@dataclass(frozen=True)
class ReplicationParams:
    """How hidden branches grow; lengths are shares of the tree's height.

    Attributes
    ----------
    iterations
        Greatest number of blocks that are set; with 0 nothing grows.
    generations
        Greatest number of generations (paper: 7).
    cone_deg
        Angle of an influence cone from side to side, degrees (paper: 90).
    reach
        How far a cone reaches.
    served
        A point pulls no more with wood so near.
    shortest, longest
        Range of the primary branch's length.
    tip
        Radius of the thinnest twigs.
    """

    iterations: int = 300
    generations: int = 7
    cone_deg: float = 90.0
    reach: float = 0.25
    served: float = 0.03
    shortest: float = 0.02
    longest: float = 0.2
    tip: float = 0.0006

    def __post_init__(self) -> None:
        if self.iterations < 0 or self.generations < 1 or not 0 < self.cone_deg <= 180:
            raise ValueError(f"replication needs iterations >= 0, generations >= 1 and a cone of 0 to 180, got {self}")
        if not 0 < self.shortest <= self.longest or min(self.reach, self.served, self.tip) <= 0:
            raise ValueError(f"replication needs positive lengths, the shortest first, got {self}")


@dataclass(frozen=True, eq=False)
class CrownBounds:
    """Where hidden branches may stand, and where they lead.

    Attributes
    ----------
    crown, silhouettes
        The crown, and the tree in all photos.
    leaf_points
        (m, 3) where leaves were measured, metres: near the branches' ends.
    height
        The tree's height, metres.
    """

    crown: CrownVolume
    silhouettes: Sequence[Silhouette[Camera]]
    leaf_points: Floats
    height: float

    def admits(self, places: Floats) -> Mask:
        """Tell which places (n, 3), metres, new wood may stand at: (n,)."""
        admitted = self.crown.admits(places)
        admitted[admitted] = shown_by_all(self.silhouettes, places[admitted])
        return admitted


@dataclass(eq=False)
class _Growing:
    """The tree so far, the points (m, 3) that pull, and which still do (m,)."""

    points: list[Floats]
    parents: list[int]
    born: list[int]
    ends: Floats
    waiting: Mask
    choices: list[tuple[int, int, int]] = field(default_factory=list)

    def add(self, parent: int, line: Floats, generation: int) -> list[int]:
        """Add joints along a line (m, 3), metres: their numbers."""
        numbers = list(range(len(self.points), len(self.points) + len(line)))
        self.points += list(line)
        self.parents += [parent, *numbers[:-1]]
        self.born += [generation] * len(line)
        return numbers

    def serve(self, first: int, near: float) -> None:
        """Let the wood of the joints from ``first`` on serve the points so near, metres."""
        left = np.flatnonzero(self.waiting)
        if len(left) == 0 or first >= len(self.points):
            return
        tips, parents = np.array(self.points[first:]), np.maximum(self.parents[first:], 0)
        starts = np.array([self.points[parent] for parent in parents.tolist()])
        shares = np.arange(SAMPLES + 1)[:, None, None] / SAMPLES
        wood = (starts + shares * (tips - starts)).reshape(-1, 3)
        self.waiting[left[cKDTree(wood).query(self.ends[left])[0] <= near]] = False


def grow_hidden(
    skeleton: Skeleton,
    bounds: CrownBounds,
    params: ReplicationParams,
    rng: np.random.Generator,
    report: Report = silent,
) -> Grown:
    """Grow the branches that leaves hide, from the visible ones (3D, metres, measured radii), which stay.

    New wood stands where the
    crown admits it and all silhouettes show it. ``report("grow", fraction)`` is called with each generation.

    Source: Tan et al. 2007, section 5.2; the module's head says where we differ.
    """
    ends = _ends(bounds)
    visible = list(skeleton.points), skeleton.parents.tolist(), [0] * len(skeleton)
    growing = _Growing(*visible, ends, np.ones(len(ends), dtype=np.bool_))
    growing.serve(0, params.served * bounds.height)
    setting = _Setting(growing, replication_blocks(skeleton), bounds, params)
    for generation in range(1, params.generations + 1):
        report("grow", (generation - 1) / params.generations)
        _grow_generation(setting, generation, rng)
    report("grow", 1.0)
    points, parents = np.array(growing.points), np.array(growing.parents, dtype=np.int64)
    measured = np.concatenate([skeleton.radii, np.zeros(len(points) - len(skeleton))])
    radii = pipe_radii(points, parents, measured, params.tip * bounds.height)
    choices = np.array(growing.choices, dtype=np.int64).reshape(-1, 3)
    return Grown(Skeleton(points, radii, parents), np.array(growing.born, dtype=np.int64), choices, _reached(growing))


@dataclass(frozen=True, eq=False)
class _Setting:
    """What the setting of a block needs."""

    growing: _Growing
    blocks: Blocks
    bounds: CrownBounds
    params: ReplicationParams


class _Placement(NamedTuple):
    """A joint, the block that is set there (with its turn), and which of its shoots (k,) grow."""

    node: int
    block: int
    shoots: Mask


def _reached(growing: _Growing) -> float:
    """Return the share of the points that wood serves; 0 without points."""
    return float(1 - growing.waiting.mean()) if len(growing.waiting) else 0.0


def _ends(bounds: CrownBounds) -> Floats:
    """Choose points (m, 3), metres, that stand for branch ends: on leaves, and, fewer, inside the crown."""
    low, high = bounds.crown.bounds
    leaf_points = bounds.leaf_points
    spacing = INSIDE_SPACING * bounds.height
    axes = [np.arange(start + spacing / 2, end, spacing) for start, end in zip(low, high, strict=True)]
    inside = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = np.floor(leaf_points / (END_SPACING * bounds.height)).astype(np.int64)
    first = np.unique(cells, axis=0, return_index=True)[1] if len(cells) else np.zeros(0, dtype=np.int64)
    points = np.concatenate([leaf_points[np.sort(first)], inside[bounds.crown.inside(inside)]])
    return points[bounds.admits(points)]


def _grow_generation(setting: _Setting, generation: int, rng: np.random.Generator) -> None:
    """Set a block on each node that points pull, those with most points first; in the first, a random one on bare tips.

    The cones are those at the start of the generation.
    """
    growing, params = setting.growing, setting.params
    nodes, axes, tips = _nodes(growing, generation)
    cones, pulled = _cones(setting, nodes, axes)
    free = tips & ~np.isin(np.arange(len(nodes)), pulled) & (generation == 1)
    for row in np.argsort([-len(cone) for cone in cones], kind="stable").tolist():
        if len(growing.choices) >= params.iterations:
            return
        first, pulls = len(growing.points), cones[row][growing.waiting[cones[row]]]
        if len(pulls) >= FEWEST_IN_CONE:
            _set_constrained(setting, int(nodes[row]), axes[row], pulls, generation)
        elif free[row]:
            _set_freely(setting, int(nodes[row]), axes[row], rng)
        growing.serve(first, params.served * setting.bounds.height)


def _nodes(growing: _Growing, generation: int) -> tuple[Indices, Floats, Mask]:
    """Return the joints (k,) that may bear a block, unit vectors (k, 3) along their branches, and which are tips (k,).

    In the first generation these are all visible joints above the first fork, later the joints of the last generation.
    """
    points, parents, born = np.array(growing.points), np.array(growing.parents), np.array(growing.born)
    children = np.bincount(parents[parents >= 0], minlength=len(points))
    forks = points[children > 1, 1]
    above = points[:, 1] >= (forks.min() if len(forks) else points[:, 1].max())
    nodes = np.flatnonzero((parents >= 0) & (born == generation - 1) & above)
    return nodes, unit(points[nodes] - points[parents[nodes]]), children[nodes] == 0


def _cones(setting: _Setting, nodes: Indices, axes: Floats) -> tuple[list[Indices], Indices]:
    """List the waiting points that each node (k,) answers for, and the nodes (m,) whose cones hold any, repeated.

    A cone is about the node's axis (k, 3); of the nodes whose cones hold a point the nearest answers for it.
    """
    growing, least = setting.growing, np.cos(np.radians(setting.params.cone_deg / 2))
    left = np.flatnonzero(growing.waiting)
    if len(left) == 0 or len(nodes) == 0:
        return [left[:0]] * len(nodes), left[:0]
    starts = np.array(growing.points)[nodes]
    near = cKDTree(growing.ends[left]).query_ball_point(starts, setting.params.reach * setting.bounds.height)
    owner = np.repeat(np.arange(len(nodes)), [len(members) for members in near])
    members = left[np.concatenate(near).astype(np.int64)]
    away = growing.ends[members] - starts[owner]
    within = np.flatnonzero((unit(away) * axes[owner]).sum(axis=1) >= least)
    order = within[np.lexsort((owner[within], np.linalg.norm(away[within], axis=1), members[within]))]
    nearest = order[np.unique(members[order], return_index=True)[1]]
    nearest = nearest[np.argsort(owner[nearest], kind="stable")]
    return np.split(members[nearest], np.searchsorted(owner[nearest], np.arange(1, len(nodes)))), owner[within]


def _set_constrained(setting: _Setting, node: int, along: Floats, pulls: Indices, generation: int) -> None:
    """Set the block on a node whose ends come nearest to the points (m,) in its cone."""
    start, params, height = setting.growing.points[node], setting.params, setting.bounds.height
    cone = setting.growing.ends[pulls[:: len(pulls) // MOST_IN_CONE + 1]]
    away = np.linalg.norm(cone - start, axis=1)
    length = float(np.clip(np.median(away), params.shortest * height, params.longest * height))
    axis = length * unit(unit(cone - start).mean(axis=0), otherwise=along)
    ends = setting.blocks.placed(start, axis)[1]
    allowed = (setting.blocks.parents > NO_SHOOT) & setting.bounds.admits(ends.reshape(-1, 3)).reshape(ends.shape[:2])
    distance = cdist(ends.reshape(-1, 3), cone).reshape(*ends.shape[:2], len(cone))
    distance[~allowed] = np.inf
    reach = np.minimum(distance.min(axis=1), np.linalg.norm(start + axis - cone, axis=1))
    best = int(reach.sum(axis=1).argmin())
    pulled = distance[best].min(axis=1) <= PULLED * height
    _add(setting, _Placement(node, best, pulled), _bent(start, along, axis), generation)


def _set_freely(setting: _Setting, node: int, along: Floats, rng: np.random.Generator) -> None:
    """Set a random block at a random turn on a tip that no point pulls, as long as its end branch."""
    path, growing = [node], setting.growing
    while len(path) < END_JOINTS and growing.parents[path[-1]] >= 0:
        path.append(growing.parents[path[-1]])
    length = FREE_LENGTH * float(np.linalg.norm(growing.points[node] - growing.points[path[-1]]))
    block = int(rng.integers(len(setting.blocks.parents)))
    if length > 0:
        every = np.ones(setting.blocks.parents.shape[1], dtype=np.bool_)
        _add(setting, _Placement(node, block, every), _bent(growing.points[node], along, length * along), 1)


def _bent(start: Floats, along: Floats, axis: Floats) -> Floats:
    """Return joints (m, 3), metres, of a primary branch that leaves along a unit vector and ends at the axis' end."""
    share = np.arange(1, SAMPLES + 1)[:, None] / SAMPLES
    middle = BEND * float(np.linalg.norm(axis)) * along
    return np.asarray(start + 2 * share * (1 - share) * middle + share**2 * axis)


def _add(setting: _Setting, placement: _Placement, line: Floats, generation: int) -> None:
    """Add a primary branch (m, 3), metres, on a node, and the shoots of a block, each as far as the crown admits it."""
    (node, block, pulled), growing, blocks = placement, setting.growing, setting.blocks
    line = line[: _admitted(setting.bounds, line)]
    if len(line) == 0:
        return
    primary = growing.add(node, line, generation)
    growing.choices.append((node, block // TURNS, block % TURNS))
    start, joints = growing.points[node], dict[int, list[int]]({-1: primary})
    bases, ends = blocks.placed(start, line[-1] - start)
    for shoot in np.flatnonzero(pulled & (blocks.parents[block] > NO_SHOOT)).tolist():
        own = joints.get(int(blocks.parents[block, shoot]), [])
        if own:
            seat = min(own, key=lambda joint: float(np.linalg.norm(growing.points[joint] - bases[block, shoot])))
            shoot_line = growing.points[seat] + np.array([[0.5], [1.0]]) * (ends[block, shoot] - bases[block, shoot])
            count = _admitted(setting.bounds, shoot_line)
            joints[shoot] = growing.add(seat, shoot_line[:count], generation) if count else []


def _admitted(bounds: CrownBounds, line: Floats) -> int:
    """Count the first joints of a line (m, 3), metres, that the crown admits."""
    admitted = bounds.admits(line)
    return len(line) if admitted.all() else int(admitted.argmin())
