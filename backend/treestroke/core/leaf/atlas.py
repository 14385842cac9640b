"""The leaf atlas: one texture of sprays, drawn in the colours of this photo."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from treestroke.core.leaf.palette import Palette, foliage_palette, lab_from_rgb
from treestroke.core.leaf.sprays import Shape, draw_spray

Floats = NDArray[np.float64]
Kind = Literal["leaves", "needles", "bare"]

COLUMNS = 4
"""Tiles a row; the atlas has as many rows."""
TILE_SIDE = 256
"""Side of a tile, px: a spray is seen at 20 to 60 px, so this bears a close look."""
BLOSSOM_LIGHTNESS, BLOSSOM_CHROMA = 62.0, 17.0
"""Clusters that are lighter and paler than this (or pink) look like blossom."""
BLOSSOM_SHARE = 0.3
"""Share of the foliage that must look like blossom for the tree to be in flower (CIE Lab; told on 3 of 11 photos)."""


@dataclass(frozen=True, eq=False)
class Atlas:
    """Tiles of one texture; each holds another spray.

    Attributes
    ----------
    image
        (h, w, 4) uint8, sRGB, straight alpha, sides powers of two; to be cut at alpha 0.5.
    boxes
        (k, 4) left, top, right, bottom of each tile in texture coordinates, 0 to 1, v down.
    colours
        (k, 3) mean colour of each tile's opaque part, sRGB, 0 to 255.
    """

    image: NDArray[np.uint8]
    boxes: Floats
    colours: Floats


def leaf_atlas(photo: NDArray[np.uint8], mask: NDArray[np.bool_], kind: Kind, rng: np.random.Generator) -> Atlas:
    """Draw sprays of leaves (or needles, or blossom) in up to 16 colours of the photo's foliage.

    Every tile is another drawing; where the foliage has fewer colours, the common ones have several tiles.
    Very pale clusters of a broad-leaved tree are drawn as blossom.

    Raises
    ------
    ValueError
        The mask (h, w) is empty or not of the photo's size (h, w, 3).
    """
    tiles = COLUMNS * COLUMNS
    palette = foliage_palette(photo, mask, tiles, rng)
    image = np.zeros((COLUMNS * TILE_SIDE, COLUMNS * TILE_SIDE, 4), dtype=np.uint8)
    shapes = _shapes(palette, kind)
    for tile, window in enumerate(_windows()):
        cluster = tile % len(shapes)
        image[window] = draw_spray(shapes[cluster], TILE_SIDE, palette.members[cluster], rng)
    return Atlas(image, _boxes(), _mean_colours(image))


def tile_alphas(atlas: Atlas) -> NDArray[np.uint8]:
    """Cut the tiles' alpha (k, side, side) out of the atlas."""
    height, width = atlas.image.shape[:2]
    edges = np.rint(atlas.boxes * np.array([width, height, width, height])).astype(np.int64)
    return np.stack([atlas.image[top:bottom, left:right, 3] for left, top, right, bottom in edges.tolist()])


def tile_labs(atlas: Atlas) -> Floats:
    """Mean colour of each tile (k, 3), CIE Lab."""
    return lab_from_rgb(np.rint(atlas.colours).astype(np.uint8))


def _shapes(palette: Palette, kind: Kind) -> list[Shape]:
    """Choose what each cluster is drawn as: flowers only where much of the tree looks like blossom."""
    if kind == "needles":
        return ["needles"] * len(palette.shares)
    lightness, red, yellow = palette.centres.T
    pale = (np.hypot(red, yellow) < BLOSSOM_CHROMA) & (lightness > BLOSSOM_LIGHTNESS)
    pink = (red > 8) & (yellow < 6) & (lightness > 45)
    in_flower = palette.shares[pale | pink].sum() > BLOSSOM_SHARE
    return ["blossom" if in_flower and bright else "broad" for bright in lightness > 45]


def _windows() -> list[tuple[slice, slice]]:
    """Rows and columns of each tile."""
    edges = [slice(index * TILE_SIDE, (index + 1) * TILE_SIDE) for index in range(COLUMNS)]
    return [(rows, columns) for rows in edges for columns in edges]


def _boxes() -> Floats:
    """Texture coordinates of the tiles (k, 4)."""
    edges = [(columns.start, rows.start, columns.stop, rows.stop) for rows, columns in _windows()]
    return np.array(edges, dtype=np.float64) / (COLUMNS * TILE_SIDE)


def _mean_colours(image: NDArray[np.uint8]) -> Floats:
    """Mean opaque colour of each tile (k, 3)."""
    return np.stack([image[window][image[window][..., 3] > 127][:, :3].mean(axis=0) for window in _windows()])
