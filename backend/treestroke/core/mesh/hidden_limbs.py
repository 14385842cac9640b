"""Limbs inside other wood, and simplified tubes that no longer reach where other limbs start.

Both would break the bark into separate pieces.
"""

import numpy as np

from treestroke.core.geometry.polyline import arc_lengths, places_along
from treestroke.core.mesh.limb_axes import LimbAxes, subset
from treestroke.core.mesh.rings import Rings
from treestroke.core.types import Floats, Indices

_MAX_OFFSET = 0.5  # of a radius: a tube this far off a joint still covers the start of another limb, however few sides


def without_hidden_limbs(axes: LimbAxes) -> LimbAxes:
    """Remove limbs that lie, with all limbs that grow from them, inside other wood."""
    first, last, stem = axes.first, axes.last, axes.is_stem
    continues = np.ones(len(axes.limb), dtype=bool)
    continues[first[~stem]] = False
    limb_of_joint = np.full(int(axes.joint.max()) + 1, -1)
    limb_of_joint[axes.joint[continues]] = axes.limb[continues]
    parent = limb_of_joint[axes.joint[first]]
    thickest = np.maximum.reduceat(axes.radii, first)
    near = _distances(axes.points[last], parent, axes.points, first, last) < thickest[parent]
    host = np.arange(len(first))  # the limb inside which a limb lies; itself if it is visible
    for limb in np.flatnonzero(~stem).tolist():
        around = host[parent[limb]]
        worth_testing = near[limb] or around != parent[limb]
        if worth_testing and _inside(axes, slice(first[limb], last[limb] + 1), slice(first[around], last[around] + 1)):
            host[limb] = around
    kept = host == np.arange(len(first))
    for limb in np.flatnonzero(~stem)[::-1].tolist():
        kept[parent[limb]] |= kept[limb]
    return subset(axes, np.flatnonzero(kept[axes.limb]))


def uncovered_forks(axes: LimbAxes, left: Indices, rings: Rings) -> Indices:
    """Return the index (j,) of dropped points at which limbs start outside the simplified tube.

    ``left`` (i,) is the ascending index of the points that the simplification kept, and the rings stand on the limbs
    through these.
    """
    forks = np.setdiff1d(np.flatnonzero(axes.forks), left)
    last = np.append(rings.first[1:], len(rings.limb)) - 1
    offset = _distances(axes.points[forks], axes.limb[forks], rings.points, rings.first, last)
    return forks[offset > _MAX_OFFSET * axes.radii[forks]]


def _distances(points: Floats, limb: Indices, line: Floats, first: Indices, last: Indices) -> Floats:
    """Distances (j,), metres, of points (j, 3) from their limbs (j,), polylines from first to last index in a line."""
    count = (last - first)[limb]
    start = np.cumsum(count) - count
    point = np.repeat(np.arange(len(points)), count)
    edge = np.arange(len(point)) - start[point] + first[limb][point]
    chord, offset = line[edge + 1] - line[edge], points[point] - line[edge]
    square = np.maximum(np.einsum("ij,ij->i", chord, chord), 1e-30)
    share = np.clip(np.einsum("ij,ij->i", offset, chord) / square, 0.0, 1.0)
    distance = np.linalg.norm(offset - share[:, None] * chord, axis=1)
    return np.minimum.reduceat(distance, start) if len(points) else distance


def _inside(axes: LimbAxes, limb: slice, wood: slice) -> bool:
    """Return whether a limb, with its thickness, lies inside another one's tube."""
    arcs, distance = places_along(axes.points[wood], axes.points[limb])
    around = np.interp(arcs, arc_lengths(axes.points[wood]), axes.radii[wood])
    return bool((distance + axes.radii[limb] < around).all())
