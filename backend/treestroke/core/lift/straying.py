"""A walk whose follower may stray from branch to branch, wherever its sketch has one at the leader's height.

Where no one branch of the other sketch answers all of a branch, several may, one after the other. From branch to branch
the follower crosses over ground that its sketch does not show; the shortest way over (place on the chain, joint of the
other sheet) tells where that costs least.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from treestroke.core.geometry.polyline import arc_lengths
from treestroke.core.lift.path_pairs import HALVED, Walk, Weave
from treestroke.core.lift.sheet import Sheet
from treestroke.core.types import Floats, Indices, Mask

BEFORE = 60
"""Joints before a run from which on a walk may leave the tree."""
ASIDE = 9.0
"""Units that a follower may step aside unseen: from a branch to one that crosses it."""
CROSSING = 0.8
"""Units that the leader walks while the follower crosses over a unit."""
FRESH, USED, TWICE, FLAT, CROSSED, UNEVEN = 0.2, 0.5, 0.5, 2.0, 3.0, 0.2
"""Cost of a unit of the follower's that is new and that was used, besides where the leader's was, too, and where the
walk lies flat; of a unit crossed over; of a joint by the square of its units apart in height."""

Place = tuple[int, int]
"""Row of the chain that is walked, and joint of the other sheet."""


@dataclass(frozen=True, eq=False)
class _Rows:
    """What is walked: the chain's joints (n,), and from which one on they are new."""

    weave: Weave
    leader: int
    chain: Indices
    new: int

    @property
    def sheets(self) -> tuple[Sheet, Sheet]:
        """The leader's and the follower's sheet."""
        return self.weave.sheets[self.leader], self.weave.sheets[1 - self.leader]

    def way(self) -> list[Place]:
        """Find the cheapest way from the tree to the chain's end, or to where nothing is at its height."""
        lead, follow = self.sheets
        order = np.argsort(follow.points[:, 1], kind="stable")
        limits = lead.points[self.chain, 1][:, None] + [-HALVED, HALVED]
        bounds = np.searchsorted(follow.points[order, 1], limits)
        ahead = lead.lengths[self.chain][::-1].cumsum()[::-1]
        total, last, states, back = np.zeros(0), np.zeros(0), [order[:0]], [order[:0]]
        for row, (low, high) in enumerate(bounds.tolist()):
            nodes = np.sort(order[low:high])
            came, total = self._stepped(row, states[-1], nodes, total, float(ahead[row]))
            if row < self.new:
                partners = self.weave.partners[self.leader].get(int(self.chain[row]))
                if partners:
                    here = np.isin(nodes, partners)
                    came, total = np.where(here, -1, came), np.where(here, 0.0, total)
            elif not np.isfinite(total).any():
                return _traced(states[1:], back[1:], last) if row > self.new else []
            states.append(nodes)
            back.append(came)
            last = total
        return _traced(states[1:], back[1:], total)

    def _stepped(self, row: int, old: Indices, nodes: Indices, total: Floats, ahead: float) -> tuple[Indices, Floats]:
        """Step to a row: which of the old nodes (m,) each of the nodes (k,) is best come to from, and its cost."""
        if len(old) == 0 or len(nodes) == 0:
            return np.full(len(nodes), -1), np.full(len(nodes), np.inf)
        lead, follow = self.sheets
        joint = int(self.chain[row])
        far, drawn = _moved(follow, old[:, None], nodes[None])
        used, flat = self.weave.used[1 - self.leader][nodes], follow.flat[nodes] | lead.flat[joint]
        rate = np.where(used, USED, FRESH) + FLAT * flat + TWICE * (used & self.weave.used[self.leader][joint])
        apart = lead.points[joint, 1] - follow.points[nodes, 1]
        crossed = np.where(drawn, 0.0, np.where(far > ahead, np.inf, far))
        walked = np.sqrt(far * far + lead.lengths[joint] ** 2)
        cost = total[:, None] + walked * rate + CROSSED * crossed + UNEVEN * apart**2
        came = cost.argmin(axis=0)
        return came, cost[came, np.arange(len(nodes))]


