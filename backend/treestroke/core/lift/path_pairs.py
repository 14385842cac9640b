"""Where two sketches are woven into one tree: each joint a place on the front and a place on the side."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from treestroke.core.geometry.polyline import arc_lengths
from treestroke.core.lift.climbing import climb
from treestroke.core.lift.sheet import Sheet
from treestroke.core.types import Floats, Indices, Mask

HALVED = 4.0
"""Units apart in height up to which a joint lies midway between its two points; both are then within 2 units."""
KEPT, GIVEN_UP = 6.0, 12.0
"""Units apart in height up to which a joint keeps 2 units from the one point that moves, toward the other, so that both
sketches' strokes are near; and from which on it has that point's own height."""
SLACK = 1.5
"""Units by which a limb may be thinner than half of the wider of its two strokes, whose ink it would leave bare."""


@dataclass(frozen=True, eq=False)
class Walk:
    """Two chains walked at equal heights: the leader's and the follower's joint and place at each of n points.

    Attributes
    ----------
    joints
        (2, n) joints of the leader's and the follower's sheet.
    places
        (2, n, 3) x, y and radius of each.
    strayed
        (n,) where the follower crosses over from one branch to another, and is not at its joint.
    """

    joints: Indices
    places: Floats
    strayed: Mask

    @cached_property
    def apart(self) -> Floats:
        """How much higher the leader is than the follower (n,)."""
        return np.asarray(self.places[0, :, 1] - self.places[1, :, 1])

    def cut(self, start: int, end: int) -> "Walk":
        """Keep the points from ``start`` to before ``end``."""
        return Walk(self.joints[:, start:end], self.places[:, start:end], self.strayed[start:end])

    @cached_property
    def steps(self) -> Floats:
        """Move in x and y of the leader and the follower to each point (2, n, 2), none to the first."""
        steps = np.zeros((2, len(self.apart), 2))
        steps[:, 1:] = self.places[:, 1:, :2] - self.places[:, :-1, :2]
        return steps

    @cached_property
    def runs(self) -> Indices:
        """Bounds of the runs of points at unequal heights (k, 2): first point, and the point after the last."""
        off = np.zeros(len(self.apart) + 2, dtype=bool)
        off[1:-1] = np.abs(self.apart) > HALVED
        return np.flatnonzero(off[1:] != off[:-1]).reshape(-1, 2)

    @cached_property
    def led(self) -> Mask:
        """Which points (n,) have the leader's height: in a run of unequal heights the one that moves says it."""
        climbs = np.abs(self.steps[:, :, 1])
        led = np.ones(len(self.apart), dtype=bool)
        for start, end in self.runs.tolist():
            led[start:end] = climbs[0, start:end].sum() >= climbs[1, start:end].sum()
        return led

    @cached_property
    def invented(self) -> Floats:
        """Length of the piece before each point that the leader's and the follower's view (2, n) do not have."""
        off, led, steps = np.abs(self.apart) > 2 * HALVED, self.led, self.steps
        unseen = np.stack([off & ~led, off & led | self.strayed])
        shown = [np.hypot(steps[0, :, 0], steps[1, :, 1]), np.hypot(steps[1, :, 0], steps[0, :, 1])]
        return np.where(unseen, shown, 0.0)

    def lengths(self) -> Floats:
        """Length of the piece before each point (n,), seen from the front and the side together."""
        steps = self.steps
        return np.asarray(np.sqrt(steps[0, :, 0] ** 2 + steps[1, :, 0] ** 2 + steps[0, :, 1] ** 2))


def walk(sheets: tuple[Sheet, Sheet], lead: Indices, follow: Indices, start: int = 0) -> Walk:
    """Walk two chains of joints, of the leader's and the follower's sheet, the latter from its place ``start`` on."""
    chains = [sheet.points[chain] for sheet, chain in zip(sheets, (lead, follow), strict=True)]
    leader, follower = (np.column_stack([points[:, 1], arc_lengths(points)]) for points in chains)
    at = climb(leader, follower, start)
    places, whole = _every_joint(at)
    shapes = [
        np.column_stack([points, sheet.radii[chain]])
        for points, sheet, chain in zip(chains, sheets, (lead, follow), strict=True)
    ]
    leading = _between(shapes[0], places)
    following = _between(shapes[1], _levelled(shapes[1][:, 1], whole, leading[:, 1]))
    joints = np.stack([lead[np.round(places).astype(np.int64)], follow[whole]])
    return Walk(joints, np.stack([leading, following]), np.zeros(len(whole), dtype=bool))


