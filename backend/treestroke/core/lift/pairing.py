"""Which branch of the one sketch answers a branch of the other."""

from dataclasses import dataclass
from math import exp

import numpy as np

from treestroke.core.lift.path_pairs import HALVED, Walk, Weave, walk
from treestroke.core.lift.sheet import BINS, Sheet
from treestroke.core.lift.straying import stray
from treestroke.core.types import Floats, Indices, Mask

SHORTEST = 8.0
"""Units of a branch that need no partner: it is led on where its partner ends, and a shorter rest is left out."""
SPUR, TAIL = 80.0, 40.0
"""Units of height by which a branch may rise or droop further than its partner, for a while and at its end; the
former, too, by which it may be led on alone."""
SPARE = 0.045
"""Share of its length up to which the tree may show what a sketch does not: such spurs and tails, and crossings."""
FEATURES, LEVEL, LEFT, FRESH = 0.3, 60.0, 1.0, 0.6
TWICE, FLAT, UNTRUE, CROWDED = 0.5, 2.0, 3.0, 40.0
"""Cost of a unit by which two branches' features differ, that stays unpaired, that pairs for the first time (a gain),
that is walked twice, that lies flat, that is untrue; cost of a level between them and of a like limb at their height.
Tuned on the drawn pairs of the tests."""
ALONE, STRAYED = -1, -2
"""Stand for no branch, and for several."""
BURDEN = 100.0
"""Cost of what lies flat or is invented of a walk up to which no better one is sought."""
CLOSE = 150.0
"""Units of height at which limbs crowd each other."""


@dataclass(frozen=True, eq=False)
class Match:
    """A walk along a branch and another, what it costs, and which other: ALONE for none."""

    walk: Walk
    cost: float
    other: int


