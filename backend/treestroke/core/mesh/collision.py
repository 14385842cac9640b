"""A tree's trunk and main limbs as few closed solids, for what bumps into them."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.frames import rotation_minimizing_normals
from treestroke.core.geometry.mesh import Hold, Mesh
from treestroke.core.geometry.vectors import unit
from treestroke.core.mesh.chains import Chains, chains_of, missed_without, subset
from treestroke.core.skeleton.measure import edge_lengths, generations
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import heaviest_children
from treestroke.core.types import Floats, Indices

MAX_TRIANGLES = 1_000
SIDES = 6
_MOST_GENERATIONS = 2
"""Limbs on limbs of stems still count."""
_LEAST_RADIUS = 0.12
"""Of the thickest wood: thinner wood gives way."""
_STRAIGHT = 0.1
"""Of the thickest wood's radius: how far limbs may miss their joints."""
_BACK = np.array([0.0, 0.0, -1.0])


def collision(skeleton: Skeleton) -> Mesh:
    """Wrap the main wood of a 3D skeleton in closed prisms of 6 sides, one a limb, at most 1,000 triangles in all.

    Wood counts to the second generation of limbs, as far as it is thicker than 12 % of the trunk; the least limbs
    go where there are too many. Prisms hide nearly as much as round limbs, their corners standing a little out.
    Vertices hold to joints of the skeleton.

    Raises
    ------
    ValueError
        The skeleton is not 3D or has no length.
    """
    if skeleton.points.shape[1] != 3:
        raise ValueError(f"a collision mesh needs a 3D skeleton, got {skeleton.points.shape[1]} coordinates")
    left, joints = _main(skeleton)
    chains = _few(chains_of(left, 1e-6 * max(float(skeleton.radii.max()), 1e-6)))
    ring = np.arange(len(chains.limb))
    first = chains.first
    tangents = _tangents(chains)
    normal = rotation_minimizing_normals(chains.points, tangents, first, np.broadcast_to(_BACK, (len(first), 3)))
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    binormal = np.cross(tangents, normal)
    outward = np.cos(angle)[:, None] * normal[:, None] + np.sin(angle)[:, None] * binormal[:, None]
    # A prism of the round limb's own mean breadth.
    radius = chains.radii * np.pi / (SIDES * np.sin(np.pi / SIDES))
    around = chains.points[:, None] + radius[:, None, None] * outward
    ends = np.concatenate([first, chains.last])
    positions = np.concatenate([around.reshape(-1, 3), chains.points[ends]])
    normals = np.concatenate([outward.reshape(-1, 3), tangents[ends] * np.repeat([-1.0, 1.0], len(first))[:, None]])
    held = joints[chains.joint[np.concatenate([np.repeat(ring, SIDES), ends])]]
    return Mesh(
        positions.astype(np.float32),
        normals.astype(np.float32),
        np.zeros((len(positions), 2), dtype=np.float32),
        _triangles(chains),
        hold=Hold(np.stack([held, held], axis=1), np.zeros(len(held))),
    )


def _main(skeleton: Skeleton) -> tuple[Skeleton, Indices]:
    """Take the main wood: its skeleton, and its joints in the whole one."""
    order = generations(skeleton, heaviest_children(skeleton, skeleton.radii))
    roots = skeleton.parents < 0
    main = (order <= _MOST_GENERATIONS) & (skeleton.radii >= _LEAST_RADIUS * skeleton.radii.max())
    for wood in (main, order == 0, np.ones(len(order), dtype=bool)):
        kept = roots | wood
        for joint in np.flatnonzero(~roots).tolist():
            kept[joint] &= kept[skeleton.parents[joint]]
        if edge_lengths(skeleton)[kept].any():
            break
    joints, index = np.flatnonzero(kept), np.cumsum(kept) - 1
    above = skeleton.parents[joints]
    return Skeleton(skeleton.points[joints], skeleton.radii[joints], np.where(above < 0, -1, index[above])), joints


def _few(chains: Chains) -> Chains:
    """Keep as many limbs, the greatest first, and joints, the most bent first, as the triangles suffice for."""
    lengths = np.linalg.norm(np.diff(chains.points, axis=0, append=chains.points[-1:]), axis=1)
    lengths[chains.last] = 0.0
    size = np.bincount(chains.limb, lengths * chains.radii)
    # Two fans and one band: what a straight limb takes.
    most = MAX_TRIANGLES // (4 * SIDES)
    kept = np.isin(chains.limb, np.argsort(-size, kind="stable")[:most])
    chains = subset(chains, np.flatnonzero(kept))
    missed = missed_without(chains.points, chains.radii, chains.limb)
    ends, bent = np.isinf(missed), missed > _STRAIGHT * chains.radii.max()
    spare = (MAX_TRIANGLES - 4 * SIDES * len(chains.bearer)) // (2 * SIDES)
    order = np.argsort(np.where(ends, -np.inf, missed), kind="stable")[::-1][: min(spare, int((bent & ~ends).sum()))]
    return subset(chains, np.union1d(order, np.flatnonzero(ends)))


def _tangents(chains: Chains) -> Floats:
    """Give the unit direction (m, 3) of a limb at each joint."""
    here = np.arange(len(chains.limb))
    before = np.where(np.isin(here, chains.first), here, here - 1)
    after = np.where(np.isin(here, chains.last), here, here + 1)
    return unit(chains.points[after] - chains.points[before], np.array([0.0, 1.0, 0.0]))


def _triangles(chains: Chains) -> NDArray[np.uint32]:
    """Join the rings of each limb, and close them by a fan at each end."""
    column = np.arange(SIDES)
    turned = (column + 1) % SIDES
    low = np.flatnonzero(np.diff(chains.limb) == 0)[:, None] * SIDES
    a, b, c, d = low + column, low + turned, low + SIDES + turned, low + SIDES + column
    middle = len(chains.limb) * SIDES + np.arange(2 * len(chains.first))[:, None] + 0 * column
    foot, tip = (ends[:, None] * SIDES for ends in (chains.first, chains.last))
    k = len(chains.first)
    faces = [(a, b, c), (a, c, d), (middle[:k], foot + turned, foot + column), (middle[k:], tip + column, tip + turned)]
    return np.concatenate([np.stack(face, axis=-1).reshape(-1, 3) for face in faces]).astype(np.uint32)
