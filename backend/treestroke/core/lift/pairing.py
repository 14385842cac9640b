"""The choice of a partner: which branch of the other sketch goes with a branch, by least assignment cost.

Source: two-sketches paper, section 5.1, equations 1 to 3. Its feature F is the first term of our cost. We add the gap
penalty, a gain for parts that are matched for the first time, and costs of parts that are matched twice, lie flat, are
not supported by a sketch or are crowded: by F alone limbs pair with the other sketch's trunk.
"""

from dataclasses import dataclass
from math import exp

import numpy as np

from treestroke.core.lift.branch_switching import align_switching
from treestroke.core.lift.params import RetrievalParams
from treestroke.core.lift.path_pairs import EVEN, PathPair, PathTrie, align_paths
from treestroke.core.lift.sketch_tree import BINS, SketchTree
from treestroke.core.types import Floats, Indices, Mask

SHORTEST = 8.0
"""Length, units, that needs no partner: it continues where its partner ends, or is left out."""
SPUR, TAIL = 80.0, 40.0
"""Height, units, by which a branch may depart from its partner in between and at its end; SPUR also bounds how far it
may continue without a partner."""
UNSUPPORTED_SHARE = 0.045
"""Greatest share of its projected length that the tree may show and a sketch does not: spurs, tails and crossings."""
UNMATCHED, SEVERAL = -1, -2
"""Partner numbers that stand for no branch and for several."""
ACCEPTED_BURDEN = 100.0
"""Cost of the flat and unsupported parts up to which no alignment with several branches is tried."""
CROWD_HEIGHT = 150.0
"""Difference in height, units, at which the crowding of two limbs has fallen to 1 / e."""


@dataclass(frozen=True, eq=False)
class Match:
    """A path pair, its cost, and the partner's number: UNMATCHED, SEVERAL or a branch."""

    pair: PathPair
    cost: float
    partner: int


