"""A skeleton while it is being traced."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import simplified
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import child_counts, children
from treestroke.core.types import Floats, Indices


class Draft:
    """Joints in the photo, px, that only grow: each new one comes after its parent."""

    def __init__(self) -> None:
        self.points: list[Floats] = []
        self.radii: list[float] = []
        self.parents: list[int] = []
        self.stroke: list[int] = []
        self._table: tuple[Floats, Floats] | None = None

    def grow(self, parent: int, line_px: Floats, radius_px: Floats | float, stroke: int) -> int:
        """Add a chain (n, 2) with radii; from a parent its first point stands for the parent. Return its last joint."""
        radii = np.broadcast_to(radius_px, len(line_px))
        for point, radius in list(zip(line_px, radii, strict=True))[0 if parent < 0 else 1 :]:
            self.points.append(point)
            self.radii.append(float(radius))
            self.parents.append(parent)
            self.stroke.append(stroke)
            parent = len(self.points) - 1
        self._table = None
        return parent

    def table(self) -> tuple[Floats, Floats]:
        """Give all joints so far as arrays: points (n, 2) and radii (n,), px."""
        if self._table is None:
            self._table = np.array(self.points), np.array(self.radii)
        return self._table

    def nearest(self, point: Floats) -> int:
        """Find the joint nearest to a point (2,)."""
        return int(np.linalg.norm(self.table()[0] - point, axis=1).argmin())

    def skeleton(self) -> Skeleton:
        """Give the skeleton as it stands."""
        return Skeleton(*self.table(), np.array(self.parents))


def without(skeleton: Skeleton, stroke: Indices, dropped: Indices) -> tuple[Skeleton, Indices]:
    """Drop joints with all their descendants; joint 0 must stay."""
    gone = np.zeros(len(skeleton), dtype=bool)
    gone[dropped] = True
    for joint, parent in enumerate(skeleton.parents.tolist()):
        gone[joint] |= parent >= 0 and bool(gone[parent])
    return _kept(skeleton, stroke, ~gone)


def without_spurs(skeleton: Skeleton, stroke: Indices, shortest_px: float) -> tuple[Skeleton, Indices]:
    """Drop found branches (stroke -1) that end before they are ``shortest_px`` long: one arc is no branch yet."""
    lengths = edge_lengths(skeleton)
    below = np.zeros(len(skeleton))
    for joint in range(len(skeleton) - 1, 0, -1):
        parent = int(skeleton.parents[joint])
        if parent >= 0:
            below[parent] = max(below[parent], below[joint] + lengths[joint])
    leaves_stroke = (stroke < 0) & (stroke[np.maximum(skeleton.parents, 0)] >= 0)
    return without(skeleton, stroke, np.flatnonzero(leaves_stroke & (below + lengths < shortest_px)))


def simplify(skeleton: Skeleton, stroke: Indices, tolerance_px: float) -> tuple[Skeleton, Indices]:
    """Drop the joints between forks and ends that the line does not need.

    The paper (section 2) drops each joint that is no fork and turns by less than 30 degrees. On a smooth bend this
    cuts corners by several per cent of the tree's height, so we ask instead that no dropped joint lay further than
    ``tolerance_px`` from the line that stays.
    """
    counts, offspring = child_counts(skeleton), children(skeleton)
    # A branch's first joint stays, too: its thickness there is its own, not its bearer's.
    kept = (counts != 1) | (skeleton.parents < 0) | (stroke != stroke[np.maximum(skeleton.parents, 0)])
    for joint in np.flatnonzero(kept).tolist():
        for child in offspring[joint]:
            chain = [joint, child]
            while not kept[chain[-1]]:
                chain.append(offspring[chain[-1]][0])
            kept[np.array(chain)[simplified(skeleton.points[chain], tolerance_px)]] = True
    return _kept(skeleton, stroke, kept)


def _kept(skeleton: Skeleton, stroke: Indices, kept: NDArray[np.bool_]) -> tuple[Skeleton, Indices]:
    """Keep some joints; each is joined to its nearest kept ancestor."""
    ancestor = np.full(len(skeleton) + 1, -1, dtype=np.int64)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        ancestor[joint] = joint if kept[joint] else ancestor[parent]
    number = np.cumsum(kept) - 1
    above = ancestor[skeleton.parents[kept]]
    parents = np.where(above < 0, -1, number[above])
    return Skeleton(skeleton.points[kept], skeleton.radii[kept], parents), stroke[kept]
