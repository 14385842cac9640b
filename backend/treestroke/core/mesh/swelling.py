"""Where limbs join: root flares, branch collars and shading that runs over from one tube to the next."""

import numpy as np

from treestroke.core.mesh.chains import Chains
from treestroke.core.mesh.stations import Stations
from treestroke.core.mesh.tube_surface import Grid
from treestroke.core.types import Floats, Indices

_LOBES = ((3, 0.4, 0.5), (5, 2.1, 0.8))  # buttresses: (how many around, phase, weight)
_COLLAR_REACH = 1.6  # how far a collar reaches above its bearer's surface, in radii of the limb
_MERGE = 0.85  # how much of the bearer's normal a limb takes on where it meets the bearer's surface


def nearness_to_bearer(grid: Grid, rings: Stations, positions: Floats, chains: Chains) -> Floats:
    """Give 1 for vertices (v,) at or below their bearer's surface, fading to 0 where the collar ends; 0 on stems.

    The bearer is taken as a straight cylinder through the limb's start, ``positions`` (v, 3) without collar.
    """
    limb = rings.limb[grid.ring]
    stem = chains.bearer == 0
    aside = _from_axis(positions, limb, chains)
    above = np.linalg.norm(aside, axis=1) - chains.bearer[limb]
    near = np.clip(1.0 - above / (_COLLAR_REACH * chains.radii[chains.first][limb]), 0.0, 1.0) ** 2
    # a limb may come near its bearer's axis again further out, where it has no collar
    return np.where(stem[limb], 0.0, near * rings.swell[grid.ring])


def collar(limb: Indices, outward: Floats, nearness: Floats, chains: Chains, swelling: float) -> Floats:
    """Share (v,) by which limbs widen near their bearers, more along the bearer than beside it.

    A limb nearly as thick as its bearer widens less, and must not stick out beside it.
    """
    stem = chains.bearer == 0
    thickness = chains.radii[chains.first] / np.where(stem, np.inf, chains.bearer)
    most = swelling * (1.0 - 0.8 * np.minimum(thickness, 1.0))
    beside = np.clip(0.92 / np.maximum(thickness, 1e-9) - 1.0, 0.0, 0.6 * most)
    aligned = np.einsum("ij,ij->i", outward, chains.bearer_direction[limb]) ** 2
    return np.asarray(nearness * (beside[limb] + (most - beside)[limb] * aligned))


def flare(grid: Grid, rings: Stations, chains: Chains, root_swelling: float, buttress: float) -> Floats:
    """Share (v,) by which stems widen to the ground, in lobes; 0 on branches.

    The swelling is measured against the trunk above it, for a photo may show a flare already.
    """
    limb = rings.limb[grid.ring]
    wanted = root_swelling * _above_flare(rings) / chains.radii[chains.first]
    lobes = sum(weight * np.cos(count * grid.angle_rad + phase) for count, phase, weight in _LOBES)
    share = np.maximum(wanted - 1.0, 0.0)[limb] + buttress * lobes
    return np.where((chains.bearer == 0)[limb], rings.swell[grid.ring] * share, 0.0)


def merged_normals(normals: Floats, limb: Indices, positions: Floats, nearness: Floats, chains: Chains) -> Floats:
    """Turn normals (v, 3) to those of the bearer where a limb meets it, so that no crease shows."""
    aside = _from_axis(positions, limb, chains)
    length = np.linalg.norm(aside, axis=1, keepdims=True)
    share = np.where(length[:, 0] > 0.5 * chains.bearer[limb], _MERGE * nearness, 0.0)[:, None]
    turned = normals * (1.0 - share) + share * aside / np.maximum(length, 1e-12)
    size = np.linalg.norm(turned, axis=1, keepdims=True)
    return np.where(size > 1e-3, turned / np.maximum(size, 1e-3), normals)


def _from_axis(positions: Floats, limb: Indices, chains: Chains) -> Floats:
    """Give the way (v, 3) to each position from the axis of its limb's bearer, square to it."""
    way = positions - chains.points[chains.first][limb]
    axis = chains.bearer_direction[limb]
    return np.asarray(way - np.einsum("ij,ij->i", way, axis)[:, None] * axis)


def _above_flare(rings: Stations) -> Floats:
    """Radius (k,) of each limb at its first ring above its flare, or at its second ring if all are in it."""
    past = np.where(rings.swell <= 0, np.arange(len(rings.limb)), len(rings.limb))
    index = np.minimum.reduceat(past, rings.first)
    end = np.append(rings.first[1:], len(rings.limb))
    return rings.radii[np.where(index < end, index, np.minimum(rings.first + 1, end - 1))]
