"""A tree as binary PLY: coloured vertices, triangles labelled as wood or leaf."""

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import ALPHA_CUT, Surface
from treestroke.core.leaf.cards import cards as card_mesh
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.paint.atlas import Atlas, tile_alphas
from treestroke.core.types import Floats

BARK, LEAF = 0, 1
"""Labels of the faces."""
_COMMENT = b"comment treestroke: metres, right-handed, +Y up; label 0 bark, 1 leaf\n"
_GAMMA = 2.2
"""Shades are factors on linear light, colours are sRGB."""


@dataclass(frozen=True, eq=False)
class _Part:
    """Triangles (t, 3) of one label over vertices (v, 3), metres, with unit normals (v, 3) and sRGB colours (v, 3)."""

    positions: NDArray[np.floating]
    normals: NDArray[np.floating]
    colours: Floats
    triangles: NDArray[np.integer]
    label: int


def encode_ply(bark: Surface, cards: Leaves | None, atlas: Atlas | None) -> bytes:
    """Encode a tree as one binary little-endian PLY.

    Vertices have normals and 8-bit sRGB colours with an opaque alpha; faces have a ``label``, 0 bark, 1 leaf. A card
    becomes a rhombus of two triangles, as tall as its spray and with the area of the spray's opaque part, in the tile's
    mean colour. Equal input gives equal bytes.
    """
    from trimesh import Trimesh  # imported here: it takes half a second, and most trees are not written as PLY
    from trimesh.exchange.ply import export_ply

    mesh = bark.mesh
    parts = [_Part(mesh.positions, mesh.normals, _bark_colours(bark), mesh.triangles, BARK)]
    if cards is not None and atlas is not None:
        parts.append(_rhombi(cards, atlas, len(mesh.positions)))
    whole = Trimesh(
        np.concatenate([part.positions for part in parts]),
        np.concatenate([part.triangles for part in parts]),
        vertex_normals=np.concatenate([part.normals for part in parts]),
        vertex_colors=np.rint(np.concatenate([part.colours for part in parts])).astype(np.uint8),
        face_attributes={"label": np.concatenate([np.full(len(p.triangles), p.label, np.uint8) for p in parts])},
        process=False,
        validate=False,
    )
    content: bytes = export_ply(whole, vertex_normal=True)
    return re.sub(rb"comment .*\n", _COMMENT, content, count=1)  # in place of trimesh's own comment


def _bark_colours(bark: Surface) -> Floats:
    """Read the texture, which repeats, at each vertex: sRGB (v, 3), 0 to 255."""
    size = np.array(bark.texture.shape[1::-1])
    column, row = (np.floor(bark.mesh.uvs.astype(np.float64) * size).astype(np.int64) % size).T
    colours = bark.texture[row, column].astype(np.float64)
    return colours if bark.mesh.shades is None else _shaded(colours, bark.mesh.shades)


def _shaded(colours: Floats, shades: NDArray[np.floating]) -> Floats:
    """Darken sRGB colours (n, 3) by factors on linear light (n,)."""
    factors: Floats = np.clip(shades, 0, 1).astype(np.float64) ** (1 / _GAMMA)
    return colours * factors[:, None]


def _rhombi(leaves: Leaves, atlas: Atlas, first: int) -> _Part:
    """Build a rhombus for each card, its corners below, right, above, left; ``first`` is the first vertex's index."""
    plain = _spray_corners(atlas)
    mirrored = plain[:, [0, 3, 2, 1]] * np.array([-1.0, 1.0])
    across, up = np.stack([plain, mirrored])[leaves.flips.astype(np.int64), leaves.tiles].transpose(2, 0, 1)[..., None]
    places = leaves.centres[:, None] + across * leaves.rights[:, None] + up * leaves.ups[:, None]
    corner_normals = card_mesh(leaves, atlas).normals.reshape(-1, 4, 3)  # below left, below right, above right ...
    normals = corner_normals + np.roll(corner_normals, -1, axis=1)
    normals = normals / np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-9)
    colours = np.repeat(_shaded(atlas.colours[leaves.tiles], leaves.shades), 4, axis=0)
    starts = first + 4 * np.arange(len(leaves))[:, None, None]
    triangles = (starts + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
    return _Part(places.reshape(-1, 3), normals.reshape(-1, 3), colours, triangles, LEAF)


def _spray_corners(atlas: Atlas) -> Floats:
    """Fit a rhombus to each tile's opaque part (k, 4, 2), in half-extents of a card: x right, y up."""
    opaque = tile_alphas(atlas) >= ALPHA_CUT * 255
    side = opaque.shape[1]
    rows = np.linspace(1 - 1 / side, -1 + 1 / side, side)
    filled = opaque.any(axis=2)
    high = np.where(filled, rows, -1.0).max(axis=1) + 1 / side
    low = np.where(filled, rows, 1.0).min(axis=1) - 1 / side
    share = opaque.mean(axis=(1, 2))
    # a card's area is 4, that of a rhombus half the product of its diagonals
    half_width = np.clip(4 * share / np.maximum(high - low, 1e-9), 0.0, 1.0)
    middle = opaque.sum(axis=1) @ rows[::-1] / np.maximum(opaque.sum(axis=(1, 2)), 1)
    left, right = np.maximum(middle - half_width, -1.0), np.minimum(middle + half_width, 1.0)
    centre = (low + high) / 2
    pairs = [(middle, low), (right, centre), (middle, high), (left, centre)]
    return np.stack([np.stack(pair, axis=1) for pair in pairs], axis=1)
