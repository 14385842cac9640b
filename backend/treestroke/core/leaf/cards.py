"""Leaves as triangles: two for each card, the halves of its fold."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import Attachment, Mesh
from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.leaf.leaves import Leaves, fruit_among
from treestroke.core.paint.atlas import Atlas
from treestroke.core.types import Floats

CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
"""Corners of a card in half-extents, counter-clockwise from its lower left: x right, y up."""
RIDGE = np.array([1.0, -1.0, 1.0, -1.0])
"""Whether a corner lies on the card's fold, before its flat middle, or behind it; the other way round if mirrored."""
HALVES = np.array([[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]], dtype=np.uint32)
"""Triangles on both sides of the fold: of a card, and of a mirrored one."""
ROUNDNESS = 0.6
"""Weight of the direction out of the crown in a normal, against the card's own: the crown is shaded as a volume."""


def cards(leaves: Leaves, atlas: Atlas) -> Mesh:
    """Build two triangles a card (4 vertices each), metres, in the order of the leaves.

    Normals lean out of the crown, whose middle is that of the cards; they differ between a card's corners, so that a
    clump looks round. Shades become vertex brightness. A card is attached to its own joint.
    """
    m = len(leaves)
    corners = leaves.centres[:, None] + CORNERS[:, :1] * leaves.rights[:, None] + CORNERS[:, 1:] * leaves.ups[:, None]
    ridge = RIDGE * np.where(leaves.flips, -1.0, 1.0)[:, None] * ~fruit_among(leaves, atlas)[:, None]
    positions = (corners + ridge[..., None] * leaves.ridges(atlas.fold)[:, None]).reshape(-1, 3)
    first = 4 * np.arange(m, dtype=np.uint32)[:, None, None]
    triangles = (first + HALVES[leaves.flips.astype(np.int64)]).reshape(-1, 3)
    normals = _normals(leaves, corners.reshape(-1, 3)) if m else positions
    return Mesh(
        positions.astype(np.float32),
        normals.astype(np.float32),
        _uvs(leaves, atlas),
        triangles,
        np.repeat(leaves.shades, 4).astype(np.float32),
        Attachment(np.repeat(leaves.joints, 8).reshape(-1, 2), np.zeros(4 * m)),
    )


def _normals(leaves: Leaves, positions: Floats) -> Floats:
    """Blend each card's normal with the direction out of the crown's ellipsoid: (4 m, 3), unit length."""
    low, high = leaves.centres.min(axis=0), leaves.centres.max(axis=0)
    outward = unit((positions - (low + high) / 2) / np.maximum((high - low) / 2, 1e-6))
    facing = np.repeat(unit(np.cross(leaves.rights, leaves.ups), UP), 4, axis=0)
    return unit(ROUNDNESS * outward + (1 - ROUNDNESS) * facing, UP)


def _uvs(leaves: Leaves, atlas: Atlas) -> NDArray[np.float32]:
    """Texture coordinates (4 m, 2), 0 to 1: the corners of the tile's box, mirrored where the card is flipped."""
    left, top, right, bottom = atlas.boxes[leaves.tiles].T
    left, right = np.where(leaves.flips, right, left), np.where(leaves.flips, left, right)
    u, v = np.stack([left, right, right, left], axis=1), np.stack([bottom, bottom, top, top], axis=1)
    return np.stack([u, v], axis=2).reshape(-1, 2).astype(np.float32)
