"""An impostor: pictures of a tree from eight sides, on planes that cross in its middle, for very small sizes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import ALPHA_CUT, Mesh, Surface
from treestroke.core.geometry.mipmaps import Cutout, MipLevels, mip_texels
from treestroke.core.geometry.raster import pixel_centres, planes, visible_triangles
from treestroke.core.geometry.silhouette import AZIMUTHS_RAD, Framing, framing
from treestroke.core.types import Floats, Indices, Mask

TILE_SIDE = 256
"""Side of a tile of the atlas, px."""
COLUMNS, ROWS = 4, 2
"""Tiles of the atlas, one for each azimuth, row by row."""
BANDS = 6
"""Quads of a plane, one above the other; their edges follow the tree's middle at each height."""
_MARGIN = 4
"""Transparent texels around a tile's picture, so that mipmaps do not mix neighbours."""
_INNER = TILE_SIDE - 2 * _MARGIN
_FINER = 2
"""Supersampling: samples along each side of a texel."""
_TRIM_ROWS = 64
"""Height, px, at which outlines are compared when pictures are trimmed: about the size at which they are seen."""
_ASKEW = float(np.sqrt(0.5))
"""Width of a plane seen from its neighbour's azimuth, over its own."""
_CUT, _BARE_CUT = 0.42, 0.8
"""Least coverage of a texel that is drawn (below a half, since mipmaps mix it with transparent ones; tuned on the
silhouettes of 3 leafy trees). Bare twigs are visible on three planes at once: they are drawn thinner, and not trimmed,
which would break them into pieces."""
_GAMMA = 2.2
_FLATTEST = 0.15
"""Least z of a normal, towards the viewer, before it is normalised."""

Colours = NDArray[np.float32]
_Place = tuple[Floats, Floats]


@dataclass(frozen=True, eq=False)
class _Picture:
    """The view from one azimuth.

    Attributes
    ----------
    colours, normals
        (h, w, 3) linear colours, and unit normals with x right, y up, z to the viewer; 0 where there is no tree.
    cover
        (h, w) 1 where there is a surface, else 0.
    wood
        (h, w) whether that is opaque, a surface without alpha.
    """

    colours: Colours
    normals: Colours
    cover: Colours
    wood: Mask

    def columns(self, part: slice) -> "_Picture":
        """Select columns."""
        return _Picture(self.colours[:, part], self.normals[:, part], self.cover[:, part], self.wood[:, part])


def impostor(surfaces: Sequence[Surface]) -> Surface:
    """Bake a tree (metres) into an atlas of eight views, on four upright planes with two sides each.

    A view holds base colours and normals, and lies on the side of a plane that faces its azimuth, at its own size. The
    planes cross in the tree's middle at each height: seen from one azimuth, the foreshortened pictures of the
    neighbours stay nearly within its own. Triangles are to be drawn with backface culling.

    Returns
    -------
    A surface. Its texture (512, 1024, 4) has straight alpha, which equals `ALPHA_CUT` where 42 % of a texel is covered
    (80 % on a tree without leaves), and colours under its transparent part too; its normal map is in tangent space.

    Notes
    -----
    Why crossed planes: docs/decisions/0013.
    """
    view = framing(surfaces, _FINER * _INNER)
    texels = [_premultiplied(surface.texture) for surface in surfaces]
    pictures = [_drawn(surfaces, texels, view, azimuth) for azimuth in AZIMUTHS_RAD.tolist()]
    boxes = [_shown_columns(picture.cover) for picture in pictures]
    middles = np.stack([_middles(picture.cover, view) for picture in pictures])
    leafy = any(surface.texture.shape[2] == 4 for surface in surfaces)
    if leafy:
        trimmed = _trimmed(np.stack([picture.cover for picture in pictures]), middles, view)
        pictures = [
            replace(picture, cover=picture.cover * (kept | picture.wood))
            for picture, kept in zip(pictures, trimmed, strict=True)
        ]
    cut = _CUT if leafy else _BARE_CUT
    tiles = [_tile(picture.columns(slice(*box)), cut) for picture, box in zip(pictures, boxes, strict=True)]
    strips = [_strip(k, box, middles[(k + 2) % len(boxes)], view) for k, box in enumerate(boxes)]
    texture, normal_map = (
        np.concatenate([np.concatenate(row, axis=1) for row in _rows(side)]) for side in zip(*tiles, strict=True)
    )
    return Surface(_joined(strips), texture, normal_map)


