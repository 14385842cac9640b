"""The surface over rings: vertices, triangles, normals and texture coordinates of all tubes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.vectors import unit
from treestroke.core.mesh.rings import Rings
from treestroke.core.types import Floats, Indices

_MIN_GIRTH = 0.3  # of a limb's mean girth: thinner parts stretch the texture instead of compressing it
_GOLDEN = 0.618034  # golden ratio: shifts the texture from limb to limb, so that neighbours do not look alike


@dataclass(frozen=True, eq=False)
class TubeGrid:
    """The vertices and triangles over r rings.

    A ring has one vertex more than it has faces: its first and last share a position but not a texture coordinate.

    Attributes
    ----------
    ring, column
        (v,) index of a vertex's ring, and its number around it.
    faces
        (v,) number of faces around its ring.
    triangles
        (t, 3) uint32 index, counter-clockwise from outside; two for each face, one where a tube closes to a point.
    """

    ring: Indices
    column: Indices
    faces: Indices
    triangles: NDArray[np.uint32]

    @staticmethod
    def of(rings: Rings, sides: Indices) -> "TubeGrid":
        """Lay a grid over r rings; ``sides`` (k,) is the count of faces around each limb."""
        faces = sides[rings.limb]
        ring = np.repeat(np.arange(len(faces)), faces + 1)
        start = np.cumsum(faces + 1) - faces - 1
        return TubeGrid(ring, np.arange(len(ring)) - start[ring], faces[ring], _triangles(rings, faces, start))

    @property
    def angle_rad(self) -> Floats:
        """Angle (v,) around the ring, radians, exactly 0 at its first and its last vertex."""
        return 2.0 * np.pi * (self.column % self.faces) / self.faces


def _triangles(rings: Rings, faces: Indices, start: Indices) -> NDArray[np.uint32]:
    """Join each ring to the next of its limb: triangles (t, 3)."""
    band = np.flatnonzero(np.diff(rings.limb) == 0)
    low = np.repeat(band, faces[band])
    column = np.arange(len(low)) - np.repeat(np.cumsum(faces[band]) - faces[band], faces[band])
    a, c = start[low] + column, start[low + 1] + column
    lower = np.stack([a, a + 1, c + 1], axis=1)
    upper = np.stack([a, c + 1, c], axis=1)
    lower[rings.radii[low + 1] <= 0, 2] -= 1  # a tip's vertices coincide: take the one in the face's own column
    both = np.stack([lower, upper], axis=1)
    real = np.stack([rings.radii[low] > 0, rings.radii[low + 1] > 0], axis=1)
    return both[real].astype(np.uint32)


def smooth_normals(grid: TubeGrid, rings: Rings, positions: Floats) -> Floats:
    """Compute unit normals (v, 3) by central differences of positions (v, 3), metres, around and along the tubes."""
    vertex = np.arange(len(grid.ring))
    start = vertex - grid.column
    right = start + (grid.column + 1) % grid.faces
    left = start + (grid.column - 1) % grid.faces
    same_limb = np.diff(rings.limb) == 0
    has_next = np.append(same_limb, False)[grid.ring]
    # a closed bottom must not tilt the normals of the ring above it
    has_previous = np.append(False, same_limb & (rings.radii[:-1] > 0))[grid.ring]
    step = grid.faces + 1
    along = positions[vertex + step * has_next] - positions[vertex - step * has_previous]
    normals = np.cross(positions[right] - positions[left], along)
    point = rings.radii[grid.ring] <= 0
    bottom = point & has_next
    tip = point & ~has_next
    normals[bottom] = -rings.tangents[grid.ring[bottom]]
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    normals[tip] = normals[vertex[tip] - step[tip]] + rings.tangents[grid.ring[tip]]
    return unit(normals, rings.tangents[grid.ring])


def texture_coordinates(grid: TubeGrid, rings: Rings, positions: Floats, repeats: int, aspect: float) -> Floats:
    """Compute texture coordinates (v, 2), in repeats of the texture, that keep texels square.

    u runs around, ``repeats`` times on the thickest stem; v runs down the limb; ``aspect`` is the texture's height over
    its width. Both are continuous along a limb, except for u at the seam. Positions (v, 3) are metres.
    """
    first, limb = rings.first, rings.limb
    girth = _girths(grid, rings, positions)
    mean = np.add.reduceat(girth, first) / np.maximum(np.add.reduceat((rings.radii > 0).astype(np.float64), first), 1.0)
    around = np.maximum(np.rint(repeats * mean / mean.max()), 1.0)
    girth = np.maximum(girth, _MIN_GIRTH * mean[limb])
    slant = np.hypot(np.linalg.norm(np.diff(rings.points, axis=0), axis=1), np.diff(rings.radii))
    rise = slant * around[limb[1:]] / (0.5 * (girth[1:] + girth[:-1]) * aspect)
    climbed = np.concatenate([[0.0], np.cumsum(np.where(np.diff(limb) == 0, rise, 0.0))])
    shift = _GOLDEN * np.arange(len(first))
    v = shift[limb] - (climbed - climbed[first][limb])
    v -= np.ceil(v[first])[limb]
    u = around[limb[grid.ring]] * grid.column / grid.faces + (shift[limb] % 1.0)[grid.ring]
    return np.stack([u, v[grid.ring]], axis=1)


def _girths(grid: TubeGrid, rings: Rings, positions: Floats) -> Floats:
    """Circumference (r,) of each ring, metres."""
    step = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    inside = np.diff(grid.ring) == 0
    return np.asarray(np.bincount(grid.ring[1:][inside], step[inside], len(rings.limb)), dtype=np.float64)
