"""Triangle meshes with textures, as glTF wants them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

ALPHA_CUT = 0.3
"""Alpha below which a texel is not drawn. Viewers' smaller copies of a texture mix leaves with the gaps between: cut at
a half, foliage would thin out with distance."""


@dataclass(frozen=True, eq=False)
class Hold:
    """Where on a skeleton each vertex hangs, so that it moves with it.

    Attributes
    ----------
    joints
        (v, 2) two joints of one limb.
    share
        (v,) how far from the first of them to the second, 0 to 1.
    """

    joints: NDArray[np.int64]
    share: NDArray[np.float64]

    def __post_init__(self) -> None:
        if self.joints.shape != (len(self.share), 2) or self.share.ndim != 1:
            raise ValueError(f"joints and share must be (v, 2) and (v,), got {self.joints.shape}, {self.share.shape}")


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
    hold
        Where each vertex hangs, or None where nothing moves it.

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
    hold: Hold | None = None

    def __post_init__(self) -> None:
        n = len(self.positions)
        if self.positions.shape != (n, 3) or self.normals.shape != (n, 3) or self.uvs.shape != (n, 2):
            raise ValueError("positions, normals and uvs must be (v, 3), (v, 3) and (v, 2)")
        if self.shades is not None and self.shades.shape != (n,):
            raise ValueError(f"{n} vertices need {n} shades, got {self.shades.shape}")
        if self.hold is not None and len(self.hold.share) != n:
            raise ValueError(f"{n} vertices need a hold of as many, got {len(self.hold.share)}")
        if self.triangles.ndim != 2 or self.triangles.shape[1] != 3:
            raise ValueError(f"triangles must be (t, 3), got {self.triangles.shape}")
        if self.triangles.size and int(self.triangles.max()) >= n:
            raise ValueError("a triangle names a vertex that does not exist")


@dataclass(frozen=True, eq=False)
class Surface:
    """A mesh and what it wears.

    Attributes
    ----------
    mesh
        The triangles.
    texture
        (h, w, 3) or, cut at `ALPHA_CUT`, (h, w, 4) uint8, sRGB; sides are powers of two.
    relief
        (h, w, 3) uint8 normals in the texture's own frame, as glTF's normal textures (x right, y up, z out; 128 is 0),
        or None where the surface is smooth.
    """

    mesh: Mesh
    texture: NDArray[np.uint8]
    relief: NDArray[np.uint8] | None = None
