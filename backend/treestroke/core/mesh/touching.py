"""What makes bark one piece: no tube stands apart from the one that bears it."""

import numpy as np

from treestroke.core.geometry.polyline import arc_lengths, places_along
from treestroke.core.mesh.chains import Chains, subset
from treestroke.core.mesh.stations import Stations
from treestroke.core.types import Floats, Indices

_MISSED = 0.5  # of a radius: a tube this far off a joint still hides where another limb starts, whatever its sides


def without_hidden(chains: Chains) -> Chains:
    """Leave out limbs that lie, with all that they bear, inside other wood: unseen, and touching nothing."""
    first, last, stem = chains.first, chains.last, chains.bearer == 0
    own = np.ones(len(chains.limb), dtype=bool)
    own[first[~stem]] = False
    limb_of = np.full(int(chains.joint.max()) + 1, -1)
    limb_of[chains.joint[own]] = chains.limb[own]
    bearer = limb_of[chains.joint[first]]
    thickest = np.maximum.reduceat(chains.radii, first)
    near = _distances(chains.points[last], bearer, chains.points, first, last) < thickest[bearer]
    host = np.arange(len(first))
    for limb in np.flatnonzero(~stem).tolist():
        around = host[bearer[limb]]
        tried = near[limb] or around != bearer[limb]
        if tried and _inside(chains, slice(first[limb], last[limb] + 1), slice(first[around], last[around] + 1)):
            host[limb] = around
    kept = host == np.arange(len(first))
    for limb in np.flatnonzero(~stem)[::-1].tolist():
        kept[bearer[limb]] |= kept[limb]
    return subset(chains, np.flatnonzero(kept[chains.limb]))


def missed_forks(chains: Chains, left: Indices, rings: Stations) -> Indices:
    """List the joints that bear limbs but lie off the tubes through the joints left, on which the rings stand."""
    forks = np.setdiff1d(np.flatnonzero(chains.forks), left)
    last = np.append(rings.first[1:], len(rings.limb)) - 1
    away = _distances(chains.points[forks], chains.limb[forks], rings.points, rings.first, last)
    return forks[away > _MISSED * chains.radii[forks]]


def _distances(points: Floats, limb: Indices, line: Floats, first: Indices, last: Indices) -> Floats:
    """Measure how far each point (k, 3) is from a limb (k,), laid from its first to its last place on a line (n, 3)."""
    count = (last - first)[limb]
    start = np.cumsum(count) - count
    which = np.repeat(np.arange(len(points)), count)
    edge = np.arange(len(which)) - start[which] + first[limb][which]
    along, way = line[edge + 1] - line[edge], points[which] - line[edge]
    square = np.maximum(np.einsum("ij,ij->i", along, along), 1e-30)
    share = np.clip(np.einsum("ij,ij->i", way, along) / square, 0.0, 1.0)
    away = np.linalg.norm(way - share[:, None] * along, axis=1)
    return np.minimum.reduceat(away, start) if len(points) else away


def _inside(chains: Chains, own: slice, wood: slice) -> bool:
    """Tell whether a limb, as thick as it is, lies inside another one's tube."""
    arcs, away = places_along(chains.points[wood], chains.points[own])
    around = np.interp(arcs, arc_lengths(chains.points[wood]), chains.radii[wood])
    return bool((away + chains.radii[own] < around).all())
