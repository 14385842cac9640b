"""Triangle meshes with textures, as glTF wants them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

ALPHA_CUT = 0.3
"""Alpha below which a texel is not drawn. Viewers' smaller copies of a texture mix leaves with the gaps between: cut at
a half, foliage would thin out with distance."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles with smooth normals and texture coordinates.

    Attributes
    ----------
    positions
        (v, 3) float32, metres, world frame.
    normals
        (v, 3) float32, unit length.
    uvs
        (v, 2) float32; (0, 0) is the texture's top-left corner, v grows downward, as in glTF.
    triangles
        (t, 3) uint32, counter-clockwise seen from outside.
    shades
        (v,) float32 brightness factor, 0 to 1, or None where all are 1.

    Raises
    ------
    ValueError
        Shapes differ or an index is out of range.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    triangles: NDArray[np.uint32]
    shades: NDArray[np.float32] | None = None

    def __post_init__(self) -> None:
        n = len(self.positions)
        if self.positions.shape != (n, 3) or self.normals.shape != (n, 3) or self.uvs.shape != (n, 2):
            raise ValueError("positions, normals and uvs must be (v, 3), (v, 3) and (v, 2)")
        if self.shades is not None and self.shades.shape != (n,):
            raise ValueError(f"{n} vertices need {n} shades, got {self.shades.shape}")
        if self.triangles.ndim != 2 or self.triangles.shape[1] != 3:
            raise ValueError(f"triangles must be (t, 3), got {self.triangles.shape}")
        if self.triangles.size and int(self.triangles.max()) >= n:
            raise ValueError("a triangle names a vertex that does not exist")


@dataclass(frozen=True, eq=False)
class Surface:
    """A mesh and the texture that it wears: (h, w, 3) or, cut at `ALPHA_CUT`, (h, w, 4) uint8, sRGB."""

    mesh: Mesh
    texture: NDArray[np.uint8]
