"""Limbs laid end to end in flat arrays, thinned out where they are straight."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import heaviest_children, limbs
from treestroke.core.types import Floats, Indices

_ROUNDS = 8  # of thinning; each drops at most every other joint


@dataclass(frozen=True, eq=False)
class Chains:
    """All limbs of a tree, one after the other.

    ======  ====================================================================
    letter  meaning
    ======  ====================================================================
    m       joints, counting a fork once for each limb that starts or passes there
    k       limbs; each holds at least two joints
    ======  ====================================================================

    Attributes
    ----------
    points
        (m, 3) metres.
    radii
        (m,) metres; a limb's first joint has the limb's own radius, not that of the joint that bears it.
    limb
        (m,) ascending, which limb a joint is of.
    forks
        (m,) bool, whether other limbs start at the joint.
    joint
        (m,) index of the skeleton's joint; a limb's first is that of its bearer.
    bearer
        (k,) radius of the wood that a limb starts in, metres; 0 for a stem.
    bearer_direction
        (k, 3) unit direction of that wood; up for a stem.
    """

    points: Floats
    radii: Floats
    limb: Indices
    forks: NDArray[np.bool_]
    joint: Indices
    bearer: Floats
    bearer_direction: Floats

    @property
    def first(self) -> Indices:
        """Index (k,) of each limb's first joint."""
        return np.flatnonzero(np.diff(self.limb, prepend=-1)).astype(np.int64)

    @property
    def last(self) -> Indices:
        """Index (k,) of each limb's last joint."""
        return np.flatnonzero(np.diff(self.limb, append=self.limb[-1] + 1)).astype(np.int64)


def chains_of(skeleton: Skeleton, thinnest: float) -> Chains:
    """Lay out a 3D skeleton's limbs; the strongest child continues its parent's limb.

    No radius is less than ``thinnest`` (metres, positive); joints within a thousandth of it from the one
    before, and limbs without length, are left out.

    Raises
    ------
    ValueError
        No limb is left, for the skeleton has no length.
    """
    successors = heaviest_children(skeleton, skeleton.radii)
    pieces = limbs(skeleton, successors)
    joint = np.concatenate(pieces)
    limb = np.repeat(np.arange(len(pieces)), [len(piece) for piece in pieces])
    first = np.flatnonzero(np.diff(limb, prepend=-1))
    own = np.minimum(first + 1, len(joint) - 1)
    # a limb that starts at a root, but does not continue it, is a branch and no stem
    stem = (skeleton.parents[joint[first]] < 0) & (successors[joint[first]] == joint[own])
    radii = np.maximum(skeleton.radii[joint], thinnest)
    bearer = np.where(stem, 0.0, radii[first])
    radii[first] = np.where(stem, radii[first], np.minimum(radii[own], 0.95 * radii[first]))
    starts = np.bincount(joint[first][~stem], minlength=len(skeleton))
    direction = np.where(stem[:, None], [0.0, 1.0, 0.0], _directions(skeleton, successors)[joint[first]])
    whole = Chains(skeleton.points[joint], radii, limb, starts[joint] > 0, joint, bearer, direction)
    return _spaced(whole, 1e-3 * thinnest)


def thinned(chains: Chains, tolerance: Floats) -> Indices:
    """List the joints, ascending, without those that the chord of their neighbours misses by less than ``tolerance``.

    The tolerance (m,) is in metres. Forks count four times, for other limbs start there. What a drop moves is charged
    to its neighbours, so that errors do not add up beyond the tolerance. The ends stay.
    """
    keep = np.arange(len(chains.limb))
    charged = np.zeros(len(keep))
    weight = np.where(chains.forks, 4.0, 1.0)
    for turn in range(_ROUNDS):
        limb = chains.limb[keep]
        middle = np.flatnonzero((limb[1:-1] == limb[:-2]) & (limb[1:-1] == limb[2:])) + 1
        middle = middle[middle % 2 == turn % 2]
        missed = (
            _off_cone(chains.points, chains.radii, keep[middle - 1], keep[middle], keep[middle + 1])
            + charged[keep[middle]]
        )
        out = middle[missed * weight[keep[middle]] < tolerance[keep[middle]]]
        np.maximum.at(charged, keep[out - 1], missed[np.isin(middle, out)])
        np.maximum.at(charged, keep[out + 1], missed[np.isin(middle, out)])
        keep = np.delete(keep, out)
    return keep