def stray(weave: Weave, leader: int, chain: Indices, first: int, end: int) -> Walk | None:
    """Walk a chain of the leader's joints from the tree on to before place ``end``; those from ``first`` on are new."""
    begin = max(0, first - BEFORE)
    rows = _Rows(weave, leader, chain[begin:end], first - begin)
    way = rows.way()
    return _walk(rows, way) if way else None


def _moved(follow: Sheet, old: Indices, new: Indices) -> tuple[Floats, Mask]:
    """Measure how far it is between joints, and tell whether the sketch shows the way."""
    x, y = follow.points.T
    right, up = x[new] - x[old], y[new] - y[old]
    far = np.sqrt(right * right + up * up)
    along = np.abs(follow.arcs[new] - follow.arcs[old])
    own = (follow.branch[old] == follow.branch[new]) & (along <= 1.2 * far + 0.5 * ASIDE)
    return far, (far <= ASIDE) | own


def _traced(states: list[Indices], back: list[Indices], total: Floats) -> list[Place]:
    """Trace the way to the cheapest of the last states back to where it leaves the tree."""
    if not np.isfinite(total).any():
        return []
    node, way = int(total.argmin()), []
    for row in range(len(states) - 1, -1, -1):
        way.append((row, int(states[row][node])))
        node = int(back[row][node])
        if node < 0:
            break
    return way[::-1]


def _walk(rows: _Rows, way: list[Place]) -> Walk:
    """Make a way a walk: over every joint along a branch, and over no joint where it crosses."""
    lead, follow = rows.sheets
    at, joints, gaps = [float(way[0][0])], [way[0][1]], []
    for (before, old), (row, new) in pairwise(way):
        far, drawn = _moved(follow, np.array(old), np.array(new))
        between = _between(follow, old, new) if drawn else []
        if not drawn:
            gaps.append((len(at), float(far)))
        at += [before + (row - before) * (k + 1) / (len(between) + 1) for k in range(len(between) + 1)]
        joints += [*between, new]
    shape = np.column_stack([lead.points[rows.chain], lead.radii[rows.chain]])
    leading = np.column_stack([np.interp(at, np.arange(len(shape)), each) for each in shape.T])
    following = np.column_stack([follow.points[joints], follow.radii[joints]])
    strayed = _crossed(leading, following, gaps)
    chain = rows.chain[np.floor(at).astype(np.int64)]
    return Walk(np.stack([chain, np.array(joints)]), np.stack([leading, following]), strayed)


def _between(follow: Sheet, old: int, new: int) -> list[int]:
    """List the joints between two of a branch."""
    if follow.branch[old] != follow.branch[new]:
        return []
    own = follow.own[follow.branch[new]]
    start, end = (int(np.flatnonzero(own == joint)[0]) for joint in (old, new))
    onward = 1 if end > start else -1
    return [int(joint) for joint in own[start + onward : end : onward]] if start != end else []


def _crossed(leading: Floats, following: Floats, gaps: list[tuple[int, float]]) -> Mask:
    """Lead the follower (n, 3) from branch to branch aslant, at the leader's heights; tell where (n,)."""
    strayed = np.zeros(len(leading), dtype=bool)
    arcs = arc_lengths(leading[:, :2])
    for gap, far in gaps:
        start = arcs[gap - 1]
        stop = max(gap, min(int(np.searchsorted(arcs, start + CROSSING * far)), len(arcs) - 1))
        share = (arcs[gap : stop + 1] - start) / max(arcs[stop] - start, 1e-9)
        following[gap : stop + 1] = following[gap - 1] + share[:, None] * (following[stop] - following[gap - 1])
        following[gap : stop + 1, 1] = leading[gap : stop + 1, 1]
        following[gap : stop + 1, 2] = following[stop, 2]
        strayed[gap : stop + 1] = True
    return strayed
