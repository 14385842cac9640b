"""A 2D skeleton under construction, and its simplification."""

import numpy as np

from treestroke.core.geometry.polyline import simplified
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import child_counts, children
from treestroke.core.types import Floats, Indices, Mask


class SkeletonBuilder:
    """Joints in the photo, px; they are only added, each after its parent."""

    def __init__(self) -> None:
        self.points: list[Floats] = []
        self.radii: list[float] = []
        self.parents: list[int] = []
        self.stroke: list[int] = []
        self._arrays: tuple[Floats, Floats] | None = None

    def add_chain(self, parent: int, line_px: Floats, radius_px: Floats | float, stroke: int) -> int:
        """Add a chain of points (n, 2), px, with radii (n,) or one radius, px; return the index of its last joint.

        Its first point coincides with the parent; without one (-1) it is a root. ``stroke`` is the stroke's index.
        """
        radii = np.broadcast_to(radius_px, len(line_px))
        for point, radius in list(zip(line_px, radii, strict=True))[0 if parent < 0 else 1 :]:
            self.points.append(point)
            self.radii.append(float(radius))
            self.parents.append(parent)
            self.stroke.append(stroke)
            parent = len(self.points) - 1
        self._arrays = None
        return parent

    def arrays(self) -> tuple[Floats, Floats]:
        """Return all joints so far: points (n, 2) and radii (n,), px."""
        if self._arrays is None:
            self._arrays = np.array(self.points), np.array(self.radii)
        return self._arrays

    def strokes(self) -> list[tuple[Floats, Floats]]:
        """List the lines (n, 2) and radii (n,), px, that follow each stroke."""
        points, radii = self.arrays()
        stroke = np.array(self.stroke)
        return [(points[stroke == index], radii[stroke == index]) for index in np.unique(stroke[stroke >= 0])]

    def set_radii(self, radii_px: Floats) -> None:
        """Replace the radii (n,), px, of all joints so far."""
        self.radii, self._arrays = radii_px.tolist(), None

    def nearest(self, point: Floats) -> int:
        """Return the index of the joint to whose surface a point (2,), px, is nearest, or in which it lies deepest."""
        points, radii = self.arrays()
        return int((np.linalg.norm(points - point, axis=1) - radii).argmin())

    def stem_below(self, joint: int) -> Indices:
        """List the joints (n,), indices, along a joint's own stroke from its start to this joint."""
        found = [joint]
        while (parent := self.parents[found[-1]]) >= 0 and self.stroke[parent] == self.stroke[joint]:
            found.append(parent)
        return np.array(found[::-1], dtype=np.int64)

    def skeleton(self) -> Skeleton:
        """Return the skeleton so far."""
        return Skeleton(*self.arrays(), np.array(self.parents))


def drop_subtrees(skeleton: Skeleton, stroke: Indices, dropped: Indices) -> tuple[Skeleton, Indices]:
    """Drop joints (k,), given by index, with all their descendants; joint 0 must stay.

    ``stroke`` (n,) is the index of each joint's stroke; that of the m joints that stay is returned, too.
    """
    gone = np.zeros(len(skeleton), dtype=bool)
    gone[dropped] = True
    for joint, parent in enumerate(skeleton.parents.tolist()):
        gone[joint] |= parent >= 0 and bool(gone[parent])
    return _keep(skeleton, stroke, ~gone)


def simplify(skeleton: Skeleton, stroke: Indices, tolerance_px: float) -> tuple[Skeleton, Indices]:
    """Drop the joints between forks and ends that lie, and whose radii are, within ``tolerance_px`` of what remains.

    ``stroke`` (n,) is the index of each joint's stroke; that of the joints that stay is returned, too. Source: Tan et
    al. 2008, section 2, which drops each joint that is not a fork and turns by less than 30 degrees. On a smooth bend
    that cuts corners by several per cent of the tree's height, so we use the line of Douglas and Peucker (1973).
    """
    counts, offspring = child_counts(skeleton), children(skeleton)
    # A branch's first joint stays, too: its thickness there is its own, not its parent's.
    places = np.column_stack([skeleton.points, skeleton.radii])
    kept = (counts != 1) | (skeleton.parents < 0) | (stroke != stroke[np.maximum(skeleton.parents, 0)])
    for joint in np.flatnonzero(kept).tolist():
        for child in offspring[joint]:
            chain = [joint, child]
            while not kept[chain[-1]]:
                chain.append(offspring[chain[-1]][0])
            kept[np.array(chain)[simplified(places[chain], tolerance_px)]] = True
    return _keep(skeleton, stroke, kept)


def _keep(skeleton: Skeleton, stroke: Indices, kept: Mask) -> tuple[Skeleton, Indices]:
    """Keep the joints of a mask (n,), each joined to its nearest kept ancestor."""
    ancestor = np.full(len(skeleton) + 1, -1, dtype=np.int64)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        ancestor[joint] = joint if kept[joint] else ancestor[parent]
    number = np.cumsum(kept) - 1
    above = ancestor[skeleton.parents[kept]]
    parents = np.where(above < 0, -1, number[above])
    return Skeleton(skeleton.points[kept], skeleton.radii[kept], parents), stroke[kept]
