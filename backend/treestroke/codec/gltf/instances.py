"""A tree as a GLB whose leaves are instances: one card a tile, drawn many times (EXT_mesh_gpu_instancing)."""

import numpy as np

from treestroke.codec.gltf.book import Book
from treestroke.codec.gltf.tree import MATERIALS, Part, head_of
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import Mesh, Surface
from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.leaf.cards import CORNERS
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.paint.atlas import Atlas
from treestroke.core.types import Floats

INSTANCING = "EXT_mesh_gpu_instancing"
_BULGE = 0.5
"""How far the normal of a card's corner leans out, as a slope: a card alone knows nothing of the crown."""


def encode_instanced(bark: Part, cards: Leaves, atlas: Atlas, camera: OrthographicCamera, *, generator: str) -> bytes:
    """Write a tree as a GLB with a node for each tile of the atlas, and for each mirrored one, that many cards share.

    Each card has its place, turn, size and, as ``_COLOR_0``, its shade. The extension is named as used, not as
    required: a reader without it shows one card a tile at the root. Equal input gives equal bytes.
    """
    book = Book()
    material, wrap = MATERIALS["bark"]
    book.add(f"bark{bark.suffix}", bark.surface, material, wrap)
    children = _leaf_nodes(book, cards, atlas) if len(cards) else []
    groups = [book.row("nodes", {"name": "leaf", "children": children})] if children else []
    return book.glb(head_of([0, *groups], camera, generator))


def _leaf_nodes(book: Book, cards: Leaves, atlas: Atlas) -> list[int]:
    """Enter a node for each picture that cards show."""
    size = float(np.linalg.norm(cards.ups, axis=1).mean())
    material, wrap = MATERIALS["leaf"]
    worn = book.material("leaf", Surface(_card(atlas, 0, False, size), atlas.image), material, wrap)
    book.used.add(INSTANCING)
    nodes = []
    for tile in range(len(atlas.boxes)):
        for flip in (False, True):
            chosen = cards.select((cards.tiles == tile) & (cards.flips == flip))
            if len(chosen):
                name = f"leaf_{tile:02d}{'_mirrored' if flip else ''}"
                card = book.primitive(_card(atlas, tile, flip, size), worn)
                shape = book.row("meshes", {"name": name, "primitives": [card]})
                placed = {INSTANCING: {"attributes": _placed(book, chosen, size)}}
                nodes.append(book.row("nodes", {"name": name, "mesh": shape, "extensions": placed}))
    return nodes


def _card(atlas: Atlas, tile: int, flip: bool, size: float) -> Mesh:
    """Build the card of a tile, of so many metres from its middle to its sides; it faces +Z."""
    flat = np.column_stack([CORNERS, np.zeros(4)])
    normals = unit(flat * _BULGE + np.array([0.0, 0.0, 1.0]))
    left, top, right, bottom = atlas.boxes[tile]
    left, right = (right, left) if flip else (left, right)
    uvs = np.array([[left, bottom], [right, bottom], [right, top], [left, top]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
    return Mesh((flat * size).astype(np.float32), normals.astype(np.float32), uvs.astype(np.float32), triangles)


def _placed(book: Book, cards: Leaves, size: float) -> dict[str, int]:
    """Enter where the cards (m) are, how they are turned, how large and how bright."""
    width, height = (np.linalg.norm(sides, axis=1) for sides in (cards.rights, cards.ups))
    scale = np.stack([width, height, (width + height) / 2], axis=1) / size
    right, up = unit(cards.rights, np.array([1.0, 0.0, 0.0])), unit(cards.ups, UP)
    turns = quaternions(np.stack([right, up, np.cross(right, up)], axis=2))
    grey = np.rint(cards.shades * 255).astype(np.uint8)
    shades = np.stack([grey, grey, grey, np.full_like(grey, 255)], axis=1)
    return {
        "TRANSLATION": book.accessor(cards.centres.astype(np.float32)),
        "ROTATION": book.accessor(np.rint(turns * 32767).astype(np.int16), normalized=True),
        "SCALE": book.accessor(scale.astype(np.float32)),
        "_COLOR_0": book.accessor(shades, normalized=True),
    }


def quaternions(turns: Floats) -> Floats:
    """Write turns (m, 3, 3), whose columns are where the axes go, as unit quaternions (m, 4): x, y, z, w."""
    (a, b, c), (d, e, f), (g, h, i) = turns.transpose(1, 2, 0)
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
