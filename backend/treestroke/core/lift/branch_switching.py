"""Alignment of a path with several branches of the other sketch.

Where no single branch of the other sketch matches all of a branch, several may, one after the other. Between two
branches the follower crosses ground that its sketch does not show. The cheapest sequence is a shortest path through
the layered graph of states (index on the leader's path, joint of the follower's sketch), solved layer by layer
(Viterbi 1967). The two-sketches paper (section 5.2) chooses the next branch greedily, at the height where one ends.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from treestroke.core.geometry.polyline import arc_lengths
from treestroke.core.lift.params import RetrievalParams
from treestroke.core.lift.path_pairs import EVEN, PathPair, PathTrie
from treestroke.core.lift.sketch_tree import SketchTree
from treestroke.core.types import Floats, Indices, Mask

LOOK_BACK = 60
"""Number of joints before the new ones among which the alignment may leave the tree."""
SIDESTEP = 9.0
"""Units that the follower may step aside for free: to a branch that crosses its own."""
CROSSING = 0.8
"""Units that the leader goes while the follower crosses a unit of unshown ground."""
NEW_COST, USED_COST = 0.2, 0.5
"""Cost of a unit of the follower's sketch that is not matched yet, and that is."""
HEIGHT_COST = 0.2
"""Cost of a joint for each squared unit of height difference."""

State = tuple[int, int]
"""Index on the leader's path, and joint of the follower's sketch."""


@dataclass(frozen=True, eq=False)
class _Graph:
    """The layered graph: the joints (n,) of the leader's path, and the index from which on they are new."""

    trie: PathTrie
    leader: int
    path: Indices
    new: int
    params: RetrievalParams

    def cheapest(self) -> list[State]:
        """Return the cheapest states from the tree to the path's end, or to where no joint is at its height."""
        lead, follow = self.trie.led_by(self.leader)
        order = np.argsort(follow.points[:, 1], kind="stable")
        limits = lead.points[self.path, 1][:, None] + [-EVEN, EVEN]
        bounds = np.searchsorted(follow.points[order, 1], limits)
        ahead = lead.lengths[self.path][::-1].cumsum()[::-1]
        total, last, layers, back = np.zeros(0), np.zeros(0), [order[:0]], [order[:0]]
        for row, (low, high) in enumerate(bounds.tolist()):
            nodes = np.sort(order[low:high])
            came, total = self._stepped(row, layers[-1], nodes, total, float(ahead[row]))
            if row < self.new:
                partners = self.trie.partners[self.leader].get(int(self.path[row]))
                if partners:
                    here = np.isin(nodes, partners)
                    came, total = np.where(here, -1, came), np.where(here, 0.0, total)
            elif not np.isfinite(total).any():
                return _trace_back(layers[1:], back[1:], last) if row > self.new else []
            layers.append(nodes)
            back.append(came)
            last = total
        return _trace_back(layers[1:], back[1:], total)

    def _stepped(self, row: int, old: Indices, nodes: Indices, total: Floats, ahead: float) -> tuple[Indices, Floats]:
        """Step to a layer: return the best predecessor among the old nodes (m,) of each node (k,), and its cost."""
        if len(old) == 0 or len(nodes) == 0:
            return np.full(len(nodes), -1), np.full(len(nodes), np.inf)
        lead, follow = self.trie.led_by(self.leader)
        joint, params = int(self.path[row]), self.params
        far, shown = _moved(follow, old[:, None], nodes[None])
        used, flat = self.trie.used[1 - self.leader][nodes], follow.flat[nodes] | lead.flat[joint]
        reused = used & self.trie.used[self.leader][joint]
        rate = np.where(used, USED_COST, NEW_COST) + params.flat_cost * flat + params.reuse_cost * reused
        apart = lead.points[joint, 1] - follow.points[nodes, 1]
        crossed = np.where(shown, 0.0, np.where(far > ahead, np.inf, far))
        length = np.sqrt(far * far + lead.lengths[joint] ** 2)
        cost = total[:, None] + length * rate + params.unsupported_cost * crossed + HEIGHT_COST * apart**2
        came = cost.argmin(axis=0)
        return came, cost[came, np.arange(len(nodes))]