def _every_joint(at: Indices) -> tuple[Floats, Indices]:
    """Spread jumps of the follower (n,) over its joints: the places of both at each point."""
    steps = np.diff(at)
    pieces = np.maximum(np.abs(steps), 1)
    order = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces) + 1
    start = np.repeat(np.arange(len(steps)), pieces)
    lead = start + order / pieces[start]
    follow = at[start] + np.sign(steps)[start] * order
    return np.append(0.0, lead), np.append(at[:1], follow).astype(np.int64)


def _levelled(heights: Floats, whole: Indices, wanted: Floats) -> Floats:
    """Move the follower from joints to the places next to them where it is as high as the leader."""
    missing = wanted - heights[whole]
    ahead = heights[np.minimum(whole + 1, len(heights) - 1)] - heights[whole]
    back = heights[np.maximum(whole - 1, 0)] - heights[whole]
    # Level pieces gain no height however far one goes: the 1 keeps the follower where it is there.
    moves = [np.clip(missing * rise / (rise * rise + 1.0), 0.0, 1.0) for rise in (ahead, back)]
    further = np.abs(missing - moves[0] * ahead) <= np.abs(missing - moves[1] * back)
    return np.asarray(whole + np.where(further, moves[0], -moves[1]))


def _between(shape: Floats, places: Floats) -> Floats:
    """Interpolate a chain (m, k) at places (n,) counted in its joints."""
    before = np.minimum(places.astype(np.int64), len(shape) - 1)
    after = np.minimum(before + 1, len(shape) - 1)
    return np.asarray(shape[before] + (places - before)[:, None] * (shape[after] - shape[before]))


