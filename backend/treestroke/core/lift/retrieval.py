"""Depth retrieval: one 3D tree from the front and the left side of it, drawn apart.

Source: the two-sketches paper, section 5, restated. A path from root to tip in 3D is a pair of such paths, one in each
sketch, walked at equal heights; the tree is the trie of those pairs. So a new pair leaves the tree where either path
does, which is the paper's extension (5.2), and no part ever hangs loose.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.lift.pairing import ALONE, SHORTEST, STRAYED, Match, Search
from treestroke.core.lift.path_pairs import HALVED, Weave
from treestroke.core.lift.sheet import Sheet, sheet
from treestroke.core.lift.trimming import trimmed
from treestroke.core.skeleton.branched import Branched
from treestroke.core.types import Indices, Mask

PAIRED, COMPLEMENTED, LONE = 0, 1, 2
"""How a joint came: a branch of the front paired with one of the side; one of the side that no pair used, given a
branch of the front; one at a height that the other sketch does not have."""
ATTEMPTS = ((0.5, False), (0.8, True))
"""Cost of a unit of a walk, as far as it lies flat or is invented, above which a branch waits until others are paired:
what they leave over may suit it better, and what may be invented goes to them first. And whether of those that waited
all of the front come before the side, or the longest first whichever it is of. Small differences decide much, so the
tree that lies flat the least is taken."""
ENOUGH = 0.15
"""Share of the limbs' length that may lie flat without another attempt."""
MANY = 150
"""Branches of both sketches from which on one attempt has to do, which takes seconds."""


@dataclass(frozen=True)
class RetrievalParams:
    """How depth is retrieved.

    Attributes
    ----------
    step
        Greatest distance between joints, sketch units.
    tries
        Branches walked together with a branch before the best is taken.
    radius_weight
        What a unit of radius weighs against one of height where brushes tell branches' radii (k2 / k1, eq. 2).
    """

    step: float = 6.0
    tries: int = 3
    radius_weight: float = 10.0

    def __post_init__(self) -> None:
        if not 1 <= self.step <= 20 or self.tries < 1 or self.radius_weight < 0:
            raise ValueError(f"retrieval needs a step of 1 to 20, a try and a weight >= 0, got {self}")


@dataclass(frozen=True, eq=False)
class Retrieved:
    """A 3D tree that looks like both sketches.

    Attributes
    ----------
    tree
        Its skeleton (n, 3) with branches: x from the front, y up, z from the side; the root is the origin.
    front, side
        (n,) the joint of each sketch that it stands for.
    origin
        (n,) PAIRED, COMPLEMENTED or LONE.
    """

    tree: Branched
    front: Indices
    side: Indices
    origin: Indices


def retrieve_depth(front: Branched, side: Branched, params: RetrievalParams = RetrievalParams()) -> Retrieved:
    """Weave a front and a left-side sketch into one tree."""
    sheets = sheet(front, params.step), sheet(side, params.step)
    weaves: list[Weave] = []
    branches = sum(len(each.own) for each in sheets)
    for dear, front_first in ATTEMPTS if branches < MANY else ATTEMPTS[:1]:
        if not weaves or _flat_share(weaves[-1]) > ENOUGH:
            weaves.append(_woven(_empty(sheets, weaves), params, dear, front_first))
    tree, joints, origin = trimmed(min(weaves, key=_flat_share))
    return Retrieved(tree, sheets[0].given[joints[0]], sheets[1].given[joints[1]], origin)


def _empty(sheets: tuple[Sheet, Sheet], others: list[Weave]) -> Weave:
    """Begin a weave of two sheets; what was walked for others need not be walked anew."""
    used = np.zeros(len(sheets[0].points), dtype=bool), np.zeros(len(sheets[1].points), dtype=bool)
    return Weave(sheets, used, others[0].walked) if others else Weave(sheets, used)


def _woven(weave: Weave, params: RetrievalParams, dear: float, front_first: bool) -> Weave:
    """Weave two sheets: first what pairs well, then what is left, the longest first."""
    order = [(leader, number) for leader in (0, 1) for number in weave.sheets[leader].order()]
    for leader, number in order:
        _pair(weave, leader, number, params, dear)
    left = {each: -_open_length(weave, *each) for each in order}
    for leader, number in sorted(order, key=lambda each: (each[0] * front_first, left[each])):
        _pair(weave, leader, number, params, None)
    return weave


def _flat_share(weave: Weave) -> float:
    """Measure what share of the limbs' length lies in the plane of one sketch."""
    points, parents, walks = np.array(weave.points)[:, :3], np.array(weave.parents), np.array(weave.walks)
    lengths = np.where(walks > 0, np.linalg.norm(points - points[np.maximum(parents, 0)], axis=1), 0.0)
    front, side = (sheet.flat[joints] for sheet, joints in zip(weave.sheets, np.array(weave.joints).T, strict=True))
    return float(lengths[front | side].sum() / max(lengths.sum(), 1e-9))


def _pair(weave: Weave, leader: int, number: int, params: RetrievalParams, dear: float | None) -> None:
    """Find partners for all of a branch of the leading sheet that has none yet, as far as they are not too ``dear``."""
    tried: set[int] = set()
    used = weave.used[leader]
    while len(run := _open_run(weave.sheets[leader], used, number)):
        search = Search(weave, leader, number, run, params.radius_weight, dear is None)
        best = search.best(tried, params.tries)
        if weave.points and dear is not None:
            burden, length = search.burden(best.walk)
            if burden > dear * length:
                return
        weave.lay(leader, best.walk, _origins(weave, leader, best))
        if used[run].any():
            tried.discard(STRAYED)
        if best.other == ALONE:
            used[run] = True


def _origins(weave: Weave, leader: int, best: Match) -> Indices:
    """Tell how the points of a walk (n,) come; the side's first for one of the front is a pair."""
    found = best.walk
    lone = (np.abs(found.apart) > 2 * HALVED) | found.strayed | (best.other == ALONE)
    taken = weave.used[0][found.joints[1]] if leader else np.zeros(len(lone), dtype=bool)
    return np.where(lone, LONE, np.where(taken, COMPLEMENTED, PAIRED))


def _open_length(weave: Weave, leader: int, number: int) -> float:
    """Measure what has no partner yet of a branch of the leading sheet."""
    own = weave.sheets[leader].own[number]
    return float(weave.sheets[leader].lengths[own[~weave.used[leader][own]]].sum())


def _open_run(leading: Sheet, used: Mask, number: int) -> Indices:
    """Give the first run of a branch's joints that nothing stands for and that is worth a walk."""
    own = leading.own[number]
    open_ = ~used[own]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], open_, [False]]).astype(np.int8)))
    for start, end in edges.reshape(-1, 2).tolist():
        if end - start == len(own) or leading.lengths[own[start:end]].sum() > SHORTEST:
            return own[start:end]
    return own[:0]
