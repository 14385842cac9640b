"""Pairs of aligned paths, one in each sketch, and the trie that joins them to one tree."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from treestroke.core.geometry.polyline import arc_lengths
from treestroke.core.lift.alignment import align_heights
from treestroke.core.lift.sketch_tree import SketchTree
from treestroke.core.types import Floats, Indices, Mask

EVEN = 4.0
"""Height difference, units, up to which a joint lies midway between its two points; both are then within 2 units."""
KEPT, GIVEN_UP = 6.0, 12.0
"""Height difference, units, up to which a joint keeps 2 units from the point that moves, toward the other, so that
both sketches' strokes are near; and from which on the joint has the height of the moving point."""
SLACK = 1.5
"""Units by which a limb may be thinner than the wider of its two strokes before that stroke would show uncovered."""


@dataclass(frozen=True, eq=False)
class PathPair:
    """Two aligned paths: the leader's and the follower's joint and position at each of n points.

    Attributes
    ----------
    joints
        (2, n) joint indices in the leader's and the follower's sketch.
    places
        (2, n, 3) x, y and radius of each, units.
    switching
        (n,) mask of the points where the follower moves from one branch to another and is not at its joint.
    """

    joints: Indices
    places: Floats
    switching: Mask

    def __len__(self) -> int:
        return len(self.switching)

    @cached_property
    def apart(self) -> Floats:
        """Height of the leader above the follower (n,); unit: 1/1000 of the tree's height."""
        return np.asarray(self.places[0, :, 1] - self.places[1, :, 1])

    def cut(self, start: int, end: int) -> "PathPair":
        """Return the points from index ``start`` to before ``end``."""
        return PathPair(self.joints[:, start:end], self.places[:, start:end], self.switching[start:end])

    @cached_property
    def steps(self) -> Floats:
        """Step in x and y of leader and follower to each point (2, n, 2), first 0; unit: 1/1000 of the height."""
        steps = np.zeros((2, len(self.apart), 2))
        steps[:, 1:] = self.places[:, 1:, :2] - self.places[:, :-1, :2]
        return steps

    @cached_property
    def uneven_runs(self) -> Indices:
        """Bounds (k, 2) of the runs of points at unequal heights: index of the first, and of the one after the last."""
        off = np.zeros(len(self.apart) + 2, dtype=bool)
        off[1:-1] = np.abs(self.apart) > EVEN
        return np.flatnonzero(off[1:] != off[:-1]).reshape(-1, 2)

    @cached_property
    def leader_height(self) -> Mask:
        """Mask (n,) of the points that take the leader's height: in an uneven run, that of the path that moves more."""
        climbs = np.abs(self.steps[:, :, 1])
        from_leader = np.ones(len(self.apart), dtype=bool)
        for start, end in self.uneven_runs.tolist():
            from_leader[start:end] = climbs[0, start:end].sum() >= climbs[1, start:end].sum()
        return from_leader

    @cached_property
    def unsupported(self) -> Floats:
        """Length (2, n), units, before each point that the leader's and the follower's sketch do not show."""
        off, from_leader, steps = np.abs(self.apart) > 2 * EVEN, self.leader_height, self.steps
        unseen = np.stack([off & ~from_leader, off & from_leader | self.switching])
        projected = [np.hypot(steps[0, :, 0], steps[1, :, 1]), np.hypot(steps[1, :, 0], steps[0, :, 1])]
        return np.where(unseen, projected, 0.0)

    def lengths(self) -> Floats:
        """Return the 3D length before each point (n,); unit: 1/1000 of the tree's height."""
        steps = self.steps
        return np.asarray(np.sqrt(steps[0, :, 0] ** 2 + steps[1, :, 0] ** 2 + steps[0, :, 1] ** 2))


def align_paths(
    sketches: tuple[SketchTree, SketchTree], leader: Indices, follower: Indices, start: int = 0
) -> PathPair:
    """Align two paths (n,), (m,) of joint indices, one in each sketch, the follower's from its index ``start`` on.

    Positions are in sketch units. Source: two-sketches paper, section 5.1, equations 4 to 6; where ours differs:
    `alignment`.
    """
    paths = [sketch.points[path] for sketch, path in zip(sketches, (leader, follower), strict=True)]
    leading, following = (np.column_stack([points[:, 1], arc_lengths(points)]) for points in paths)
    places, whole = _every_joint(align_heights(leading, following, start))
    shapes = [
        np.column_stack([points, sketch.radii[path]])
        for points, sketch, path in zip(paths, sketches, (leader, follower), strict=True)
    ]
    leading = _between(shapes[0], places)
    following = _between(shapes[1], _levelled(shapes[1][:, 1], whole, leading[:, 1]))
    joints = np.stack([leader[np.round(places).astype(np.int64)], follower[whole]])
    return PathPair(joints, np.stack([leading, following]), np.zeros(len(whole), dtype=bool))