@dataclass(frozen=True, eq=False)
class Search:
    """What is sought: partners for a run of joints of a branch of the leading sheet.

    Attributes
    ----------
    weave, leader
        The tree so far; the leading sheet, 0 for the front.
    number, run
        The branch, and the joints of it (n,) that have no partner yet.
    radius_weight
        The paper's k2.
    late
        Whether all that pairs well is paired: what is left may stray from branch to branch.
    """

    weave: Weave
    leader: int
    number: int
    run: Indices
    radius_weight: float
    late: bool = False

    @property
    def sheets(self) -> tuple[Sheet, Sheet]:
        """The leader's and the follower's sheet."""
        return self.weave.sheets[self.leader], self.weave.sheets[1 - self.leader]

    def features(self) -> Floats:
        """Tell how unlike the branch each of the other sheet's is (k,): the paper's F, and what a drooping limb shows.

        Beside the greatest height of the family its least height counts, and the level: a stem answers a stem.
        """
        lead, follow = self.sheets
        number = self.number
        unlike = np.abs(follow.family_top - lead.family_top[number])
        unlike += np.abs(follow.family_lowest - lead.family_lowest[number])
        thick = follow.thickness
        known = (thick > 0) & (lead.radii[self.run[0]] > 0)
        unlike += np.where(known, self.radius_weight * np.abs(thick - lead.radii[self.run[0]]), 0.0)
        return np.asarray(FEATURES * unlike + LEVEL * np.abs(follow.level - lead.level[number]))

    def candidates(self, unlike: Floats, tried: set[int], most: int) -> list[int]:
        """List the most promising of the branches that pass heights of the run."""
        lead, follow = self.sheets
        mine = np.bincount(lead.bins[self.run], weights=lead.lengths[self.run], minlength=BINS)
        fresh = follow.lengths_by_height(~self.weave.used[1 - self.leader])[:, mine > 0].sum(axis=1)
        shared = follow.passing @ mine
        cost = unlike - FLAT * (follow.reaching @ mine) - LEFT * shared - FRESH * np.minimum(fresh, shared)
        cost[shared < min(SHORTEST, 0.5 * mine.sum())] = np.inf
        cost[list(tried - {ALONE, STRAYED})] = np.inf
        order = np.argsort(cost, kind="stable")[:most]
        return [int(m) for m in order if np.isfinite(cost[m])]

    def best(self, tried: set[int], most: int) -> Match:
        """Find the cheapest walk with a branch that is not among those tried, or alone; add to those tried."""
        if not self.weave.points:
            # The first pair is that of the stems: all else stands on it.
            return Match(self.match(0), 0.0, 0)
        unlike = self.features()
        found: list[Match] = []
        while not found and (others := self.candidates(unlike, tried, most)):
            walks = [(other, self.match(other)) for other in others]
            leading = [each for each in walks if self._paired(each[1]).any()]
            found = [Match(walk, self.cost(walk, unlike[other]), other) for other, walk in leading]
            tried.update([] if found else others)
        best = min(found, key=lambda match: match.cost) if found else Match(self.alone(), np.inf, ALONE)
        if best.other == 0:
            # With the stem it lies flat: going on from where it is may do better.
            alone = self.alone()
            if (alone.invented.sum(axis=1) < self.spare()).all() and np.abs(alone.apart).max() <= SPUR:
                best = min(best, Match(alone, self.cost(alone, 0.0), ALONE), key=lambda match: match.cost)
        if self.late and STRAYED not in tried and self.burden(best.walk)[0] > BURDEN:
            best = min(best, self.stray(), key=lambda match: match.cost)
        tried.add(best.other)
        return best

    def burden(self, found: Walk) -> tuple[float, float]:
        """Price what of the new part of a walk lies flat or is invented, and measure that part."""
        new = self.new(found)
        lengths = new.lengths()
        return float(FLAT * lengths @ self._flat(new) + UNTRUE * new.invented.sum()), float(lengths.sum())

    def new(self, found: Walk) -> Walk:
        """Give the part of a walk that the tree does not have."""
        first, _ = self.weave.attachment(self.leader, found)
        return found.cut(first, found.joints.shape[1])

    def _flat(self, new: Walk) -> Mask:
        """Tell which points of a walk (n,) lie in the plane of one sketch."""
        lead, follow = self.sheets
        return np.asarray(lead.flat[new.joints[0]] | follow.flat[new.joints[1]])

    def stray(self) -> Match:
        """Walk the run with as many branches as it takes; it costs too much where there is no such walk."""
        chain = self.sheets[0].paths[self.number]
        first, end = (int(np.flatnonzero(chain == joint)[-1]) for joint in self.run[[0, -1]])
        found = stray(self.weave, self.leader, chain, first, end + 1)
        if found is None or not self._paired(found).any() or (found.invented.sum(axis=1) > self.spare()).any():
            return Match(self.alone(), np.inf, STRAYED)
        return Match(found, self.cost(found, 0.0), STRAYED)

    def match(self, other: int) -> Walk:
        """Walk the branch together with another, from where both leave the tree to where their heights part."""
        lead, follow = self.sheets
        chain, partner = lead.paths[self.number], follow.paths[other]
        start_height, other_height = (
            float(sheet.points[sheet.bud[b], 1]) for sheet, b in ((lead, self.number), (follow, other))
        )
        if follow.top[other] < start_height - HALVED:
            partner = detour(follow, other, start_height)
        elif lead.top[self.number] < other_height - HALVED:
            chain = detour(lead, self.number, other_height)
        end = int(np.flatnonzero(chain == self.run[-1])[-1]) + 1
        first = int(np.flatnonzero(chain == self.run[0])[-1])
        i, j = self.weave.start(self.leader, chain[:first], partner)
        # A stem passes all heights: one may come down on it below where one left it.
        low = 0 if other == 0 else j
        key = self.leader, chain[i:end].tobytes(), partner[low:].tobytes(), j - low
        if key not in self.weave.walked:
            self.weave.walked[key] = walk(self.sheets, chain[i:end], partner[low:], j - low)
        found = self.weave.walked[key]
        return found.cut(0, max(_parting(found, self.spare()), 1))

    def spare(self) -> Floats:
        """Length that may still be invented in the leader's and the follower's view (2,)."""
        lengths = np.array([sheet.lengths.sum() for sheet in self.sheets])
        if self.late:
            both = zip(self.weave.sheets, self.weave.used, strict=True)
            left = sum(float(sheet.lengths[~used].sum()) for sheet, used in both)
            lengths = np.maximum(lengths, np.add(self.weave.shown[:: 1 - 2 * self.leader], left))
        return np.asarray(SPARE * lengths - self.weave.invented[:: 1 - 2 * self.leader])

    def alone(self) -> Walk:
        """Lead the branch on to the end of the run while the follower stays where it is."""
        lead, follow = self.sheets
        chain = lead.paths[self.number]
        first, end = (int(np.flatnonzero(chain == joint)[0]) for joint in self.run[[0, -1]])
        i, partner = self.weave.last_partner(self.leader, chain[:first])
        joints = np.stack([chain[i : end + 1], np.full(end + 1 - i, partner)])
        places = [
            np.column_stack([sheet.points[each], sheet.radii[each]])
            for sheet, each in zip((lead, follow), joints, strict=True)
        ]
        return Walk(joints, np.stack(places), np.zeros(joints.shape[1], dtype=bool))

    def cost(self, found: Walk, unlike: float) -> float:
        """Price a walk: what it leaves, repeats, flattens or invents, and how unlike the branches are."""
        lead, follow = self.sheets
        used = self.weave.used[self.leader], self.weave.used[1 - self.leader]
        new = self.new(found)
        fresh = np.zeros(len(follow.points), dtype=bool)
        fresh[new.joints[1]] = True
        fresh &= ~used[1]
        twice = used[0][new.joints[0]] & used[1][new.joints[1]]
        cost = unlike + LEFT * lead.lengths[self.run[~self._paired(new)]].sum() - FRESH * follow.lengths[fresh].sum()
        cost += new.lengths() @ (TWICE * twice + FLAT * self._flat(new)) + UNTRUE * new.invented.sum()
        return float(cost + CROWDED * self._crowd(new))

    def _paired(self, found: Walk) -> Mask:
        """Tell which joints of the run (n,) a walk comes to."""
        reached = np.zeros(len(self.sheets[0].points), dtype=bool)
        reached[found.joints[0]] = True
        return np.asarray(reached[self.run])

    def _crowd(self, new: Walk) -> float:
        """Count limbs of like height that went to the same side in both sketches, near ones more."""
        if new.joints.shape[1] == 0:
            return 0.0
        here = [float(sheet.aside[joint]) for sheet, joint in zip(self.sheets, new.joints[:, -1], strict=True)]
        right, toward = here[:: 1 - 2 * self.leader]
        height = float(new.places[0, -1, 1])
        return sum(exp(-abs(y - height) / CLOSE) for x, y, z in self.weave.ends if x * right > 0 and z * toward > 0)


def detour(sheet: Sheet, number: int, height: float) -> Indices:
    """Lead the path to a branch past its bud up its bearer to a height, and back down to the bud.

    So drooping limbs answer each other whose buds are not equally high.
    """
    path = sheet.paths[number]
    bud = int(sheet.bud[number])
    place = int(np.flatnonzero(path == bud)[0])
    bearing = sheet.paths[int(sheet.branch[bud])]
    arm = bearing[place + 1 :]
    reached = np.flatnonzero(sheet.points[arm, 1] >= height)
    if len(path) == len(bearing) or len(reached) == 0:
        return path
    arm = arm[: reached[0] + 1]
    return np.concatenate([path[: place + 1], arm, arm[-2::-1], path[place:]])


def _parting(found: Walk, spare: Floats) -> int:
    """Count the points up to which two climbers keep equal heights, but for spurs and tails of a spare length (2,)."""
    invented = found.invented
    for start, end in found.runs.tolist():
        spare = spare - invented[:, start:end].sum(axis=1)
        most = float(np.abs(found.apart[start:end]).max())
        allowed = TAIL if end == len(found.apart) else SPUR
        if most > 2 * HALVED + SHORTEST and (most > allowed or spare.min() < 0):
            return int(start)
    return len(found.apart)