@dataclass(frozen=True, eq=False)
class PartnerSearch:
    """The search for partners of a run of joints of a branch of the leading sketch.

    Attributes
    ----------
    trie, leader
        The tree so far; the number of the leading sketch, 0 for the front.
    branch, run
        The branch, and those of its joints (n,) that have no partner yet.
    params
        Costs.
    late
        Whether all that pairs well is paired, so that a branch may be aligned with several.
    """

    trie: PathTrie
    leader: int
    branch: int
    run: Indices
    params: RetrievalParams
    late: bool = False

    @property
    def sketches(self) -> tuple[SketchTree, SketchTree]:
        """The leader's and the follower's sketch."""
        return self.trie.led_by(self.leader)

    def feature_costs(self) -> Floats:
        """Return the cost (k,) by which each of the other sketch's branches differs from the branch.

        Source: two-sketches paper, equations 1 and 2 (F). Beside the family's greatest height its least height counts,
        for drooping limbs, and the level, so that a stem pairs with a stem.
        """
        lead, follow = self.sketches
        unlike = np.abs(follow.family_top - lead.family_top[self.branch])
        unlike += np.abs(follow.family_lowest - lead.family_lowest[self.branch])
        thick = follow.thickness
        known = (thick > 0) & (lead.radii[self.run[0]] > 0)
        unlike += np.where(known, self.params.radius_weight * np.abs(thick - lead.radii[self.run[0]]), 0.0)
        levels = np.abs(follow.level - lead.level[self.branch])
        return np.asarray(self.params.feature_weight * unlike + self.params.level_weight * levels)

    def candidates(self, feature_costs: Floats, tried: set[int], most: int) -> list[int]:
        """List up to ``most`` branches, by estimated cost, that pass heights of the run.

        ``feature_costs`` (k,) are those of the other sketch's branches; ``tried`` holds indices of branches to skip.
        """
        lead, follow = self.sketches
        params = self.params
        mine = np.bincount(lead.height_bin[self.run], weights=lead.lengths[self.run], minlength=BINS)
        fresh = follow.lengths_by_height(~self.trie.used[1 - self.leader])[:, mine > 0].sum(axis=1)
        shared = follow.passing @ mine
        cost = feature_costs - params.flat_cost * (follow.reaching @ mine)
        cost = cost - params.unmatched_cost * shared - params.new_match_gain * np.minimum(fresh, shared)
        cost[shared < min(SHORTEST, 0.5 * mine.sum())] = np.inf
        cost[list(tried - {UNMATCHED, SEVERAL})] = np.inf
        order = np.argsort(cost, kind="stable")[:most]
        return [int(m) for m in order if np.isfinite(cost[m])]

    def best(self, tried: set[int]) -> Match:
        """Find the cheapest match with a branch not yet tried, or with none; add its partner to those tried."""
        if not self.trie.points:
            # The first pair is that of the stems: all else grows from it.
            return Match(self.match(0), 0.0, 0)
        best = self._best_single(tried)
        if best.partner == 0:
            # Matched with the stem it lies flat: continuing from where it is may cost less.
            alone = self.unmatched()
            if (alone.unsupported.sum(axis=1) < self.spare()).all() and np.abs(alone.apart).max() <= SPUR:
                best = min(best, Match(alone, self.cost(alone, 0.0), UNMATCHED), key=lambda match: match.cost)
        if self.late and SEVERAL not in tried and self.burden(best.pair)[0] > ACCEPTED_BURDEN:
            best = min(best, self.match_several(), key=lambda match: match.cost)
        tried.add(best.partner)
        return best

    def _best_single(self, tried: set[int]) -> Match:
        """Find the cheapest match with one branch; add those that reach no joint of the run to those tried."""
        feature_costs = self.feature_costs()
        found: list[Match] = []
        while not found and (others := self.candidates(feature_costs, tried, self.params.tries)):
            pairs = [(other, self.match(other)) for other in others]
            useful = [(other, pair) for other, pair in pairs if self._reached(pair).any()]
            found = [Match(pair, self.cost(pair, feature_costs[other]), other) for other, pair in useful]
            tried.update([] if found else others)
        return min(found, key=lambda match: match.cost) if found else Match(self.unmatched(), np.inf, UNMATCHED)

    def burden(self, pair: PathPair) -> tuple[float, float]:
        """Return the cost of the flat and unsupported parts of a pair's new points, and the length of these, units."""
        new, params = self.new_part(pair), self.params
        lengths = new.lengths()
        flat, unsupported = lengths @ self._flat(new), new.unsupported.sum()
        return float(params.flat_cost * flat + params.unsupported_cost * unsupported), float(lengths.sum())

    def new_part(self, pair: PathPair) -> PathPair:
        """Return the part of a path pair that the tree does not have."""
        first, _ = self.trie.branching(self.leader, pair)
        return pair.cut(first, len(pair))

    def _flat(self, new: PathPair) -> Mask:
        """Return a mask (n,) of the points that lie in the plane of one sketch."""
        lead, follow = self.sketches
        return np.asarray(lead.flat[new.joints[0]] | follow.flat[new.joints[1]])

    def match_several(self) -> Match:
        """Align the run with several branches; the cost is infinite where that is not possible."""
        path = self.sketches[0].paths[self.branch]
        first, last = (int(np.flatnonzero(path == joint)[-1]) for joint in self.run[[0, -1]])
        pair = align_switching(self.trie, self.leader, path[: last + 1], first, self.params)
        if pair is None or not self._reached(pair).any() or (pair.unsupported.sum(axis=1) > self.spare()).any():
            return Match(self.unmatched(), np.inf, SEVERAL)
        return Match(pair, self.cost(pair, 0.0), SEVERAL)

    def match(self, other: int) -> PathPair:
        """Align the branch with another, from where both leave the tree to where their heights part."""
        lead, follow = self.sketches
        path, partner = lead.paths[self.branch], follow.paths[other]
        start_height, other_height = (
            float(sketch.points[sketch.bud[b], 1]) for sketch, b in ((lead, self.branch), (follow, other))
        )
        if follow.top[other] < start_height - EVEN:
            partner = detour(follow, other, start_height)
        elif lead.top[self.branch] < other_height - EVEN:
            path = detour(lead, self.branch, other_height)
        end = int(np.flatnonzero(path == self.run[-1])[-1]) + 1
        first = int(np.flatnonzero(path == self.run[0])[-1])
        i, j = self.trie.last_shared(self.leader, path[:first], partner)
        # A stem passes all heights: the alignment may come down on it below where it left it.
        low = 0 if other == 0 else j
        key = self.leader, path[i:end].tobytes(), partner[low:].tobytes(), j - low
        if key not in self.trie.alignments:
            self.trie.alignments[key] = align_paths(self.sketches, path[i:end], partner[low:], j - low)
        pair = self.trie.alignments[key]
        return pair.cut(0, max(_even_count(pair, self.spare()), 1))

    def spare(self) -> Floats:
        """Return the length (2,), units, that the leader's and the follower's view may still show unsupported."""
        lengths = np.array([sketch.lengths.sum() for sketch in self.sketches])
        if self.late:
            both = zip(self.trie.sketches, self.trie.used, strict=True)
            left = sum(float(sketch.lengths[~used].sum()) for sketch, used in both)
            lengths = np.maximum(lengths, np.add(self.trie.projected[:: 1 - 2 * self.leader], left))
        return np.asarray(UNSUPPORTED_SHARE * lengths - self.trie.unsupported[:: 1 - 2 * self.leader])

    def unmatched(self) -> PathPair:
        """Continue the branch to the end of the run while the follower stays where it is."""
        path = self.sketches[0].paths[self.branch]
        first, last = (int(np.flatnonzero(path == joint)[0]) for joint in self.run[[0, -1]])
        i, partner = self.trie.last_partner(self.leader, path[:first])
        joints = np.stack([path[i : last + 1], np.full(last + 1 - i, partner)])
        places = [
            np.column_stack([sketch.points[each], sketch.radii[each]])
            for sketch, each in zip(self.sketches, joints, strict=True)
        ]
        return PathPair(joints, np.stack(places), np.zeros(joints.shape[1], dtype=bool))

    def cost(self, pair: PathPair, feature_cost: float) -> float:
        """Return the assignment cost of a pair: feature, gap, reuse, flatness, lack of support and crowding."""
        lead, follow = self.sketches
        params = self.params
        used = self.trie.used[self.leader], self.trie.used[1 - self.leader]
        new = self.new_part(pair)
        fresh = np.zeros(len(follow.points), dtype=bool)
        fresh[new.joints[1]] = True
        fresh &= ~used[1]
        reused = used[0][new.joints[0]] & used[1][new.joints[1]]
        gap = lead.lengths[self.run[~self._reached(new)]].sum()
        cost = feature_cost + params.unmatched_cost * gap - params.new_match_gain * follow.lengths[fresh].sum()
        rate = params.reuse_cost * reused + params.flat_cost * self._flat(new)
        cost += new.lengths() @ rate + params.unsupported_cost * new.unsupported.sum()
        return float(cost + params.crowding_cost * self._crowding(new))

    def _reached(self, pair: PathPair) -> Mask:
        """Return a mask (n,) of the run's joints that a path pair reaches."""
        reached = np.zeros(len(self.sketches[0].points), dtype=bool)
        reached[pair.joints[0]] = True
        return np.asarray(reached[self.run])

    def _crowding(self, new: PathPair) -> float:
        """Count the limbs on the same side in both sketches, each weighted by how near in height it ends."""
        if len(new) == 0:
            return 0.0
        here = [float(sketch.aside[joint]) for sketch, joint in zip(self.sketches, new.joints[:, -1], strict=True)]
        front, side = here[:: 1 - 2 * self.leader]
        height = float(new.places[0, -1, 1])
        near = [y for x, y, z in self.trie.tips if x * front > 0 and z * side > 0]
        return sum(exp(-abs(y - height) / CROWD_HEIGHT) for y in near)


