"""A tree as a GLB whose leaves are instances of one card for each tile (EXT_mesh_gpu_instancing)."""

import numpy as np

from treestroke.codec.gltf.document import Document
from treestroke.codec.gltf.tree import MATERIALS, Part, Provenance, head_of
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import Mesh, Surface
from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.leaf.cards import CORNERS, HALVES, RIDGE
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.paint.atlas import Atlas
from treestroke.core.types import Floats

INSTANCING = "EXT_mesh_gpu_instancing"
_BULGE = 0.5
"""Slope of the normals at a card's corners, outward: a single card does not know its place in the crown."""


def encode_instanced(
    bark: Part,
    cards: Leaves,
    atlas: Atlas,
    camera: OrthographicCamera,
    *,
    provenance: Provenance,
) -> bytes:
    """Encode a tree as a GLB with an instanced node for each tile of the atlas and for each mirrored one.

    Each instance has its translation, rotation, scale and, as ``_COLOR_0``, its shade. The extension is used, not
    required: a reader without it shows one card for each tile at the root. Equal input gives equal bytes.
    """
    document = Document()
    document.add(f"bark{bark.suffix}", bark.surface, MATERIALS["bark"])
    children = _leaf_nodes(document, cards, atlas) if len(cards) else []
    groups = [document.row("nodes", {"name": "leaf", "children": children})] if children else []
    return document.glb(head_of([0, *groups], camera, provenance))


def _leaf_nodes(document: Document, cards: Leaves, atlas: Atlas) -> list[int]:
    """Add a node for each tile that cards show, plain and mirrored; their indices."""
    size = float(np.linalg.norm(cards.ups, axis=1).mean())
    material = document.material("leaf", Surface(_card(atlas, 0, False, size), atlas.image), MATERIALS["leaf"])
    document.used.add(INSTANCING)
    nodes = []
    for tile in range(len(atlas.boxes)):
        for flip in (False, True):
            chosen = cards.select((cards.tiles == tile) & (cards.flips == flip))
            if len(chosen):
                name = f"leaf_{tile:02d}{'_mirrored' if flip else ''}"
                card = document.primitive(_card(atlas, tile, flip, size), material)
                shape = document.row("meshes", {"name": name, "primitives": [card]})
                placed = {INSTANCING: {"attributes": _placed(document, chosen, size)}}
                nodes.append(document.row("nodes", {"name": name, "mesh": shape, "extensions": placed}))
    return nodes


def _card(atlas: Atlas, tile: int, flip: bool, size: float) -> Mesh:
    """Build the card of a tile, facing +Z; ``size`` is half its side, metres."""
    corners = np.column_stack([CORNERS, (-1.0 if flip else 1.0) * (0.0 if tile == atlas.fruit else atlas.fold) * RIDGE])
    normals = unit(corners * np.array([_BULGE, _BULGE, 0.0]) + np.array([0.0, 0.0, 1.0]))
    left, top, right, bottom = atlas.boxes[tile]
    left, right = (right, left) if flip else (left, right)
    uvs = np.array([[left, bottom], [right, bottom], [right, top], [left, top]])
    triangles = HALVES[int(flip)]
    return Mesh((corners * size).astype(np.float32), normals.astype(np.float32), uvs.astype(np.float32), triangles)


def _placed(document: Document, cards: Leaves, size: float) -> dict[str, int]:
    """Add the instance attributes of cards; ``size`` is half the side of the instanced card, metres."""
    width, height = (np.linalg.norm(sides, axis=1) for sides in (cards.rights, cards.ups))
    scale = np.stack([width, height, (width + height) / 2], axis=1) / size
    right, up = unit(cards.rights, np.array([1.0, 0.0, 0.0])), unit(cards.ups, UP)
    rotations = quaternions(np.stack([right, up, np.cross(right, up)], axis=2))
    grey = np.rint(cards.shades * 255).astype(np.uint8)
    shades = np.stack([grey, grey, grey, np.full_like(grey, 255)], axis=1)
    return {
        "TRANSLATION": document.accessor(cards.centres.astype(np.float32)),
        "ROTATION": document.accessor(np.rint(rotations * 32767).astype(np.int16), normalized=True),
        "SCALE": document.accessor(scale.astype(np.float32)),
        "_COLOR_0": document.accessor(shades, normalized=True),
    }


def quaternions(rotations: Floats) -> Floats:
    """Convert rotation matrices (m, 3, 3) to unit quaternions (m, 4): x, y, z, w.

    Written out, because importing scipy's rotations takes five times as long as writing the whole file.

    Notes
    -----
    Shepperd, "Quaternion from Rotation Matrix", 1978: of the four ways, the one with the largest component is used.
    """
    (a, b, c), (d, e, f), (g, h, i) = rotations.transpose(1, 2, 0)
    # Four times the quaternion's products with itself; the row with the largest square is the least rounded.
    rows = [
        [1 + a - e - i, b + d, c + g, h - f],
        [b + d, 1 - a + e - i, f + h, c - g],
        [c + g, f + h, 1 - a - e + i, d - b],
        [h - f, c - g, d - b, 1 + a + e + i],
    ]
    products = np.array(rows).transpose(2, 0, 1)
    largest = np.diagonal(products, axis1=1, axis2=2).argmax(axis=1)
    return unit(products[np.arange(len(products)), largest])
