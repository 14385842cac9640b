"""The skeleton along centre lines: smooth, with radii that taper."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.optimize import isotonic_regression
from scipy.spatial import cKDTree

from treestroke.core.lift.centre_lines import CentreLines
from treestroke.core.lift.limb_radii import limb_radii
from treestroke.core.lift.point_graph import PointGraph
from treestroke.core.lift.ridge_fit import fitted
from treestroke.core.lift.thin_hull import ShownArea
from treestroke.core.lift.tips import lengthened
from treestroke.core.skeleton.edit import subskeleton
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

SMOOTHING = 2.5
"""Standard deviation of the smoothing along a path, in units of the graph: cells are steps, limbs are not."""
JOINT_STEP = 2.5
"""Distance between joints, in units of the graph."""
GUESS = 0.5
"""What a length that is not seen costs, relative to what one that is seen is worth."""
ENOUGH_WIDTHS = 3
"""Joints of a path whose widths are known from which on these alone tell its radii."""
SURE_QUANTILES = 0.1, 0.3
"""Which of the radii tell where no shot shows a limb by itself: it lies within what all of them show."""
FREE = 0.4
"""Share of the shots that show a limb free of leaves from which on it is measured by the tree's silhouette."""
THINNEST = 0.15
"""Least radius, in units of the graph."""


@dataclass(frozen=True, eq=False)
class _Laid:
    """Joints (n, 3), metres, whether each is seen (n,), its parent (n,) and the number of its path (n,)."""

    points: Floats
    seen: Mask
    parents: Indices
    owner: Indices


def path_skeleton(
    graph: PointGraph, lines: CentreLines, kept: Mask, wood: Sequence[ShownArea], bare: bool
) -> tuple[Skeleton, Mask]:
    """Lay a skeleton (3D, metres) along the paths (k,) that are ``kept``, and tell which joints (n,) are seen.

    Radii are those that the shots show of the ``wood``. Joints are moved to its middle there, and tips go on, on a
    ``bare`` tree; amid leaves its outlines are too often theirs (a leafy oak lost true branches), so that in a crown
    only limbs that stand free of leaves in many shots, the trunk above all, are moved to the middle of the silhouette.

    The first joint is the root of the graph. A path that leads over more that is not seen than it shows is left out.
    """
    points, seen, parents, owner = [np.zeros((1, 3))], [np.ones(1, dtype=np.bool_)], [-1], [0]
    for number in np.flatnonzero(kept).tolist():
        line, shown = _joints(graph, lines.paths[number])
        join = _join(np.concatenate(points), np.array(owner), int(lines.parents[number]), line[0])
        parents += [join, *range(len(owner), len(owner) + len(line) - 2)]
        owner += [number] * (len(line) - 1)
        points.append(line[1:])
        seen.append(shown[1:])
    least = THINNEST * graph.unit
    first = _Laid(np.concatenate(points), np.concatenate(seen), np.array(parents), np.array(owner))
    if not bare:
        return _without_guesses(_fitted_where_free(first, wood, least), first.seen)
    laid = _lengthened(first, wood, graph.unit, least)
    return _without_guesses(_fitted(laid, wood, least), laid.seen)


def _fitted(laid: _Laid, wood: Sequence[ShownArea], least: float) -> Skeleton:
    """Return the skeleton with its joints in the middle of the wood, and radii by how wide that is."""
    tree, widths = fitted(Skeleton(laid.points, _radii(laid, wood, least), laid.parents), wood)
    measured = np.where(laid.seen, limb_radii(tree.points, wood, SURE_QUANTILES), 0.0)
    radii = _tapering(_told(widths * laid.seen, measured, laid.owner), tree.parents, laid.owner, least)
    return Skeleton(tree.points, radii, tree.parents)


def _fitted_where_free(laid: _Laid, wood: Sequence[ShownArea], least: float) -> Skeleton:
    """Return the skeleton with the joints of limbs that stand free in the middle of the tree's silhouette."""
    silhouettes = [replace(area, shown=area.tree) for area in wood]
    tree, widths = fitted(Skeleton(laid.points, _radii(laid, wood, least), laid.parents), silhouettes, FREE)
    measured = np.where(widths > 0, widths, limb_radii(tree.points, wood))
    radii = _tapering(np.where(laid.seen, measured, 0.0), tree.parents, laid.owner, least)
    return Skeleton(tree.points, radii, tree.parents)


