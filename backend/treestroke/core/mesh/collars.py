"""Where limbs join: root flares, branch collars, and normals that blend from one tube into the next."""

import numpy as np

from treestroke.core.mesh.limb_axes import LimbAxes
from treestroke.core.mesh.rings import Rings
from treestroke.core.mesh.tube_surface import TubeGrid
from treestroke.core.types import Floats, Indices

_LOBES = ((3, 0.4, 0.5), (5, 2.1, 0.8))  # buttresses: (how many around, phase in radians, weight)
_LOBED = 0.42  # swelling 0.8 radii above the root: a flare is what a trunk adds below; a giant tapers above, too
_COLLAR_REACH = 1.6  # height of a collar above the parent's surface, in radii of the limb
_BLEND = 0.85  # weight of the parent's normal where a limb meets the parent's surface


def nearness_to_parent(grid: TubeGrid, rings: Rings, positions: Floats, axes: LimbAxes) -> Floats:
    """Return 1 for vertices (v,) at or below their parent limb's surface, fading to 0 where the collar ends.

    The parent is taken as a straight cylinder through the limb's start. ``positions`` (v, 3), metres, are those without
    a collar. Stems get 0.
    """
    limb = rings.limb[grid.ring]
    offset = _from_parent_axis(positions, limb, axes)
    above = np.linalg.norm(offset, axis=1) - axes.parent_radius[limb]
    near = np.clip(1.0 - above / (_COLLAR_REACH * axes.radii[axes.first][limb]), 0.0, 1.0) ** 2
    # a limb may come near its parent's axis again further out, where it has no collar
    return np.where(axes.is_stem[limb], 0.0, near * rings.swelling[grid.ring])


def collar_widening(limb: Indices, outward: Floats, nearness: Floats, axes: LimbAxes, swelling: float) -> Floats:
    """Compute the share (v,) of its radius by which a limb widens at each vertex near its parent.

    A limb widens more along the parent than beside it (Shigo 1985); one nearly as thick as its parent widens less, and
    never beyond the parent's sides.

    Parameters
    ----------
    limb, outward, nearness
        (v,) index of each vertex's limb, (v, 3) unit direction from its axis, (v,) as `nearness_to_parent` returns it.
    swelling
        Widening of a thin limb along its parent, share of its radius.
    """
    stem = axes.is_stem
    thickness = axes.radii[axes.first] / np.where(stem, np.inf, axes.parent_radius)
    most = swelling * (1.0 - 0.8 * np.minimum(thickness, 1.0))
    beside = np.clip(0.92 / np.maximum(thickness, 1e-9) - 1.0, 0.0, 0.6 * most)
    aligned = np.einsum("ij,ij->i", outward, axes.parent_direction[limb]) ** 2
    return np.asarray(nearness * (beside[limb] + (most - beside)[limb] * aligned))


def flare_widening(grid: TubeGrid, rings: Rings, axes: LimbAxes, root_swelling: float, buttress: float) -> Floats:
    """Compute the share (v,) of its radius by which a stem widens to the ground, in lobes; 0 on branches.

    ``root_swelling`` is the least radius at the root over that of the trunk above its flare, for the stem's own radii
    may show a flare; ``buttress`` is the depth of the lobes over what the flare adds to the trunk's radius.
    """
    limb, root = rings.limb[grid.ring], axes.radii[axes.first]
    share = np.maximum(root_swelling * _radius_above(rings, 0.0) / root - 1.0, 0.0)
    added = np.maximum(1.0 + share - _radius_above(rings, _LOBED) / root, 0.0)
    lobes = sum(weight * np.cos(count * grid.angle_rad + phase) for count, phase, weight in _LOBES)
    widened = share[limb] + buttress * added[limb] * lobes
    return np.where(axes.is_stem[limb], rings.swelling[grid.ring] * widened, 0.0)


def blended_normals(normals: Floats, limb: Indices, positions: Floats, nearness: Floats, axes: LimbAxes) -> Floats:
    """Blend unit normals (v, 3) with those of the parent where a limb meets it, so that no crease is visible.

    ``limb`` (v,) is the index of each vertex's limb, ``positions`` (v, 3) are metres, ``nearness`` (v,) is that of
    `nearness_to_parent`.
    """
    offset = _from_parent_axis(positions, limb, axes)
    length = np.linalg.norm(offset, axis=1, keepdims=True)
    share = np.where(length[:, 0] > 0.5 * axes.parent_radius[limb], _BLEND * nearness, 0.0)[:, None]
    blended = normals * (1.0 - share) + share * offset / np.maximum(length, 1e-12)
    size = np.linalg.norm(blended, axis=1, keepdims=True)
    return np.where(size > 1e-3, blended / np.maximum(size, 1e-3), normals)


def _from_parent_axis(positions: Floats, limb: Indices, axes: LimbAxes) -> Floats:
    """Offset (v, 3), metres, of each position from the axis of its limb's parent, perpendicular to it."""
    offset = positions - axes.points[axes.first][limb]
    axis = axes.parent_direction[limb]
    return np.asarray(offset - np.einsum("ij,ij->i", offset, axis)[:, None] * axis)


def _radius_above(rings: Rings, swelling: float) -> Floats:
    """Radius (k,) of each limb at its first ring of no more ``swelling``, or at its second ring if all have more."""
    above = np.where(rings.swelling <= swelling, np.arange(len(rings.limb)), len(rings.limb))
    index = np.minimum.reduceat(above, rings.first)
    end = np.append(rings.first[1:], len(rings.limb))
    return rings.radii[np.where(index < end, index, np.minimum(rings.first + 1, end - 1))]
