"""Tangent frames for normal maps, and where a normal map is large enough to be seen."""

import numpy as np

from treestroke.core.geometry.mesh import Mesh
from treestroke.core.geometry.vectors import unit
from treestroke.core.types import Floats, Mask

MIN_TEXTURE_WIDTH = 0.014
"""Share of a mesh's longest side: where a texture is narrower than this, its normal map is too small to be seen."""
_AXES = np.eye(3)


def tangents(mesh: Mesh) -> Floats:
    """Compute each vertex's tangent (v, 4) as glTF's TANGENT has it: unit direction in which u grows, and a sign.

    The tangent is perpendicular to the vertex normal. The bitangent, against which v runs, is the cross product of
    normal and tangent times the sign, which is 1 or -1. Triangles around a vertex are weighted by their area.

    Notes
    -----
    After Lengyel, "Computing Tangent Space Basis Vectors for an Arbitrary Mesh", 2001.
    """
    points, uvs, corners = mesh.positions.astype(np.float64), mesh.uvs.astype(np.float64), mesh.triangles
    edge1, edge2 = (points[corners[:, k]] - points[corners[:, 0]] for k in (1, 2))
    (u1, v1), (u2, v2) = ((uvs[corners[:, k]] - uvs[corners[:, 0]]).T[..., None] for k in (1, 2))
    winding = np.sign(u1 * v2 - u2 * v1)
    area = np.linalg.norm(np.cross(edge1, edge2), axis=1, keepdims=True)
    along_u = _vertex_sums(mesh, unit((edge1 * v2 - edge2 * v1) * winding) * area)
    against_v = _vertex_sums(mesh, unit((edge1 * u2 - edge2 * u1) * winding) * area)
    normals = mesh.normals.astype(np.float64)
    in_plane = along_u - normals * (along_u * normals).sum(axis=1, keepdims=True)
    any_tangent = np.cross(normals, _AXES[np.abs(normals).argmin(axis=1)])
    tangent = unit(unit(in_plane, any_tangent))
    sign = np.where((np.cross(normals, tangent) * against_v).sum(axis=1) < 0, -1.0, 1.0)
    return np.column_stack([tangent, sign])


def shows_normal_map(mesh: Mesh) -> Mask:
    """Mark the triangles (t,) on which a whole texture would be at least `MIN_TEXTURE_WIDTH` of the mesh wide."""
    points, uvs, corners = mesh.positions.astype(np.float64), mesh.uvs.astype(np.float64), mesh.triangles
    edge1, edge2 = (points[corners[:, k]] - points[corners[:, 0]] for k in (1, 2))
    uv1, uv2 = (uvs[corners[:, k]] - uvs[corners[:, 0]] for k in (1, 2))
    area = np.linalg.norm(np.cross(edge1, edge2), axis=1)
    uv_area = np.abs(uv1[:, 0] * uv2[:, 1] - uv1[:, 1] * uv2[:, 0])
    least_m = MIN_TEXTURE_WIDTH * float(np.ptp(points, axis=0).max())
    return np.asarray(area >= least_m**2 * uv_area)


def _vertex_sums(mesh: Mesh, of_triangles: Floats) -> Floats:
    """Sum vectors of triangles (t, 3) over the triangles at each vertex (v, 3)."""
    corner, values = mesh.triangles.ravel(), np.repeat(of_triangles, 3, axis=0)
    sums = [np.bincount(corner, column, minlength=len(mesh.positions)) for column in values.T]
    return np.stack(sums, axis=1)