def missed_without(points: Floats, radii: Floats, limb: Indices) -> Floats:
    """Tell for each place (m,) of limbs how far they miss it without it and all less important ones, metres.

    Points (m, 3), radii (m,) and ``limb`` (m,), ascending, as in `Chains`. The miss is that of the axis or that of the
    radius, and infinite at a limb's ends.

    Notes
    -----
    After Douglas and Peucker 1973, all limbs at once.
    """
    missed = np.full(len(limb), np.inf)
    start = np.flatnonzero(np.diff(limb, prepend=-1))
    end = np.append(start[1:], len(limb)) - 1
    most = np.full(len(start), np.inf)
    while (inner := end - start > 1).any():
        start, end, most = start[inner], end[inner], most[inner]
        between = end - start - 1
        piece = np.repeat(np.arange(len(start)), between)
        place = np.arange(len(piece)) - (np.cumsum(between) - between - start - 1)[piece]
        off = _off_cone(points, radii, start[piece], place, end[piece])
        worst = np.lexsort((off, piece))[np.cumsum(between) - 1]
        split = place[worst]
        missed[split] = most = np.minimum(most, off[worst])
        start, end, most = np.append(start, split), np.append(split, end), np.append(most, most)
    return missed


def _off_cone(points: Floats, radii: Floats, before: Indices, at: Indices, after: Indices) -> Floats:
    """Give how far places ``at`` lie from the cone between their neighbours, in position or in radius."""
    chord = points[after] - points[before]
    way = points[at] - points[before]
    t = np.clip(np.einsum("ij,ij->i", way, chord) / np.maximum(np.einsum("ij,ij->i", chord, chord), 1e-30), 0.0, 1.0)
    thickness = radii[before] + t * (radii[after] - radii[before])
    aside = np.linalg.norm(way - t[:, None] * chord, axis=1)
    return np.asarray(np.maximum(aside, np.abs(thickness - radii[at])))


def _directions(skeleton: Skeleton, successors: Indices) -> Floats:
    """Give the unit direction (n, 3) of the wood at each joint, from its parent to its successor."""
    here = np.arange(len(skeleton))
    before = np.where(skeleton.parents < 0, here, skeleton.parents)
    after = np.where(successors < 0, here, successors)
    way = skeleton.points[after] - skeleton.points[before]
    length = np.linalg.norm(way, axis=1, keepdims=True)
    return np.where(length > 0, way / np.where(length > 0, length, 1.0), [0.0, 1.0, 0.0])


def _spaced(chains: Chains, gap: float) -> Chains:
    """Leave out joints that stand on the one before them, then limbs of a single joint."""
    step = np.linalg.norm(np.diff(chains.points, axis=0, prepend=np.inf), axis=1)
    is_first = np.diff(chains.limb, prepend=-1) > 0
    keep = np.flatnonzero(is_first | (step >= gap))
    counts = np.bincount(chains.limb[keep], minlength=len(chains.bearer))
    keep = keep[counts[chains.limb[keep]] >= 2]
    if keep.size == 0:
        raise ValueError("a skeleton without length has no tubes")
    return subset(chains, keep)


def subset(chains: Chains, keep: Indices) -> Chains:
    """Take joints ``keep``, ascending, with the limbs that they are of."""
    left, limb = np.unique(chains.limb[keep], return_inverse=True)
    return Chains(
        chains.points[keep],
        chains.radii[keep],
        limb.astype(np.int64),
        chains.forks[keep],
        chains.joint[keep],
        chains.bearer[left],
        chains.bearer_direction[left],
    )
