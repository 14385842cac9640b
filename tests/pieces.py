"""The pieces that a mesh falls into."""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from treestroke.core.geometry.mesh import Mesh

APART = 0.002
"""Of a mesh's height: what is nearer to each other touches, more or less."""


def touching_pieces(mesh: Mesh) -> int:
    """Count the pieces of a mesh: of shared vertices, and of surfaces that come within `APART` of each other."""
    points = mesh.positions.astype(np.float64)
    cell = APART * float(np.ptp(points, axis=0).max())
    corners = points[mesh.triangles]
    _, vertex = np.unique(np.round(points / (1e-3 * cell)), axis=0, return_inverse=True)
    faces = vertex.reshape(-1)[mesh.triangles]
    welded = _components(faces[:, :2].ravel(), np.repeat(faces[:, 2], 2), int(vertex.max()) + 1)[faces[:, 0]]
    spots, owner = _sampled(corners, cell)
    cells = np.floor(spots / cell).astype(np.int64)
    size = np.ptp(cells, axis=0) + 3
    place = (cells - cells.min(axis=0) + 1) @ (size[1] * size[2], size[2], 1)
    known, at = np.unique(place, return_inverse=True)
    first, second = [welded[owner]], [int(welded.max()) + 1 + at]
    for step in [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) > (0, 0, 0)]:
        near = known + np.dot(step, (size[1] * size[2], size[2], 1))
        there = np.minimum(np.searchsorted(known, near), len(known) - 1)
        both = np.flatnonzero(known[there] == near)
        first.append(int(welded.max()) + 1 + both)
        second.append(int(welded.max()) + 1 + there[both])
    total = int(welded.max()) + 1 + len(known)
    joined = _components(np.concatenate(first), np.concatenate(second), total)
    return len(np.unique(joined[welded]))


def _sampled(corners: np.ndarray, cell: float) -> tuple[np.ndarray, np.ndarray]:
    """Strew spots (n, 3) over triangles (t, 3, 3), a few for each cell, and tell whose they are (n,)."""
    rng = np.random.default_rng(0)
    sides = corners - np.roll(corners, 1, axis=1)
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    wanted = np.maximum(4 * area / cell**2, 4 * np.linalg.norm(sides, axis=2).max(axis=1) / cell)
    owner = np.repeat(np.arange(len(corners)), np.clip(np.ceil(wanted), 4, 1000).astype(np.int64))
    shares = rng.dirichlet(np.ones(3), len(owner))
    return np.einsum("nk,nkd->nd", shares, corners[owner]), owner


def _components(first: np.ndarray, second: np.ndarray, count: int) -> np.ndarray:
    links = coo_matrix((np.ones(len(first)), (first, second)), shape=(count, count))
    return connected_components(links, directed=False)[1]
