"""Parts of a mesh."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import Hold, Mesh

LEAST_RELIEF = 0.014
"""Of a mesh's longest side: where a texture's width measures less, its relief is too small to be seen."""


def shows_relief(mesh: Mesh) -> NDArray[np.bool_]:
    """Tell on which triangles (t,) a texture is laid so large that the relief on it can be seen."""
    points, uvs, corners = mesh.positions.astype(np.float64), mesh.uvs.astype(np.float64), mesh.triangles
    first, second = (points[corners[:, k]] - points[corners[:, 0]] for k in (1, 2))
    along, across = (uvs[corners[:, k]] - uvs[corners[:, 0]] for k in (1, 2))
    area = np.linalg.norm(np.cross(first, second), axis=1)
    covered = np.abs(along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0])
    least = LEAST_RELIEF * float(np.ptp(points, axis=0).max())
    return np.asarray(area >= least**2 * covered)


def part_of(mesh: Mesh, kept: NDArray[np.bool_]) -> tuple[Mesh, NDArray[np.int64]]:
    """Keep the marked triangles (t,) and the vertices that they need: the part, and those vertices' old numbers."""
    vertices, numbers = np.unique(mesh.triangles[kept], return_inverse=True)
    part = Mesh(
        mesh.positions[vertices],
        mesh.normals[vertices],
        mesh.uvs[vertices],
        numbers.reshape(-1, 3).astype(np.uint32),
        None if mesh.shades is None else mesh.shades[vertices],
        None if mesh.hold is None else Hold(mesh.hold.joints[vertices], mesh.hold.share[vertices]),
    )
    return part, vertices.astype(np.int64)
