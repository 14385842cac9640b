"""Bark at a lower level of detail, for a tree that is seen small: fewer, coarser tubes that cover about as much."""

from dataclasses import dataclass, replace

import numpy as np

from treestroke.core.geometry.mesh import Attachment, Mesh
from treestroke.core.mesh.limb_axes import LimbAxes, limb_axes, removal_errors, simplified, subset
from treestroke.core.mesh.rings import Rings, place_rings
from treestroke.core.mesh.tube_surface import TubeGrid
from treestroke.core.mesh.tubes import MIN_RADIUS, TubeParams, tube_mesh
from treestroke.core.skeleton.edit import subskeleton
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import heaviest_children
from treestroke.core.types import Floats, Indices, Mask

LEAST_TRIANGLES = 100
"""About what a single stem takes."""
_TRIES = 4
"""Times that the number of rings is corrected for what flares add and for rings that stand too close."""
_FINE_SIDES = 5
"""Tubes with fewer sides than this are widened to the mean width of a prism with this many."""
_MIN_RADIUS_M = 1e-9
"""Metres: wood without a radius still covers something."""
_FINEST_PX, _BLUNT_PX = 0.05, 1.0
"""Error of the axes before rings are chosen, and least radius of tips that are round."""
_ENOUGH_PX = 0.05
"""Weighted error of a ring below which it does not count when the number of sides is chosen."""
_ROUNDNESS, _MOST_SIDES = (6.0, 4.0, 2.5, 1.2), 12
"""Sides beyond 2 of a tube of 1 px radius, from fine to coarse, growing with the square root of the radius."""
_FLARE = 0.5
"""Widening of a stem by its root flare, about, when the importance of its rings is judged."""
_FAINT = 0.05
"""Least weight of an error of the axis, in px of the wood's radius; the greatest is half a px."""


@dataclass(frozen=True)
class LodParams:
    """Size of the reduced bark.

    Attributes
    ----------
    max_triangles
        Greatest number of triangles, at least `LEAST_TRIANGLES`.
    height_px
        Height at which the tree is seen, px.
    limb_triangles
        Triangles of an average limb: where the budget has fewer for each, the least important limbs are dropped.
    most_thickened
        Greatest factor by which a limb is thickened to make up for dropped ones.
    root_swelling
        As in `TubeParams`.
    """

    max_triangles: int
    height_px: int
    limb_triangles: float = 14.0
    most_thickened: float = 1.3
    root_swelling: float = 1.0

    def __post_init__(self) -> None:
        if self.max_triangles < LEAST_TRIANGLES or self.height_px < 1:
            raise ValueError(f"reduced bark needs {LEAST_TRIANGLES} triangles and 1 px of height, got {self}")
        if self.limb_triangles <= 0 or self.most_thickened < 1:
            raise ValueError(f"limb_triangles must be positive and most_thickened >= 1, got {self}")


