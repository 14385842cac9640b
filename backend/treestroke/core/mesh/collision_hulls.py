"""A tree's trunk and main limbs as few convex hulls, for physics."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import Attachment, Mesh
from treestroke.core.geometry.vectors import UP, rotation_minimizing_normals, unit
from treestroke.core.mesh.limb_axes import LimbAxes, limb_axes, removal_errors, subset
from treestroke.core.skeleton.edit import subskeleton
from treestroke.core.skeleton.measure import edge_lengths, generations
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import heaviest_children
from treestroke.core.types import Floats, Indices

MAX_TRIANGLES = 1_000
SIDES = 6
_HULL_TRIANGLES = 2 * (2 * SIDES) - 4
"""Triangles of a convex hull around two rings, by Euler's formula."""
_MAX_GENERATION = 2
"""Limbs that grow from limbs of stems are included, thinner orders are not."""
_MIN_RADIUS = 0.12
"""Of the thickest wood: thinner wood gives way."""
_FLATTEST = 1e-4
"""Least radius of a hull, in extents of the tree: flatter ones have no volume in floating point."""
_MAX_ERROR = 0.1
"""Of the thickest wood's radius: distance of a hull's axis from the joints between its ends."""
_MIN_COSINE = 0.5
"""Of the slant of a hexagon against its piece of the axis: 60 degrees."""
_BACK = np.array([0.0, 0.0, -1.0])


def collision_hulls(skeleton: Skeleton) -> Mesh:
    """Build convex hulls around the main wood of a 3D skeleton (metres), one for each straight piece of a limb.

    Wood counts to the second generation of limbs, as far as it is thicker than 12 % of the trunk. A hull spans two
    hexagons, whose mean width is that of the round limb. There are at most 1,000 triangles; smaller limbs and slighter
    bends are dropped first. Vertices are attached to joints of the skeleton. Deterministic.

    Raises
    ------
    ValueError
        The skeleton is not 3D or has no length.

    Notes
    -----
    Hulls by Qhull: Barber, Dobkin and Huhdanpaa, "The Quickhull Algorithm for Convex Hulls", 1996.
    """
    if skeleton.points.shape[1] != 3:
        raise ValueError(f"collision hulls need a 3D skeleton, got {skeleton.points.shape[1]} coordinates")
    wood, joints = _main_wood(skeleton)
    extent = float(np.ptp(wood.points, axis=0).max())
    axes = _reduced(limb_axes(wood, max(_FLATTEST * extent, 1e-12)))
    start = np.flatnonzero(np.diff(axes.limb) == 0)
    ends = np.stack([start, start + 1], axis=1)
    outward = _hexagons(axes, ends)
    # A prism with the mean width of the round limb.
    radius = axes.radii * np.pi / (SIDES * np.sin(np.pi / SIDES))
    corners = axes.points[ends][:, :, None] + radius[ends][:, :, None, None] * outward
    attached = np.repeat(joints[axes.joint[ends]].ravel(), SIDES)
    return Mesh(
        corners.reshape(-1, 3).astype(np.float32),
        outward.reshape(-1, 3).astype(np.float32),
        np.zeros((len(attached), 2), dtype=np.float32),
        _hull_triangles(corners.reshape(len(start), 2 * SIDES, 3)),
        attachment=Attachment(np.stack([attached, attached], axis=1), np.zeros(len(attached))),
    )


def _main_wood(skeleton: Skeleton) -> tuple[Skeleton, Indices]:
    """Select the main wood: its skeleton, and the index of its joints in the whole one."""
    order = generations(skeleton, heaviest_children(skeleton, skeleton.radii))
    roots = skeleton.parents < 0
    main = (order <= _MAX_GENERATION) & (skeleton.radii >= _MIN_RADIUS * skeleton.radii.max())
    for wood in (main, order == 0, np.ones(len(order), dtype=bool)):
        kept = roots | wood
        for joint in np.flatnonzero(~roots).tolist():
            kept[joint] &= kept[skeleton.parents[joint]]
        if edge_lengths(skeleton)[kept].any():
            break
    return subskeleton(skeleton, kept)


def _reduced(axes: LimbAxes) -> LimbAxes:
    """Keep the limbs of greatest area, and their most important points, that the triangles suffice for."""
    lengths = np.linalg.norm(np.diff(axes.points, axis=0, append=axes.points[-1:]), axis=1)
    lengths[axes.last] = 0.0
    area = np.bincount(axes.limb, lengths * axes.radii)
    most = MAX_TRIANGLES // _HULL_TRIANGLES
    kept = np.isin(axes.limb, np.argsort(-area, kind="stable")[:most])
    axes = subset(axes, np.flatnonzero(kept))
    errors = removal_errors(axes.points, axes.radii, axes.limb)
    ends, bends = np.isinf(errors), errors > _MAX_ERROR * axes.radii.max()
    spare = min(most - len(axes.parent_radius), int((bends & ~ends).sum()))
    order = np.argsort(np.where(ends, -np.inf, errors), kind="stable")[::-1][:spare]
    return subset(axes, np.union1d(order, np.flatnonzero(ends)))


def _hexagons(axes: LimbAxes, ends: Indices) -> Floats:
    """Return unit directions (p, 2, 6, 3) from both ends (p, 2) of each piece of the axes to its hexagons' corners.

    A hexagon halves the bend between two pieces, unless that would slant it by more than 60 degrees.
    """
    here = np.arange(len(axes.limb))
    before = np.where(np.isin(here, axes.first), here, here - 1)
    after = np.where(np.isin(here, axes.last), here, here + 1)
    halving = unit(axes.points[after] - axes.points[before], UP)[ends]
    along = unit(axes.points[ends[:, 1]] - axes.points[ends[:, 0]], UP)[:, None]
    tangents = np.where((halving * along).sum(axis=2, keepdims=True) >= _MIN_COSINE, halving, along).reshape(-1, 3)
    seeds = np.broadcast_to(_BACK, (len(ends), 3))
    first = 2 * np.arange(len(ends))
    normal = rotation_minimizing_normals(axes.points[ends].reshape(-1, 3), tangents, first, seeds)
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    binormal = np.cross(tangents, normal)
    outward = np.cos(angle)[:, None] * normal[:, None] + np.sin(angle)[:, None] * binormal[:, None]
    return np.asarray(outward.reshape(-1, 2, SIDES, 3))


def _hull_triangles(corners: Floats) -> NDArray[np.uint32]:
    """Triangles (t, 3) of the convex hull of each group of corners (p, c, 3), counter-clockwise from outside."""
    from scipy.spatial import ConvexHull  # imported here: it takes half a second, and most trees need no hulls

    groups = []
    for group, points in enumerate(corners):
        hull = ConvexHull(points)
        a, b, c = (points[hull.simplices[:, k]] for k in range(3))
        inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
        faces = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
        groups.append(faces + group * corners.shape[1])
    return np.concatenate(groups).astype(np.uint32)
