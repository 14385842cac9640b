"""Directions in which a mesh's texture runs, for textures of normals."""

import numpy as np

from treestroke.core.geometry.mesh import Mesh
from treestroke.core.geometry.vectors import unit
from treestroke.core.types import Floats

_AXES = np.eye(3)


def tangents(mesh: Mesh) -> Floats:
    """Give each vertex the direction in which u grows, at right angles to its normal, and a sign (v, 4).

    The texture's upward direction, in which v falls, is the cross product of normal and tangent times the sign.
    Triangles around a vertex count by their area in the world.

    Notes
    -----
    After Lengyel, "Computing Tangent Space Basis Vectors for an Arbitrary Mesh", 2001.
    """
    points, uvs, corners = mesh.positions.astype(np.float64), mesh.uvs.astype(np.float64), mesh.triangles
    along, across = (points[corners[:, k]] - points[corners[:, 0]] for k in (1, 2))
    (u1, v1), (u2, v2) = ((uvs[corners[:, k]] - uvs[corners[:, 0]]).T[..., None] for k in (1, 2))
    turn = np.sign(u1 * v2 - u2 * v1)
    area = np.linalg.norm(np.cross(along, across), axis=1, keepdims=True)
    rightward = _around(mesh, unit((along * v2 - across * v1) * turn) * area)
    upward = _around(mesh, unit((along * u2 - across * u1) * turn) * area)
    normals = mesh.normals.astype(np.float64)
    flat = rightward - normals * (rightward * normals).sum(axis=1, keepdims=True)
    beside = np.cross(normals, _AXES[np.abs(normals).argmin(axis=1)])
    tangent = unit(unit(flat, beside))
    sign = np.where((np.cross(normals, tangent) * upward).sum(axis=1) < 0, -1.0, 1.0)
    return np.column_stack([tangent, sign])


def _around(mesh: Mesh, of_triangles: Floats) -> Floats:
    """Add up what the triangles at each vertex have (v, 3)."""
    at, values = mesh.triangles.ravel(), np.repeat(of_triangles, 3, axis=0)
    sums = [np.bincount(at, column, minlength=len(mesh.positions)) for column in values.T]
    return np.stack(sums, axis=1)
