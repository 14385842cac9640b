"""Depth retrieval: one 3D tree from the front and the left side of it, drawn apart.

Source: the two-sketches paper, section 5, restated. A path from root to tip in 3D is a pair of such paths, one in each
sketch, walked at equal heights; the tree is the trie of those pairs. So a new pair leaves the tree where either path
does, which is the paper's extension (5.2), and no part ever hangs loose.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.polyline import Indices
from treestroke.core.lift.pairing import ALONE, SHORTEST, Search
from treestroke.core.lift.sheet import Mask, Sheet, sheet
from treestroke.core.lift.trimming import trimmed
from treestroke.core.lift.weaving import HALVED, Weave
from treestroke.core.skeleton.branched import Branched

PAIRED, COMPLEMENTED, LONE = 0, 1, 2
"""How a joint came: a branch of the front paired with one of the side; one of the side that no pair used, given a
branch of the front; one at a height that the other sketch does not have."""


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
    used = np.zeros(len(sheets[0].points), dtype=bool), np.zeros(len(sheets[1].points), dtype=bool)
    weave = Weave(sheets, used)
    for leader in (0, 1):
        for number in sheets[leader].order():
            _pair(weave, leader, number, params)
    tree, joints, origin = trimmed(weave)
    return Retrieved(tree, sheets[0].given[joints[0]], sheets[1].given[joints[1]], origin)


def _pair(weave: Weave, leader: int, number: int, params: RetrievalParams) -> None:
    """Find partners for all of a branch of the leading sheet that has none yet."""
    tried: set[int] = set()
    while len(run := _open_run(weave.sheets[leader], weave.used[leader], number)):
        search = Search(weave, leader, number, run, params.radius_weight)
        best = search.best(tried, params.tries)
        lone = (np.abs(best.walk.apart) > 2 * HALVED) | (best.other == ALONE)
        weave.lay(leader, best.walk, np.where(lone, LONE, COMPLEMENTED if leader else PAIRED))
        if best.other == ALONE:
            weave.used[leader][run] = True


def _open_run(leading: Sheet, used: Mask, number: int) -> Indices:
    """Give the first run of a branch's joints that nothing stands for and that is worth a walk."""
    own = leading.own[number]
    open_ = ~used[own]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], open_, [False]]).astype(np.int8)))
    for start, end in edges.reshape(-1, 2).tolist():
        if end - start == len(own) or leading.lengths[own[start:end]].sum() > SHORTEST:
            return own[start:end]
    return own[:0]
