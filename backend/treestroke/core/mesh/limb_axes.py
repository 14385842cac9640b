"""The axes of a tree's limbs, one after the other in flat arrays, and their simplification."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.vectors import UP
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import heaviest_children, limbs
from treestroke.core.types import Floats, Indices, Mask

_ROUNDS = 8  # of simplification; each drops at most every other point


@dataclass(frozen=True, eq=False)
class LimbAxes:
    """The axis and radius of every limb of a tree, limb by limb.

    ======  ====================================================================
    letter  meaning
    ======  ====================================================================
    m       points; a fork counts once for each limb that starts or passes there
    k       limbs; each has at least two points
    ======  ====================================================================

    Attributes
    ----------
    points
        (m, 3) metres.
    radii
        (m,) metres; a limb's first point has the limb's own radius, not that of the joint it grows from.
    limb
        (m,) index of the point's limb, ascending.
    forks
        (m,) bool, whether other limbs start at the point.
    joint
        (m,) index of the skeleton's joint; for a limb's first point the joint of the parent limb that it grows from.
    parent_radius
        (k,) radius of the parent limb where a limb starts, metres; 0 for a stem.
    parent_direction
        (k, 3) unit direction of the parent limb there; up for a stem.
    """

    points: Floats
    radii: Floats
    limb: Indices
    forks: Mask
    joint: Indices
    parent_radius: Floats
    parent_direction: Floats

    @property
    def first(self) -> Indices:
        """Index (k,) of each limb's first point."""
        return np.flatnonzero(np.diff(self.limb, prepend=-1)).astype(np.int64)

    @property
    def last(self) -> Indices:
        """Index (k,) of each limb's last point."""
        return np.flatnonzero(np.diff(self.limb, append=self.limb[-1] + 1)).astype(np.int64)

    @property
    def is_stem(self) -> Mask:
        """The mask (k,) of the limbs that grow from no other."""
        return np.asarray(self.parent_radius == 0)


def limb_axes(skeleton: Skeleton, min_radius: float) -> LimbAxes:
    """Lay out the limbs of a 3D skeleton (metres); the strongest child continues its parent's limb.

    Radii are raised to ``min_radius`` (metres, positive). Points closer than a thousandth of it to the one before are
    left out, and so are limbs without length.

    Raises
    ------
    ValueError
        The skeleton has no length, so that no limb is left.
    """
    successors = heaviest_children(skeleton, skeleton.radii)
    paths = limbs(skeleton, successors)
    joint = np.concatenate(paths)
    limb = np.repeat(np.arange(len(paths)), [len(path) for path in paths])
    first = np.flatnonzero(np.diff(limb, prepend=-1))
    second = np.minimum(first + 1, len(joint) - 1)
    # a limb that starts at a root, but does not continue it, is a branch and no stem
    stem = (skeleton.parents[joint[first]] < 0) & (successors[joint[first]] == joint[second])
    radii = np.maximum(skeleton.radii[joint], min_radius)
    parent_radius = np.where(stem, 0.0, radii[first])
    radii[first] = np.where(stem, radii[first], np.minimum(radii[second], 0.95 * radii[first]))
    starts = np.bincount(joint[first][~stem], minlength=len(skeleton))
    parent_direction = np.where(stem[:, None], UP, _directions(skeleton, successors)[joint[first]])
    axes = LimbAxes(skeleton.points[joint], radii, limb, starts[joint] > 0, joint, parent_radius, parent_direction)
    return _without_duplicates(axes, 1e-3 * min_radius)


def simplified(axes: LimbAxes, tolerance: Floats) -> Indices:
    """Return the ascending index of the points that stay when axes are simplified within a tolerance (m,), metres.

    A point goes if the cone between its neighbours is nearer to it than the tolerance, in position and in radius; at a
    fork the distance counts four times, since other limbs start there. The distance of a dropped point is charged to
    its neighbours, so that errors do not add up beyond the tolerance. The ends of limbs stay.
    """
    keep = np.arange(len(axes.limb))
    charged = np.zeros(len(keep))
    weight = np.where(axes.forks, 4.0, 1.0)
    for turn in range(_ROUNDS):
        limb = axes.limb[keep]
        middle = np.flatnonzero((limb[1:-1] == limb[:-2]) & (limb[1:-1] == limb[2:])) + 1
        middle = middle[middle % 2 == turn % 2]
        error = (
            _cone_distances(axes.points, axes.radii, keep[middle - 1], keep[middle], keep[middle + 1])
            + charged[keep[middle]]
        )
        out = middle[error * weight[keep[middle]] < tolerance[keep[middle]]]
        np.maximum.at(charged, keep[out - 1], error[np.isin(middle, out)])
        np.maximum.at(charged, keep[out + 1], error[np.isin(middle, out)])
        keep = np.delete(keep, out)
    return keep