def _rows(tiles: Sequence[NDArray[np.uint8]]) -> list[Sequence[NDArray[np.uint8]]]:
    """Group tiles by the atlas's rows."""
    return [tiles[row * COLUMNS : (row + 1) * COLUMNS] for row in range(ROWS)]


def _drawn(surfaces: Sequence[Surface], texels: Sequence[Colours], view: Framing, azimuth_rad: float) -> _Picture:
    """Draw the view from an azimuth; ``texels`` (n, 4) are the mipmap texels of each surface's texture."""
    right = np.array([np.cos(azimuth_rad), 0.0, -np.sin(azimuth_rad)])
    turn = np.stack([right, [0.0, 1.0, 0.0], np.cross(right, [0.0, 1.0, 0.0])])
    corners = [surface.mesh.positions.astype(np.float64)[surface.mesh.triangles] for surface in surfaces]
    corners_px = [view.project(each, azimuth_rad) for each in corners]
    nearness = np.concatenate([each @ turn[2] for each in corners]).mean(axis=1)
    cut = _Cuts(
        [Cutout(surface, at) for surface, at in zip(surfaces, corners_px, strict=True)], [len(c) for c in corners]
    )
    shown = visible_triangles(np.concatenate(corners_px), nearness, cut, view.height, view.width).ravel()
    colours, normals = (np.zeros((len(shown), 3), dtype=np.float32) for _ in range(2))
    for surface, levels, at, start in zip(surfaces, texels, corners_px, cut.starts[:-1].tolist(), strict=True):
        pixel = np.flatnonzero((shown >= start) & (shown < start + len(at)))
        triangle, place = shown[pixel] - start, pixel_centres(pixel, view.width)
        colours[pixel] = _colours(surface, levels, at, triangle, place)
        normals[pixel] = _normals(surface.mesh, at, triangle, place, turn)
    size = (view.height, view.width)
    cover = (shown >= 0).astype(np.float32).reshape(size)
    opaque = np.repeat([surface.texture.shape[2] == 3 for surface in surfaces], [len(each) for each in corners])
    wood = (shown >= 0) & opaque[shown]
    return _Picture(colours.reshape(*size, 3), normals.reshape(*size, 3), cover, wood.reshape(size))


class _Cuts:
    """Alpha test of the triangles of several surfaces, one after the other."""

    def __init__(self, cuts: Sequence[Cutout], counts: Sequence[int]) -> None:
        self.cuts, self.starts = cuts, np.cumsum([0, *counts])

    def __call__(self, triangle: Indices, x: Floats, y: Floats) -> Mask:
        """Return the mask (m,) of the points x, y, px, of triangles with index (m,) that pass."""
        passes = np.empty(len(triangle), dtype=bool)
        for cut, start, end in zip(self.cuts, self.starts[:-1], self.starts[1:], strict=True):
            of_surface = np.flatnonzero((triangle >= start) & (triangle < end))
            passes[of_surface] = cut(triangle[of_surface] - start, x[of_surface], y[of_surface])
        return passes


def _colours(surface: Surface, texels: Colours, corners_px: Floats, triangle: Indices, place: _Place) -> Colours:
    """Return the linear colours (m, 3) of triangles (m,) of a surface at places (m,), px."""
    mesh = surface.mesh
    premultiplied = texels[MipLevels(surface, corners_px).texels(triangle, *place)]
    colours = premultiplied[:, :3] / premultiplied[:, 3:]
    if mesh.shades is None:
        return np.asarray(colours)
    shades = planes(corners_px, mesh.shades[mesh.triangles].astype(np.float64)[:, :, None]).at(triangle, *place)[0]
    return np.asarray(colours * np.clip(shades, 0.0, 1.0)[:, None], dtype=np.float32)


def _normals(mesh: Mesh, corners_px: Floats, triangle: Indices, place: _Place, turn: Floats) -> Colours:
    """Return the view-space normals (m, 3) of triangles (m,) of a mesh at places (m,), px."""
    turned = mesh.normals.astype(np.float64) @ turn.T
    normals = planes(corners_px, turned[mesh.triangles]).at(triangle, *place).T
    first, second = (corners_px[triangle, corner] - corners_px[triangle, 0] for corner in (1, 2))
    # The normal of a leaf seen from behind is flipped, as in a viewer.
    normals[first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] > 0] *= -1.0
    normals[:, 2] = np.maximum(normals[:, 2], _FLATTEST)
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True), dtype=np.float32)