def lod_tubes(skeleton: Skeleton, params: LodParams) -> Mesh:
    """Build the bark of a 3D skeleton (metres) from few triangles, as `tubes` does but without collars.

    Limbs that cover least (length times thickness, with all that grow from them) are dropped; limbs of about their
    thickness are widened, so that the tree covers as much as before. Vertices are attached to joints of the whole
    skeleton.

    Raises
    ------
    ValueError
        The skeleton is not 3D or has no length.

    Notes
    -----
    Why silhouettes decide what stays: docs/decisions/0013.
    """
    if skeleton.points.shape[1] != 3:
        raise ValueError(f"tubes need a 3D skeleton, got {skeleton.points.shape[1]} coordinates")
    limb = _limb_of_joint(skeleton)
    covered = 2.0 * edge_lengths(skeleton) * np.maximum(skeleton.radii, _MIN_RADIUS_M)
    area = np.bincount(limb, covered).astype(np.float64)
    order = np.argsort(-_subtree_maxima(skeleton, limb, area), kind="stable")
    # A stem may have no length of its own: then the first limb with length must be kept too.
    least = int((area[order] > 0).argmax()) + 1
    count = min(len(order), max(least, int(params.max_triangles / params.limb_triangles)))
    while True:
        kept = np.zeros(len(area), dtype=bool)
        kept[order[:count]] = True
        radii = _thickened(skeleton, limb, area, kept, params.most_thickened)
        part, joints = subskeleton(replace(skeleton, radii=radii), kept[limb])
        mesh = _fitted(part, params, must_fit=count > least)
        if mesh is not None and mesh.attachment is not None:
            return replace(mesh, attachment=Attachment(joints[mesh.attachment.joints], mesh.attachment.share))
        count = max(least, count * 3 // 4)


def _fitted(skeleton: Skeleton, params: LodParams, must_fit: bool) -> Mesh | None:
    """Build tubes as exact as the triangle budget allows; None where even the least exceed it, if they ``must_fit``."""
    height = max(float(np.ptp(skeleton.points, axis=0).max()), 1e-6)
    pixel = height / params.height_px
    axes = limb_axes(skeleton, MIN_RADIUS * height)
    needed = subset(axes, simplified(axes, np.full(len(axes.limb), _FINEST_PX * pixel)))
    rings = place_rings(needed, 1.0, _BLUNT_PX * pixel, np.inf)
    errors = _weighted_errors(rings, pixel)
    sides = _sides(axes, pixel, rings.limb[errors > _ENOUGH_PX * pixel], params.max_triangles)
    rings = replace(rings, radii=rings.radii * (_width(np.maximum(sides, _FINE_SIDES)) / _width(sides))[rings.limb])
    ends, inner = np.flatnonzero(np.isinf(errors)), np.flatnonzero(np.isfinite(errors))
    order = inner[np.argsort(-errors[inner], kind="stable")]
    cost = np.cumsum(2 * sides[rings.limb[order]])
    allowed, best = params.max_triangles, None
    for _ in range(_TRIES):
        left = rings.select(np.union1d(order[: int(np.searchsorted(cost, allowed, side="right"))], ends))
        grid = TubeGrid.of(left, sides)
        spare = params.max_triangles - len(grid.triangles)
        if spare >= 0 and (best is None or len(grid.triangles) > len(best[1].triangles)):
            best = left, grid
        allowed += spare
    if best is None and not must_fit:
        best = left, grid
    return None if best is None else tube_mesh(best[1], best[0], axes, TubeParams(root_swelling=params.root_swelling))


def _weighted_errors(rings: Rings, pixel: float) -> Floats:
    """Error (r,), metres, of dropping each ring, weighted by the wood's radius; infinite at the ends of tubes."""
    widened = rings.radii * (1.0 + _FLARE * rings.swelling)
    errors = removal_errors(rings.points, widened, rings.limb) * np.clip(rings.radii / pixel, _FAINT, 0.5)
    # A stem's first ring closes it: the second is its foot.
    errors[rings.first + (rings.radii[rings.first] == 0)] = np.inf
    return errors


def _width(sides: Indices) -> Floats:
    """Mean width (k,) of a prism over that of the cylinder around it, by its number of sides (k,)."""
    return np.asarray(sides * np.sin(np.pi / sides) / np.pi)


def _sides(axes: LimbAxes, pixel: float, rings: Indices, most: int) -> Indices:
    """Choose the number of sides (k,) of each limb's tube, as round as the triangles allow for rings on limbs (r,)."""
    thick = np.maximum.reduceat(axes.radii, axes.first) / pixel
    for roundness in _ROUNDNESS:
        sides = np.clip(np.floor(2.0 + roundness * np.sqrt(thick)), 3, _MOST_SIDES).astype(np.int64)
        if 2 * int(sides[rings].sum()) <= most:
            break
    return sides


def _limb_of_joint(skeleton: Skeleton) -> Indices:
    """Index of each joint's limb (n,), a limb after the one that it grows from."""
    successors = heaviest_children(skeleton, skeleton.radii)
    parents = skeleton.parents
    starts = (parents < 0) | (successors[np.maximum(parents, 0)] != np.arange(len(skeleton)))
    limb = np.cumsum(starts) - 1
    for joint in np.flatnonzero(~starts).tolist():
        limb[joint] = limb[parents[joint]]
    return limb.astype(np.int64)


def _subtree_maxima(skeleton: Skeleton, limb: Indices, area: Floats) -> Floats:
    """Greatest area (k,) among each limb and all limbs that grow from it, directly or not."""
    greatest = area.copy()
    joint_parents = skeleton.parents
    first = np.flatnonzero((joint_parents >= 0) & (limb[np.maximum(joint_parents, 0)] != limb))
    for start in first[::-1].tolist():
        parent = limb[joint_parents[start]]
        greatest[parent] = max(greatest[parent], greatest[limb[start]])
    return greatest


def _thickened(skeleton: Skeleton, limb: Indices, area: Floats, kept: Mask, most: float) -> Floats:
    """Radii (n,), metres, at which thin limbs cover what the dropped limbs have covered.

    All wood up to a radius is thickened by one factor, and thicker wood is at least as thick as that then is.
    """
    if kept.all():
        return skeleton.radii
    limb_radius = np.zeros(len(area))
    np.maximum.at(limb_radius, limb, skeleton.radii)
    thin = skeleton.radii <= 2.0 * np.quantile(limb_radius[~kept], 0.9)
    remaining = float((2.0 * edge_lengths(skeleton) * skeleton.radii)[kept[limb] & thin].sum())
    factor = 1.0 + float(area[~kept].sum()) / remaining if remaining > 0 else 1.0
    grown = skeleton.radii * min(factor, most)
    return np.where(thin, grown, np.maximum(skeleton.radii, grown[thin].max(initial=0.0)))