def removal_errors(points: Floats, radii: Floats, limb: Indices) -> Floats:
    """Compute the error (m,), metres, of limbs if a point and all less important ones were removed.

    Points (m, 3) and radii (m,), metres, and the index of their limb (m,), ascending, are as in `LimbAxes`. The error
    is that of the axis or of the radius, whichever is larger, and infinite at a limb's ends.

    Notes
    -----
    The order of removal is that of Douglas and Peucker 1973, run on all limbs at once.
    """
    errors = np.full(len(limb), np.inf)
    start = np.flatnonzero(np.diff(limb, prepend=-1))
    end = np.append(start[1:], len(limb)) - 1
    most = np.full(len(start), np.inf)
    while (open_spans := end - start > 1).any():
        start, end, most = start[open_spans], end[open_spans], most[open_spans]
        between = end - start - 1
        span = np.repeat(np.arange(len(start)), between)
        place = np.arange(len(span)) - (np.cumsum(between) - between - start - 1)[span]
        off = _cone_distances(points, radii, start[span], place, end[span])
        worst = np.lexsort((off, span))[np.cumsum(between) - 1]
        split = place[worst]
        errors[split] = most = np.minimum(most, off[worst])
        start, end, most = np.append(start, split), np.append(split, end), np.append(most, most)
    return errors


def subset(axes: LimbAxes, keep: Indices) -> LimbAxes:
    """Select points by ascending index ``keep`` (j,), with the limbs that they belong to."""
    left, limb = np.unique(axes.limb[keep], return_inverse=True)
    return LimbAxes(
        axes.points[keep],
        axes.radii[keep],
        limb.astype(np.int64),
        axes.forks[keep],
        axes.joint[keep],
        axes.parent_radius[left],
        axes.parent_direction[left],
    )


def _cone_distances(points: Floats, radii: Floats, before: Indices, at: Indices, after: Indices) -> Floats:
    """Distances (j,), metres, of places ``at`` from the cone between two others, in position or in radius."""
    chord = points[after] - points[before]
    offset = points[at] - points[before]
    t = np.clip(np.einsum("ij,ij->i", offset, chord) / np.maximum(np.einsum("ij,ij->i", chord, chord), 1e-30), 0.0, 1.0)
    radius = radii[before] + t * (radii[after] - radii[before])
    aside = np.linalg.norm(offset - t[:, None] * chord, axis=1)
    return np.asarray(np.maximum(aside, np.abs(radius - radii[at])))


def _directions(skeleton: Skeleton, successors: Indices) -> Floats:
    """Return the unit direction (n, 3) of the wood at each joint, from parent to successor; up where both coincide."""
    here = np.arange(len(skeleton))
    before = np.where(skeleton.parents < 0, here, skeleton.parents)
    after = np.where(successors < 0, here, successors)
    chord = skeleton.points[after] - skeleton.points[before]
    length = np.linalg.norm(chord, axis=1, keepdims=True)
    return np.where(length > 0, chord / np.where(length > 0, length, 1.0), UP)


def _without_duplicates(axes: LimbAxes, gap: float) -> LimbAxes:
    """Leave out points closer than ``gap`` to the one before them, then limbs of a single point."""
    step = np.linalg.norm(np.diff(axes.points, axis=0, prepend=np.inf), axis=1)
    is_first = np.diff(axes.limb, prepend=-1) > 0
    keep = np.flatnonzero(is_first | (step >= gap))
    counts = np.bincount(axes.limb[keep], minlength=len(axes.parent_radius))
    keep = keep[counts[axes.limb[keep]] >= 2]
    if keep.size == 0:
        raise ValueError("a skeleton without length has no limbs to build tubes around")
    return subset(axes, keep)
