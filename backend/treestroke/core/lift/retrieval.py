"""Depth retrieval: one 3D tree from sketches of its front and its left side, which are not registered.

Source: the two-sketches paper, section 5, restated (docs/decisions/0014). A path from root to tip in 3D is a pair of
such paths, one in each sketch, aligned by height; the tree is the trie of those pairs. So a new pair leaves the tree
where either path does, which is the paper's extension (5.2), and every part is connected.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.lift.pairing import SEVERAL, SHORTEST, UNMATCHED, Match, PartnerSearch
from treestroke.core.lift.params import DEFAULTS, RetrievalParams
from treestroke.core.lift.path_pairs import EVEN, PathTrie
from treestroke.core.lift.pruning import prune
from treestroke.core.lift.sketch_tree import SketchTree, prepare_sketch
from treestroke.core.skeleton.branched import Branched
from treestroke.core.types import Indices, Mask

PAIRED, COMPLEMENTED, LONE = 0, 1, 2
"""Origin of a joint: a branch of the front paired with one of the side; a branch of the side that no pair used, paired
with one of the front (paper, 5.3); a branch at a height that the other sketch does not have."""
ATTEMPTS = ((0.5, False), (0.8, True))
"""Assignments that are tried, the first always. For each, the greatest burden for a unit of length with which a branch
is paired in the first round (branches above it wait, since what the others leave may suit them better), and whether in
the second round all of the front come before the side. Small differences have great effects, so the less flat of both
trees is taken."""
ACCEPTED_FLAT_SHARE = 0.15
"""Share of the limbs' length in the planes of view up to which no further assignment is tried."""
MANY_BRANCHES = 150
"""Number of branches in both sketches from which on only one assignment is tried, which takes seconds."""


@dataclass(frozen=True, eq=False)
class Retrieved:
    """A 3D tree that agrees with both sketches.

    Attributes
    ----------
    tree
        Skeleton (n, 3) with branches, sketch units: x from the front, y up, z from the side; the root is the origin.
    front, side
        (n,) index of the joint of each sketch that a joint represents.
    origin
        (n,) PAIRED, COMPLEMENTED or LONE.
    """

    tree: Branched
    front: Indices
    side: Indices
    origin: Indices


def retrieve_depth(front: Branched, side: Branched, params: RetrievalParams = DEFAULTS) -> Retrieved:
    """Join a front and a left-side sketch to one 3D tree.

    Both are 2D, in sketch units: x right, y up, the root at the origin, a height of 1000. Source: two-sketches paper,
    section 5.
    """
    sketches = prepare_sketch(front, params.step), prepare_sketch(side, params.step)
    assigned: list[PathTrie] = []
    branches = sum(len(sketch.paths) for sketch in sketches)
    for max_burden, front_first in ATTEMPTS if branches < MANY_BRANCHES else ATTEMPTS[:1]:
        if not assigned or _flat_share(assigned[-1]) > ACCEPTED_FLAT_SHARE:
            empty = PathTrie(sketches, assigned[0].alignments) if assigned else PathTrie(sketches)
            assigned.append(_assign(empty, params, max_burden, front_first))
    tree, joints, origin = prune(min(assigned, key=_flat_share))
    return Retrieved(tree, sketches[0].source_joint[joints[0]], sketches[1].source_joint[joints[1]], origin)


def _assign(trie: PathTrie, params: RetrievalParams, max_burden: float, front_first: bool) -> PathTrie:
    """Pair all branches of two sketches: first what pairs well, then the rest, the longest first."""
    order = [(leader, branch) for leader in (0, 1) for branch in trie.sketches[leader].order()]
    for leader, branch in order:
        _pair(trie, leader, branch, params, max_burden)
    remaining = {each: -_unpaired_length(trie, *each) for each in order}
    for leader, branch in sorted(order, key=lambda each: (each[0] * front_first, remaining[each])):
        _pair(trie, leader, branch, params, None)
    return trie


def _flat_share(trie: PathTrie) -> float:
    """Return the share of the limbs' length that lies in the plane of one sketch."""
    points, parents, number = np.array(trie.points)[:, :3], np.array(trie.parents), np.array(trie.pair_number)
    lengths = np.where(number > 0, np.linalg.norm(points - points[np.maximum(parents, 0)], axis=1), 0.0)
    front, side = (sketch.flat[joints] for sketch, joints in zip(trie.sketches, np.array(trie.joints).T, strict=True))
    return float(lengths[front | side].sum() / max(lengths.sum(), 1e-9))


def _pair(trie: PathTrie, leader: int, branch: int, params: RetrievalParams, max_burden: float | None) -> None:
    """Find partners for all unpaired joints of a branch of the leading sketch, unless the burden is too great."""
    tried: set[int] = set()
    used = trie.used[leader]
    while len(run := _unpaired_run(trie.sketches[leader], used, branch)):
        search = PartnerSearch(trie, leader, branch, run, params, max_burden is None)
        best = search.best(tried)
        if trie.points and max_burden is not None:
            burden, length = search.burden(best.pair)
            if burden > max_burden * length:
                return
        trie.insert(leader, best.pair, _origins(trie, leader, best))
        if used[run].any():
            tried.discard(SEVERAL)
        if best.partner == UNMATCHED:
            used[run] = True


def _origins(trie: PathTrie, leader: int, match: Match) -> Indices:
    """Return the origins (n,) of a match's points; a branch of the side with an unused one of the front is a pair."""
    pair = match.pair
    lone = (np.abs(pair.apart) > 2 * EVEN) | pair.switching | (match.partner == UNMATCHED)
    taken = trie.used[0][pair.joints[1]] if leader else np.zeros(len(lone), dtype=bool)
    return np.where(lone, LONE, np.where(taken, COMPLEMENTED, PAIRED))


def _unpaired_length(trie: PathTrie, leader: int, branch: int) -> float:
    """Return the length, units, of a branch of the leading sketch that has no partner yet."""
    joints = trie.sketches[leader].branch_joints[branch]
    return float(trie.sketches[leader].lengths[joints[~trie.used[leader][joints]]].sum())


def _unpaired_run(leading: SketchTree, used: Mask, branch: int) -> Indices:
    """Return the first run of a branch's joints without a partner that is the whole branch or not too short."""
    joints = leading.branch_joints[branch]
    unpaired = ~used[joints]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], unpaired, [False]]).astype(np.int8)))
    for start, end in edges.reshape(-1, 2).tolist():
        if end - start == len(joints) or leading.lengths[joints[start:end]].sum() > SHORTEST:
            return joints[start:end]
    return joints[:0]