def _every_joint(at: Indices) -> tuple[Floats, Indices]:
    """Spread the follower's jumps (n,) over all its joints; return both paths' fractional and whole indices (m,)."""
    steps = np.diff(at)
    pieces = np.maximum(np.abs(steps), 1)
    order = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces) + 1
    start = np.repeat(np.arange(len(steps)), pieces)
    leader = start + order / pieces[start]
    follower = at[start] + np.sign(steps)[start] * order
    return np.append(0.0, leader), np.append(at[:1], follower).astype(np.int64)


def _levelled(heights: Floats, whole: Indices, wanted: Floats) -> Floats:
    """Move the follower from joints to fractional indices (n,) beside them where it is as high as the leader."""
    missing = wanted - heights[whole]
    ahead = heights[np.minimum(whole + 1, len(heights) - 1)] - heights[whole]
    back = heights[np.maximum(whole - 1, 0)] - heights[whole]
    # Level pieces gain no height however far one goes: the 1 keeps the follower where it is there.
    moves = [np.clip(missing * rise / (rise * rise + 1.0), 0.0, 1.0) for rise in (ahead, back)]
    go_ahead = np.abs(missing - moves[0] * ahead) <= np.abs(missing - moves[1] * back)
    return np.asarray(whole + np.where(go_ahead, moves[0], -moves[1]))


def _between(shape: Floats, places: Floats) -> Floats:
    """Interpolate a path (m, k) at fractional indices (n,)."""
    before = np.minimum(places.astype(np.int64), len(shape) - 1)
    after = np.minimum(before + 1, len(shape) - 1)
    return np.asarray(shape[before] + (places - before)[:, None] * (shape[after] - shape[before]))