def _premultiplied(texture: NDArray[np.uint8]) -> Colours:
    """Return the texels (n, 4) of all mipmap levels: linear colours times alpha, and alpha."""
    linear = ((np.arange(256) / 255.0) ** _GAMMA).astype(np.float32)[texture[:, :, :3]]
    alpha = np.ones(texture.shape[:2], np.float32) if texture.shape[2] == 3 else texture[:, :, 3] / np.float32(255)
    alpha = np.maximum(alpha, np.float32(1e-3))
    return mip_texels(np.concatenate([linear * alpha[:, :, None], alpha[:, :, None]], axis=2))


def _shown_columns(cover: Colours) -> tuple[int, int]:
    """Return the first column and the end of those that show anything."""
    shown = np.flatnonzero(cover.any(axis=0))
    return (int(shown[0]), int(shown[-1]) + 1) if shown.size else (0, cover.shape[1])


def _tile(picture: _Picture, cut: float) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Downscale a picture to a tile: sRGB colours with alpha (side, side, 4), and normals (side, side, 3), uint8.

    Texels with the coverage ``cut`` get the alpha `ALPHA_CUT`.
    """
    colours, normals = (_bled(_small(layer, picture.cover)) for layer in (picture.colours, picture.normals))
    alpha = 255.0 * np.interp(colours[:, :, 3], [0.0, cut, 1.0], [0.0, ALPHA_CUT, 1.0])
    coded = 255.0 * np.clip(colours[:, :, :3], 0.0, 1.0) ** (1.0 / _GAMMA)
    directions = normals[:, :, :3] / np.maximum(np.linalg.norm(normals[:, :, :3], axis=2, keepdims=True), 1e-6)
    texture = np.concatenate([coded, alpha[:, :, None]], axis=2)
    return np.rint(texture).astype(np.uint8), np.rint(127.5 + 127.5 * directions).astype(np.uint8)


def _small(layer: Colours, cover: Colours) -> Colours:
    """Downscale a layer (h, w, 3) and its cover (h, w) to a tile (side, side, 4) with a transparent margin."""
    small = cv2.resize(np.dstack([layer * cover[:, :, None], cover]), (_INNER, _INNER), interpolation=cv2.INTER_AREA)
    return np.asarray(np.pad(small, ((_MARGIN, _MARGIN), (_MARGIN, _MARGIN), (0, 0))))


def _bled(layer: Colours) -> Colours:
    """Divide a layer (h, w, 3 + 1) by its cover, the last channel, and fill uncovered texels from covered ones."""
    cover, size = layer[:, :, 3], layer.shape[1::-1]
    filled, known = np.zeros_like(layer), np.zeros(cover.shape, dtype=bool)
    for side in (TILE_SIDE >> step for step in range(TILE_SIDE.bit_length())):
        sums = cv2.resize(cv2.resize(layer, (side, side), interpolation=cv2.INTER_AREA), size)
        new = ~known & (sums[:, :, 3] > 1e-4)
        filled[new] = sums[new] / sums[new][:, 3:]
        known |= new
    filled[:, :, 3] = cover
    return filled


def _middles(cover: Colours, view: Framing) -> Floats:
    """Offset (bands + 1,) to the right, metres, of a view's middle at the edges of the bands, from the bottom up."""
    rows = cover.astype(np.float64)
    columns = np.arange(view.width) + 0.5 - 0.5 * view.width
    edges = np.linspace(view.height, 0, BANDS + 1)
    reach = 0.5 * view.height / BANDS
    found = []
    for edge in edges.tolist():
        # At the foot the trunk alone, without branches that hang beside it.
        above = 0.2 * reach if edge == view.height else reach
        band = rows[int(max(edge - above, 0)) : int(np.ceil(edge + reach))].sum(axis=0)
        found.append(float(columns @ band) / max(float(band.sum()), 1e-9) / view.px_per_m)
    return np.array(found)


