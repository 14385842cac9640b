"""A tree as binary PLY: coloured vertices, triangles that say whether they are wood or leaf."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import ALPHA_CUT, Surface
from treestroke.core.leaf.cards import cards as card_mesh
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.paint.atlas import Atlas, tile_alphas
from treestroke.core.types import Floats

BARK, LEAF = 0, 1
"""Labels of the faces."""
_VERTEX = np.dtype([(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")] + [("rgb", "u1", 3)])
_FACE = np.dtype([("count", "u1"), ("corners", "<i4", 3), ("label", "u1")])
_HEAD = """ply
format binary_little_endian 1.0
comment treestroke: metres, right-handed, +Y up; label 0 bark, 1 leaf
element vertex {vertices}
property float x
property float y
property float z
property float nx
property float ny
property float nz
property uchar red
property uchar green
property uchar blue
element face {faces}
property list uchar int vertex_indices
property uchar label
end_header
"""
_GAMMA = 2.2
"""Shades are factors on light, colours are sRGB."""


def encode_ply(bark: Surface, cards: Leaves | None, atlas: Atlas | None) -> bytes:
    """Write a tree as one binary little-endian PLY.

    Vertices have normals and 8-bit sRGB colours; faces a ``label``, 0 bark, 1 leaf. A card becomes a rhombus of two
    triangles, as tall as its spray and of the area of the spray's opaque part, in the tile's mean colour.
    """
    mesh = bark.mesh
    parts = [(_vertices(mesh.positions, mesh.normals, _bark_colours(bark)), _faces(mesh.triangles, BARK))]
    if cards is not None and atlas is not None:
        parts.append(_rhombi(cards, atlas, len(mesh.positions)))
    vertices, faces = (np.concatenate([part[at] for part in parts]) for at in (0, 1))
    return _HEAD.format(vertices=len(vertices), faces=len(faces)).encode() + vertices.tobytes() + faces.tobytes()


def _vertices(positions: NDArray[np.floating], normals: NDArray[np.floating], colours: Floats) -> NDArray[np.void]:
    rows = np.zeros(len(positions), dtype=_VERTEX)
    for column, name in enumerate(("x", "y", "z")):
        rows[name], rows[f"n{name}"] = positions[:, column], normals[:, column]
    rows["rgb"] = np.rint(colours)
    return rows


def _faces(triangles: NDArray[np.integer], label: int) -> NDArray[np.void]:
    rows = np.zeros(len(triangles), dtype=_FACE)
    rows["count"], rows["corners"], rows["label"] = 3, triangles, label
    return rows


def _bark_colours(bark: Surface) -> Floats:
    """Read the texture at each vertex (v, 3); it repeats."""
    size = np.array(bark.texture.shape[1::-1])
    column, row = (np.floor(bark.mesh.uvs.astype(np.float64) * size).astype(np.int64) % size).T
    colours = bark.texture[row, column].astype(np.float64)
    return colours if bark.mesh.shades is None else _shaded(colours, bark.mesh.shades)


def _shaded(colours: Floats, shades: NDArray[np.floating]) -> Floats:
    factors: Floats = np.clip(shades, 0, 1).astype(np.float64) ** (1 / _GAMMA)
    return colours * factors[:, None]


def _rhombi(leaves: Leaves, atlas: Atlas, first: int) -> tuple[NDArray[np.void], NDArray[np.void]]:
    """Build a rhombus for each card, its corners below, right, above and left."""
    plain = _spray_corners(atlas)
    mirrored = plain[:, [0, 3, 2, 1]] * np.array([-1.0, 1.0])
    across, up = np.stack([plain, mirrored])[leaves.flips.astype(np.int64), leaves.tiles].transpose(2, 0, 1)[..., None]
    places = leaves.centres[:, None] + across * leaves.rights[:, None] + up * leaves.ups[:, None]
    rounded = card_mesh(leaves, atlas).normals.reshape(
        -1, 4, 3
    )  # of the corners below left, below right, above right ...
    normals = rounded + np.roll(rounded, -1, axis=1)
    normals = normals / np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-9)
    colours = np.repeat(_shaded(atlas.colours[leaves.tiles], leaves.shades), 4, axis=0)
    starts = first + 4 * np.arange(len(leaves))[:, None, None]
    triangles = (starts + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
    return _vertices(places.reshape(-1, 3), normals.reshape(-1, 3), colours), _faces(triangles, LEAF)


def _spray_corners(atlas: Atlas) -> Floats:
    """Fit a rhombus to each tile's opaque part (k, 4, 2), in half-extents of a card: x right, y up."""
    opaque = tile_alphas(atlas) >= ALPHA_CUT * 255
    side = opaque.shape[1]
    rows = np.linspace(1 - 1 / side, -1 + 1 / side, side)
    filled = opaque.any(axis=2)
    high = np.where(filled, rows, -1.0).max(axis=1) + 1 / side
    low = np.where(filled, rows, 1.0).min(axis=1) - 1 / side
    share = opaque.mean(axis=(1, 2))
    half_width = np.clip(
        4 * share / np.maximum(high - low, 1e-9), 0.0, 1.0
    )  # a card's area is 4, a rhombus's d1 d2 / 2
    middle = opaque.sum(axis=1) @ rows[::-1] / np.maximum(opaque.sum(axis=(1, 2)), 1)
    left, right = np.maximum(middle - half_width, -1.0), np.minimum(middle + half_width, 1.0)
    centre = (low + high) / 2
    pairs = [(middle, low), (right, centre), (middle, high), (left, centre)]
    return np.stack([np.stack(pair, axis=1) for pair in pairs], axis=1)