@dataclass(eq=False)
class PathTrie:
    """The 3D tree under construction: a trie of path pairs, which share joints up to where one of their paths differs.

    Attributes
    ----------
    sketches
        Front and side; sketch 0 and 1 below.
    alignments
        Cache of alignments by leader, both paths and the follower's start; tries of the same sketches may share it.
    points, joints, parents, origins, pair_number
        By joint: x, y, z and radius, units; joint index in each sketch; parent; origin; number of its path pair.
    joint_at, partners
        Joint by its joints in both sketches; by joint of a sketch, those of the other that are paired with it.
    tips
        By limb: distance right of the stem in the front, height, and distance right of the stem in the side, units.
    projected, unsupported
        By sketch: length that the tree projects to, and the part of it that the sketch does not show, units.
    used
        By sketch: mask of the joints that some joint of the tree represents.
    """

    sketches: tuple[SketchTree, SketchTree]
    alignments: dict[tuple[int, bytes, bytes, int], PathPair] = field(default_factory=dict)
    points: list[Floats] = field(default_factory=list)
    joints: list[tuple[int, int]] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    origins: list[int] = field(default_factory=list)
    pair_number: list[int] = field(default_factory=list)
    joint_at: dict[tuple[int, int], int] = field(default_factory=dict)
    partners: tuple[dict[int, list[int]], dict[int, list[int]]] = field(default_factory=lambda: ({}, {}))
    tips: list[tuple[float, float, float]] = field(default_factory=list)
    projected: list[float] = field(default_factory=lambda: [0.0, 0.0])
    unsupported: list[float] = field(default_factory=lambda: [0.0, 0.0])
    used: tuple[Mask, Mask] = field(init=False)

    def __post_init__(self) -> None:
        front, side = (np.zeros(len(sketch.points), dtype=bool) for sketch in self.sketches)
        self.used = front, side

    def led_by(self, leader: int) -> tuple[SketchTree, SketchTree]:
        """Return the leader's and the follower's sketch."""
        return self.sketches[leader], self.sketches[1 - leader]

    def last_shared(self, leader: int, leading: Indices, following: Indices) -> tuple[int, int]:
        """Find the last indices on two paths (n,), (m,) of joint indices that one joint of the tree represents."""
        index_of = dict(zip(following.tolist(), range(len(following)), strict=True))
        for i, joint in reversed(list(enumerate(leading.tolist()))):
            found = [index_of[j] for j in self.partners[leader].get(joint, ()) if j in index_of]
            if found:
                return i, max(found)
        return 0, 0

    def last_partner(self, leader: int, leading: Indices) -> tuple[int, int]:
        """Find the last index on a path (n,) of joint indices with a partner, and the partner's joint index."""
        for i in range(len(leading) - 1, -1, -1):
            others = self.partners[leader].get(int(leading[i]))
            if others:
                return i, others[0]
        return 0, 0

    def branching(self, leader: int, pair: PathPair) -> tuple[int, int]:
        """Find where a path pair leaves the tree for good: its first new point, and that point's parent (-1: none)."""
        leading, following = pair.joints
        first, second = self.led_by(leader)
        before = first.parents[leading], second.parents[following]
        points = zip(*(each[::-1].tolist() for each in (leading, following, *before)), strict=True)
        for remaining, (a, b, below_a, below_b) in enumerate(points):
            for shared in ((a, b), (a, below_b), (below_a, b)):
                joint = self.joint_at.get(shared if leader == 0 else shared[::-1], -1)
                if joint >= 0:
                    return len(pair) - remaining, joint
        return 0, -1

    def insert(self, leader: int, pair: PathPair, origins: Indices) -> None:
        """Add the part of a path pair that is new; ``origins`` (n,) are the origin flags of its points.

        It leaves the tree where either path does. Source: two-sketches paper, section 5.2 (extension).
        """
        first, parent = self.branching(leader, pair)
        new = pair.cut(first, len(pair))
        points = self._placed(leader, new)
        number = self.pair_number[-1] + 1 if self.pair_number else 0
        self._mark(leader, new)
        for i, (a, b) in enumerate(new.joints.T.tolist()):
            joints = (a, b) if leader == 0 else (b, a)
            if not new.switching[i]:
                self.joint_at.setdefault(joints, len(self.points))
                self.partners[0].setdefault(joints[0], []).append(joints[1])
                self.partners[1].setdefault(joints[1], []).append(joints[0])
            self.parents.append(parent if i == 0 else len(self.points) - 1)
            self.points.append(points[i])
            self.joints.append(joints)
            self.origins.append(int(origins[first + i]))
            self.pair_number.append(number)
        if number > 0 and len(new):
            front, side = (sketch.aside[joint] for sketch, joint in zip(self.sketches, self.joints[-1], strict=True))
            self.tips.append((float(front), float(self.points[-1][1]), float(side)))

    def _mark(self, leader: int, new: PathPair) -> None:
        """Record which sketch joints a path pair represents, and the lengths it projects to."""
        near, from_leader = np.abs(new.apart) <= EVEN + 0.5, new.leader_height
        self.used[leader][new.joints[0, near | from_leader]] = True
        self.used[1 - leader][new.joints[1, (near | ~from_leader) & ~new.switching]] = True
        _add_lengths(self.projected, leader, np.hypot(new.steps[..., 0], new.steps[..., 1]))
        _add_lengths(self.unsupported, leader, new.unsupported)

    def _placed(self, leader: int, new: PathPair) -> Floats:
        """Return x, y, z and radius (n, 4), units, of a path pair's points."""
        apart = new.apart
        yields = np.clip((GIVEN_UP - np.abs(apart)) / (GIVEN_UP - KEPT), 0.0, 1.0)
        midway = 0.5 * np.clip(apart, -EVEN, EVEN) * yields
        height = np.where(new.leader_height, new.places[0, :, 1] - midway, new.places[1, :, 1] + midway)
        front, side = new.places[leader], new.places[1 - leader]
        return np.column_stack([front[:, 0], height, side[:, 0], self._radii(leader, new)])

    def _radii(self, leader: int, new: PathPair) -> Floats:
        """Return the mean radius (n,), units, at most SLACK below the wider one; 0 if both are unknown.

        Where one path runs along a branch of another level (an extension), the smaller radius counts. Source: the
        two-sketches paper, equation 7, which always takes the mean.
        """
        levels = [
            sketch.level[sketch.branch[joints]] for sketch, joints in zip(self.led_by(leader), new.joints, strict=True)
        ]
        leading, following = new.places[:, :, 2]
        mean = np.maximum(0.5 * (leading + following), np.maximum(leading, following) - SLACK)
        both = np.where(levels[0] == levels[1], mean, np.minimum(leading, following))
        return np.asarray(np.where((leading > 0) & (following > 0), both, np.maximum(leading, following)))


def _add_lengths(sums: list[float], leader: int, lengths: Floats) -> None:
    """Add the leader's and the follower's lengths (2, n) to the sums of their sketches."""
    totals: Iterable[float] = lengths.sum(axis=1).tolist()
    for view, length in zip((leader, 1 - leader), totals, strict=True):
        sums[view] += length