def _trimmed(cover: Colours, middles: Floats, view: Framing) -> Mask:
    """Mark the pixels (8, h, w) to keep: not those that, seen from a neighbouring azimuth, would lie beside the tree.

    A pixel is dropped where that costs its own view less than keeping it costs its neighbours.
    """
    kernel = (max(1, round(view.height / _TRIM_ROWS)),) * 2
    shown = np.stack([cv2.blur(each, kernel) >= 0.5 for each in cover])
    rows = np.arange(view.height)
    edges = np.linspace(0, view.height, BANDS + 1)
    # Distance, px, of each row of a plane from the axis towards its own viewer, from whom all is in place.
    out = np.stack([-np.interp(rows + 0.5, edges, m[::-1]) for m in np.roll(middles, -2, axis=0)]) * view.px_per_m
    column = np.arange(view.width) + 0.5 - 0.5 * view.width
    kept = shown.copy()
    # Twice, since a neighbour may have dropped pixels that it covered in the first round.
    for k in 2 * list(range(len(cover) // 2)):
        lost, covered = np.zeros(shown[k].shape), np.zeros(shown[k].shape, dtype=bool)
        for j, sign in (((k + 1) % len(cover), -1.0), ((k - 1) % len(cover), 1.0)):
            lost += _ASKEW * ~_read(shown[j], rows, _ASKEW * (column + sign * out[k][:, None]))
            covered |= _read(kept[j], rows, column / _ASKEW + sign * out[j][:, None])
        kept[k] = lost <= np.where(covered | ~shown[k], 0.0, 1.0)
        # The same from behind, so that both sides of a plane have one outline.
        kept[k + len(cover) // 2] = kept[k][:, ::-1]
    return kept


def _read(mask: Mask, rows: Indices, across: Floats) -> Mask:
    """Read a mask (h, w) in each row at offsets (h, n), px, to the right of its middle; false outside."""
    column = np.floor(across + 0.5 * mask.shape[1]).astype(np.int64)
    inside = (column >= 0) & (column < mask.shape[1])
    return np.asarray(mask[rows[:, None], np.clip(column, 0, mask.shape[1] - 1)] & inside)


def _strip(tile: int, box: tuple[int, int], middles: Floats, view: Framing) -> Mesh:
    """Build the bands of a tile's plane; ``middles`` are those of the view from a quarter turn further."""
    azimuth = AZIMUTHS_RAD[tile]
    right, out = np.array([np.cos(azimuth), 0.0, -np.sin(azimuth)]), np.array([np.sin(azimuth), 0.0, np.cos(azimuth)])
    across = (np.array(box) - 0.5 * view.width) / view.px_per_m
    up = (view.bottom_px - np.linspace(view.height, 0, BANDS + 1)) / view.px_per_m
    # Seen from a quarter turn further, what is nearer to this viewer is further left.
    spine = up[:, None] * [0.0, 1.0, 0.0] - middles[:, None] * out
    positions = (spine[:, None] + across[None, :, None] * right).reshape(-1, 3)
    corner = np.array([tile % COLUMNS, tile // COLUMNS], dtype=np.float64)
    u = (corner[0] + np.array([_MARGIN, TILE_SIDE - _MARGIN]) / TILE_SIDE) / COLUMNS
    v = (corner[1] + np.linspace(TILE_SIDE - _MARGIN, _MARGIN, BANDS + 1) / TILE_SIDE) / ROWS
    uvs = np.stack(np.broadcast_arrays(u[None, :], v[:, None]), axis=-1).reshape(-1, 2)
    first = 2 * np.arange(BANDS, dtype=np.uint32)[:, None, None]
    triangles = (first + np.array([[0, 1, 3], [0, 3, 2]], dtype=np.uint32)).reshape(-1, 3)
    normals = np.broadcast_to(out, positions.shape)
    return Mesh(positions.astype(np.float32), normals.astype(np.float32), uvs.astype(np.float32), triangles)


def _joined(strips: Sequence[Mesh]) -> Mesh:
    """Join strips of equal size to one mesh."""
    count = len(strips[0].positions)
    return Mesh(
        np.concatenate([strip.positions for strip in strips]),
        np.concatenate([strip.normals for strip in strips]),
        np.concatenate([strip.uvs for strip in strips]),
        np.concatenate([strip.triangles + np.uint32(count * k) for k, strip in enumerate(strips)]),
    )
