"""Triangle meshes, what ties them to a skeleton, and the textures on them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Indices, Mask

ALPHA_CUT = 0.3
"""Alpha below which a texel is not drawn. Viewers' smaller copies of a texture mix leaves with the gaps between: cut at
a half, foliage would thin out with distance."""


@dataclass(frozen=True, eq=False)
class Attachment:
    """The place on a skeleton that each vertex moves with, for binding it to bones.

    Attributes
    ----------
    joints
        (v, 2) index of two joints of one limb.
    share
        (v,) position between them, 0 at the first to 1 at the second.
    """

    joints: Indices
    share: Floats

    def __post_init__(self) -> None:
        if self.joints.shape != (len(self.share), 2) or self.share.ndim != 1:
            raise ValueError(f"joints and share must be (v, 2) and (v,), got {self.joints.shape}, {self.share.shape}")


@dataclass(frozen=True, eq=False)
class Mesh:
    """Indexed triangles with vertex attributes, laid out as glTF 2.0 has them.

    Attributes
    ----------
    positions
        (v, 3) float32, metres, world frame.
    normals
        (v, 3) float32, unit length.
    uvs
        (v, 2) float32; (0, 0) is the texture's top-left corner, v grows downward.
    triangles
        (t, 3) uint32, counter-clockwise seen from outside.
    shades
        (v,) float32 brightness factor, 0 to 1, or None where all are 1.
    attachment
        The place on the skeleton of each vertex, or None for a mesh that never moves.

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
    attachment: Attachment | None = None

    def __post_init__(self) -> None:
        n = len(self.positions)
        if self.positions.shape != (n, 3) or self.normals.shape != (n, 3) or self.uvs.shape != (n, 2):
            raise ValueError("positions, normals and uvs must be (v, 3), (v, 3) and (v, 2)")
        if self.shades is not None and self.shades.shape != (n,):
            raise ValueError(f"{n} vertices need {n} shades, got {self.shades.shape}")
        if self.attachment is not None and len(self.attachment.share) != n:
            raise ValueError(f"{n} vertices need {n} attachments, got {len(self.attachment.share)}")
        if self.triangles.ndim != 2 or self.triangles.shape[1] != 3:
            raise ValueError(f"triangles must be (t, 3), got {self.triangles.shape}")
        if self.triangles.size and int(self.triangles.max()) >= n:
            raise ValueError("a triangle refers to a vertex that does not exist")


@dataclass(frozen=True, eq=False)
class Surface:
    """A mesh and the textures on it.

    Attributes
    ----------
    mesh
        The triangles.
    texture
        (h, w, 3) opaque, or (h, w, 4) with straight alpha, cut at `ALPHA_CUT`; uint8, sRGB; sides are powers of two.
    normal_map
        (h, w, 3) uint8 tangent-space normals as glTF's normal textures encode them (x right, y up, z out; 128 is 0),
        or None for a smooth surface.
    """

    mesh: Mesh
    texture: NDArray[np.uint8]
    normal_map: NDArray[np.uint8] | None = None


def submesh(mesh: Mesh, kept: Mask) -> tuple[Mesh, Indices]:
    """Select triangles of a mesh by a mask (t,), with the vertices that they use.

    Returns
    -------
    The part, and the index (k,) in the whole mesh of each of its vertices, ascending.
    """
    vertices, numbers = np.unique(mesh.triangles[kept], return_inverse=True)
    attachment = mesh.attachment
    part = Mesh(
        mesh.positions[vertices],
        mesh.normals[vertices],
        mesh.uvs[vertices],
        numbers.reshape(-1, 3).astype(np.uint32),
        None if mesh.shades is None else mesh.shades[vertices],
        None if attachment is None else Attachment(attachment.joints[vertices], attachment.share[vertices]),
    )
    return part, vertices.astype(np.int64)