def align_switching(trie: PathTrie, leader: int, path: Indices, first: int, params: RetrievalParams) -> PathPair | None:
    """Align a path (n,) of the leader's joint indices with several branches; None where that is not possible.

    The joints from index ``first`` on are new; the alignment begins where the path leaves the tree. Positions are in
    sketch units. Source: two-sketches paper, section 5.2, whose choice is greedy; Viterbi 1967.
    """
    begin = max(0, first - LOOK_BACK)
    graph = _Graph(trie, leader, path[begin:], first - begin, params)
    states = graph.cheapest()
    return _pair(graph, states) if states else None


def _moved(follow: SketchTree, old: Indices, new: Indices) -> tuple[Floats, Mask]:
    """Return the distance between joints, units, and whether the sketch shows the way."""
    x, y = follow.points.T
    right, up = x[new] - x[old], y[new] - y[old]
    far = np.sqrt(right * right + up * up)
    along = np.abs(follow.arcs[new] - follow.arcs[old])
    same = (follow.branch[old] == follow.branch[new]) & (along <= 1.2 * far + 0.5 * SIDESTEP)
    return far, (far <= SIDESTEP) | same


def _trace_back(layers: list[Indices], back: list[Indices], total: Floats) -> list[State]:
    """Return the states from where the alignment leaves the tree to the cheapest node of the last layer."""
    if not np.isfinite(total).any():
        return []
    node, states = int(total.argmin()), []
    for row in range(len(layers) - 1, -1, -1):
        states.append((row, int(layers[row][node])))
        node = int(back[row][node])
        if node < 0:
            break
    return states[::-1]


def _pair(graph: _Graph, states: list[State]) -> PathPair:
    """Turn states into a path pair: over every joint along a branch, and over none where it crosses."""
    lead, follow = graph.trie.led_by(graph.leader)
    at, joints, gaps = [float(states[0][0])], [states[0][1]], []
    for (before, old), (row, new) in pairwise(states):
        far, shown = _moved(follow, np.array(old), np.array(new))
        between = _between(follow, old, new) if shown else []
        if not shown:
            gaps.append((len(at), float(far)))
        at += [before + (row - before) * (k + 1) / (len(between) + 1) for k in range(len(between) + 1)]
        joints += [*between, new]
    shape = np.column_stack([lead.points[graph.path], lead.radii[graph.path]])
    leading = np.column_stack([np.interp(at, np.arange(len(shape)), column) for column in shape.T])
    following = np.column_stack([follow.points[joints], follow.radii[joints]])
    switching = _cross_gaps(leading, following, gaps)
    path = graph.path[np.floor(at).astype(np.int64)]
    return PathPair(np.stack([path, np.array(joints)]), np.stack([leading, following]), switching)


def _between(follow: SketchTree, old: int, new: int) -> list[int]:
    """List the joints between two joints of a branch."""
    if follow.branch[old] != follow.branch[new]:
        return []
    joints = follow.branch_joints[follow.branch[new]]
    start, end = (int(np.flatnonzero(joints == joint)[0]) for joint in (old, new))
    direction = 1 if end > start else -1
    return [int(joint) for joint in joints[start + direction : end : direction]] if start != end else []


def _cross_gaps(leading: Floats, following: Floats, gaps: list[tuple[int, float]]) -> Mask:
    """Move the follower (n, 3) in place, straight from branch to branch at the leader's heights; return where (n,)."""
    switching = np.zeros(len(leading), dtype=bool)
    arcs = arc_lengths(leading[:, :2])
    for gap, far in gaps:
        start = arcs[gap - 1]
        stop = max(gap, min(int(np.searchsorted(arcs, start + CROSSING * far)), len(arcs) - 1))
        share = (arcs[gap : stop + 1] - start) / max(arcs[stop] - start, 1e-9)
        following[gap : stop + 1] = following[gap - 1] + share[:, None] * (following[stop] - following[gap - 1])
        following[gap : stop + 1, 1] = leading[gap : stop + 1, 1]
        following[gap : stop + 1, 2] = following[stop, 2]
        switching[gap : stop + 1] = True
    return switching