def _joints(graph: PointGraph, path: Indices) -> tuple[Floats, Mask]:
    """Lay joints (m, 3) along a path, and tell whether each is seen (m,)."""
    line, at = graph.points[path], np.zeros(len(path))
    at[1:] = np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))
    fine = np.linspace(0, at[-1], max(int(np.ceil(at[-1] / graph.unit)), 1) + 1)
    place = np.stack([np.interp(fine, at, column) for column in line.T], axis=1)
    smooth = gaussian_filter1d(place, SMOOTHING, axis=0, mode="nearest")
    near_end = np.minimum(np.arange(len(fine)), np.arange(len(fine))[::-1])[:, None] / (2 * SMOOTHING)
    place = np.where(near_end < 1, near_end * smooth + (1 - near_end) * place, smooth)
    shown = graph.seen[path][np.searchsorted(at, fine - 1e-9)]
    chosen = np.unique(np.rint(np.linspace(0, len(fine) - 1, max(round(len(fine) / JOINT_STEP), 1) + 1)).astype(int))
    return place[chosen], shown[chosen]


def _join(points: Floats, owner: Indices, parent: int, place: Floats) -> int:
    """Return the joint of the parent path that is nearest to a place (3,), metres; the root without one."""
    own = np.flatnonzero(owner == parent)
    return int(own[cKDTree(points[own]).query(place)[1]]) if parent >= 0 else 0


def _radii(laid: _Laid, wood: Sequence[ShownArea], least: float) -> Floats:
    """Return tapering radii (n,), metres, by how far joints lie within the wood."""
    measured = np.where(laid.seen, limb_radii(laid.points, wood), 0.0)
    return _tapering(measured, laid.parents, laid.owner, least)


def _lengthened(laid: _Laid, wood: Sequence[ShownArea], unit_m: float, least: float) -> _Laid:
    """Let the paths go on while enough shots show it."""
    count = len(laid.points)
    ends = np.flatnonzero((np.bincount(laid.parents[1:], minlength=count) == 0) & laid.seen)
    points, parents, whose = lengthened(
        Skeleton(laid.points, _radii(laid, wood, least), laid.parents), ends, wood, unit_m
    )
    return _Laid(
        np.concatenate([laid.points, points]),
        np.concatenate([laid.seen, np.ones(len(points), dtype=np.bool_)]),
        np.concatenate([laid.parents, parents]),
        np.concatenate([laid.owner, laid.owner[whose]]),
    )


def _told(widths: Floats, measured: Floats, owner: Indices) -> Floats:
    """Return the radii (n,) by ``widths``, 0 where unknown; of a path with too few of them those ``measured`` instead.

    Where other wood stands beside a limb, as at its fork, they measure that, too.
    """
    known = np.bincount(owner, weights=widths > 0)
    return np.where(known[owner] >= ENOUGH_WIDTHS, widths, measured)


def _tapering(measured: Floats, parents: Indices, owner: Indices, least: float) -> Floats:
    """Fit radii (n,) that fall along each path to those measured, 0 where unknown; no joint is thicker than its parent.

    Along a path of unknown radius it is that of the joint it leaves, or ``least``, metres.
    """
    radii = np.full(len(measured), least)
    for path in np.unique(owner).tolist():
        joints = np.flatnonzero(owner == path)
        known = np.flatnonzero(measured[joints] > 0)
        if len(known):
            fitted = isotonic_regression(measured[joints[known]], increasing=False).x
            radii[joints] = np.maximum(np.interp(np.arange(len(joints)), known, fitted), least)
    for joint, parent in enumerate(parents.tolist()):
        if parent >= 0:
            radii[joint] = min(radii[joint], radii[parent])
    return radii


def _without_guesses(tree: Skeleton, seen: Mask) -> tuple[Skeleton, Mask]:
    """Leave out what leads to less seen wood than it guesses."""
    worth, parents = np.where(seen, 1.0, -GUESS) * edge_lengths(tree), tree.parents.tolist()
    total = worth.tolist()
    for joint in range(len(tree) - 1, 0, -1):
        total[parents[joint]] += max(total[joint], 0.0)
    kept = [True] + [value > 0 for value in total[1:]]
    for joint in range(1, len(tree)):
        kept[joint] &= kept[parents[joint]]
    part, joints = subskeleton(tree, np.array(kept))
    return part, seen[joints]