@dataclass(eq=False)
class Weave:
    """The tree as it grows: a trie of walks, so that joints are shared as far as both their places are.

    Attributes
    ----------
    sheets
        Front and side.
    used
        Which joints of each some joint stands for.
    walked
        Walks by leader, both chains of joints and the follower's start: other weaves of the same sheets may share them.
    points, joints, parents, origins, walks
        By joint: x, y, z and radius; joint of each sheet; parent; how it came; number of the walk it came with.
    at, partners
        Joint by its joints of both sheets; by joint of a sheet those of the other that go with it.
    ends
        By limb: how far right of the stem its end is in the front, its height, and how far in the side.
    shown, invented
        By sheet: length that the tree shows, and what of that the sketch does not.
    """

    sheets: tuple[Sheet, Sheet]
    used: tuple[Mask, Mask]
    walked: dict[tuple[int, bytes, bytes, int], Walk] = field(default_factory=dict)
    points: list[Floats] = field(default_factory=list)
    joints: list[tuple[int, int]] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    origins: list[int] = field(default_factory=list)
    walks: list[int] = field(default_factory=list)
    at: dict[tuple[int, int], int] = field(default_factory=dict)
    partners: tuple[dict[int, list[int]], dict[int, list[int]]] = field(default_factory=lambda: ({}, {}))
    ends: list[tuple[float, float, float]] = field(default_factory=list)
    shown: list[float] = field(default_factory=lambda: [0.0, 0.0])
    invented: list[float] = field(default_factory=lambda: [0.0, 0.0])

    def start(self, leader: int, lead: Indices, follow: Indices) -> tuple[int, int]:
        """Find the furthest places on two chains that one joint stands for: where a walk along them leaves the tree."""
        place = dict(zip(follow.tolist(), range(len(follow)), strict=True))
        for i, joint in reversed(list(enumerate(lead.tolist()))):
            found = [place[j] for j in self.partners[leader].get(joint, ()) if j in place]
            if found:
                return i, max(found)
        return 0, 0

    def last_partner(self, leader: int, lead: Indices) -> tuple[int, int]:
        """Find the furthest place on a chain that a joint stands for, and the other sheet's joint that goes with it."""
        for i in range(len(lead) - 1, -1, -1):
            others = self.partners[leader].get(int(lead[i]))
            if others:
                return i, others[0]
        return 0, 0

    def attachment(self, leader: int, found: Walk) -> tuple[int, int]:
        """Find where a walk leaves the tree for good: its first new point and the joint that bears it (-1: none)."""
        lead, follow = found.joints
        before = self.sheets[leader].parents[lead], self.sheets[1 - leader].parents[follow]
        points = zip(*(each[::-1].tolist() for each in (lead, follow, *before)), strict=True)
        for left, (a, b, under_a, under_b) in enumerate(points):
            for pair in ((a, b), (a, under_b), (under_a, b)):
                joint = self.at.get(pair if leader == 0 else pair[::-1], -1)
                if joint >= 0:
                    return len(lead) - left, joint
        return 0, -1

    def lay(self, leader: int, found: Walk, origins: Indices) -> None:
        """Join a walk to the tree, as far as it is new."""
        first, bearer = self.attachment(leader, found)
        new = found.cut(first, found.joints.shape[1])
        points = self._placed(leader, new)
        number = self.walks[-1] + 1 if self.walks else 0
        self._mark(leader, new)
        for i, (a, b) in enumerate(new.joints.T.tolist()):
            pair = (a, b) if leader == 0 else (b, a)
            if not new.strayed[i]:
                self.at.setdefault(pair, len(self.points))
                self.partners[0].setdefault(pair[0], []).append(pair[1])
                self.partners[1].setdefault(pair[1], []).append(pair[0])
            self.parents.append(bearer if i == 0 else len(self.points) - 1)
            self.points.append(points[i])
            self.joints.append(pair)
            self.origins.append(int(origins[first + i]))
            self.walks.append(number)
        if number > 0 and new.joints.shape[1]:
            front, side = (sheet.aside[joint] for sheet, joint in zip(self.sheets, self.joints[-1], strict=True))
            self.ends.append((float(front), float(self.points[-1][1]), float(side)))

    def _mark(self, leader: int, new: Walk) -> None:
        """Note which joints a walk stands for, and how much it shows."""
        near, led = np.abs(new.apart) <= HALVED + 0.5, new.led
        self.used[leader][new.joints[0, near | led]] = True
        self.used[1 - leader][new.joints[1, (near | ~led) & ~new.strayed]] = True
        moved = np.hypot(new.steps[..., 0], new.steps[..., 1])
        for sums, lengths in ((self.shown, moved), (self.invented, new.invented)):
            for view, length in zip((leader, 1 - leader), lengths.sum(axis=1).tolist(), strict=True):
                sums[view] += length

    def _placed(self, leader: int, new: Walk) -> Floats:
        """Give x, y, z and radius (n, 4) of a walk's points."""
        apart = new.apart
        yields = np.clip((GIVEN_UP - np.abs(apart)) / (GIVEN_UP - KEPT), 0.0, 1.0)
        midway = 0.5 * np.clip(apart, -HALVED, HALVED) * yields
        height = np.where(new.led, new.places[0, :, 1] - midway, new.places[1, :, 1] + midway)
        front, side = new.places[leader], new.places[1 - leader]
        return np.column_stack([front[:, 0], height, side[:, 0], self._radii(leader, new)])

    def _radii(self, leader: int, new: Walk) -> Floats:
        """Give the mean radius (n,), but let no more than SLACK of the thicker's ink stand out; 0 if unknown.

        Where one walks on a bearer of the other's level, the thinner counts.
        """
        levels = [
            sheet.level[sheet.branch[joints]]
            for sheet, joints in zip((self.sheets[leader], self.sheets[1 - leader]), new.joints, strict=True)
        ]
        one, other = new.places[:, :, 2]
        mean = np.maximum(0.5 * (one + other), np.maximum(one, other) - SLACK)
        both = np.where(levels[0] == levels[1], mean, np.minimum(one, other))
        return np.asarray(np.where((one > 0) & (other > 0), both, np.maximum(one, other)))