def detour(sketch: SketchTree, branch: int, height: float) -> Indices:
    """Return a branch's path of joint indices (n,) that first goes up its parent to a height, units, and back.

    So drooping limbs can be aligned whose buds are not equally high.
    """
    path = sketch.paths[branch]
    bud = int(sketch.bud[branch])
    place = int(np.flatnonzero(path == bud)[0])
    parent_path = sketch.paths[int(sketch.branch[bud])]
    arm = parent_path[place + 1 :]
    reached = np.flatnonzero(sketch.points[arm, 1] >= height)
    if len(path) == len(parent_path) or len(reached) == 0:
        return path
    arm = arm[: reached[0] + 1]
    return np.concatenate([path[: place + 1], arm, arm[-2::-1], path[place:]])


def _even_count(pair: PathPair, spare: Floats) -> int:
    """Count the points up to which heights stay equal, except for spurs and tails within a spare length (2,), units."""
    unsupported = pair.unsupported
    for start, end in pair.uneven_runs.tolist():
        spare = spare - unsupported[:, start:end].sum(axis=1)
        most = float(np.abs(pair.apart[start:end]).max())
        allowed = TAIL if end == len(pair.apart) else SPUR
        if most > 2 * EVEN + SHORTEST and (most > allowed or spare.min() < 0):
            return int(start)
    return len(pair.apart)
