"""The leaf atlas: one texture of sprays, drawn in the colours of the photo."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from treestroke.core.paint.cut_outs import mean_solid_colour, opaque_part, reduced
from treestroke.core.paint.leaf_picture import draw_pictured_leaves, picture_recolour
from treestroke.core.paint.palette import Palette, foliage_palette, lab_from_rgb
from treestroke.core.paint.seasons import GREEN_A, GREEN_B, LEAFY, Recolour, grey_palette, recolour_for, recolour_grey
from treestroke.core.paint.species import AUTO, Species
from treestroke.core.paint.sprays import SprayKind, draw_spray
from treestroke.core.types import EVERGREEN, Floats, FoliageKind, Mask, Opacity, Picture

FOLD = 0.5
"""How far the fold of a card stands before its flat middle, and its other corners behind it, over half its side: a
spray of leaves is no flat thing. Each half is turned by 35 degrees, so that few look like straws from their edge."""
COLUMNS = 4
"""Tiles in a row; the atlas has as many rows."""
TILE_SIDE = 256
"""Side of a tile, px: a spray is usually seen at 20 to 60 px, so that this allows a close look."""
BLOSSOM_LIGHTNESS, BLOSSOM_CHROMA = 62.0, 17.0
"""Clusters that are lighter and of lower chroma than this, CIE Lab, look like blossom; so do pink ones."""
PETAL_LIGHTNESS = 45.0
"""CIE Lab lightness from which on colours of a tree in flower are petals; darker ones are its leaves or its wood."""
BLOSSOM_SHARE = 0.3
"""Share of the foliage that must look like blossom for the tree to be in flower (tuned on 11 photos, 3 in flower)."""


@dataclass(frozen=True, eq=False)
class LeafStyle:
    """What determines the look of leaves apart from the photo.

    Attributes
    ----------
    species
        Kind of tree that they are drawn as.
    season
        One of `treestroke.core.paint.seasons.SEASONS`, or ``photo`` to keep their colours.
    shown
        Whether the photo shows leaves; if not, all colours are the season's.
    picture
        A leaf, (h, w, 4) uint8, sRGB with straight alpha, its stalk down, reduced to its opaque part; None to draw one.
    straps
        Whether a palm bears strap leaves instead of fronds.
    length
        Length of a leaf that the photo shows, as a share of the spray's side; None to draw it as long as the species'.
    across_px
        Width of the foliage in the photo, px; None where that is the cover's.

    Raises
    ------
    ValueError
        The picture has another shape or type, or is transparent.
    """

    species: Species = AUTO
    season: str = "photo"
    shown: bool = True
    picture: NDArray[np.uint8] | None = None
    straps: bool = False
    length: float | None = None
    across_px: float | None = None

    def __post_init__(self) -> None:
        if self.picture is not None:
            object.__setattr__(self, "picture", reduced(opaque_part(self.picture)))


@dataclass(frozen=True, eq=False)
class Atlas:
    """Tiles of one texture, each with a different spray.

    Attributes
    ----------
    image
        (h, w, 4) uint8, sRGB, straight alpha, sides powers of two; cut at `ALPHA_CUT` when it is drawn.
    boxes
        (k, 4) left, top, right, bottom of each tile in texture coordinates, 0 to 1, v down.
    colours
        (k, 3) mean colour of each tile's solid pixels, sRGB, 0 to 255.
    recolour
        Mapping from the photo's colours to the tiles', or None where they are the same.
    fruit
        Index of the tile that shows a fruit, or None; leaves do not show it.
    fold
        How far the folds of cards that show leaves stand before their middles, over half their side; 0 for flat cards.
    """

    image: NDArray[np.uint8]
    boxes: Floats
    colours: Floats
    recolour: Recolour | None = None
    fruit: int | None = None
    fold: float = 0.0


def leaf_atlas(
    photo: Picture,
    cover: Opacity | Mask,
    kind: FoliageKind,
    rng: np.random.Generator,
    style: LeafStyle = LeafStyle(),
) -> Atlas:
    """Draw sprays of leaves, needles or blossom in up to 16 colours of a photo's foliage.

    Every tile is a different drawing; where the foliage has fewer colours, the common ones have several tiles. Very
    pale clusters of a broad-leaved tree are drawn as blossom. A season other than the photo's recolours the leaves.

    Source: Tan et al. 2008, section 4, whose quads show the photo at the place that they project to; ours show tiles,
    so that no colour is smeared along the view.

    Parameters
    ----------
    photo, cover
        (h, w, 3) sRGB, and the share (h, w) of each pixel that shows a leaf in its own colour.
    kind
        What the twigs bear.
    rng
        Source of randomness.
    style
        What determines the look of leaves apart from the photo.

    Raises
    ------
    ValueError
        Nothing is covered, or the cover is not of the photo's size.
    """
    tiles = COLUMNS * COLUMNS
    palette = foliage_palette(photo, cover, tiles, rng, style.across_px) if style.shown else grey_palette(tiles, rng)
    flower = _in_flower(palette, kind, style)
    palette = _without_wood(palette) if flower else palette
    recolour = None if flower and style.picture is None else _recolour(palette, kind, style)
    kinds = _spray_kinds(palette, kind, style, flower)
    if recolour is not None:
        palette = recolour.palette(palette, tiles, rng)
    image = np.zeros((COLUMNS * TILE_SIDE, COLUMNS * TILE_SIDE, 4), dtype=np.uint8)
    for tile, window in enumerate(_windows()):
        cluster = tile % len(palette.members)
        image[window] = _tile(kinds[cluster % len(kinds)], palette.members[cluster], style, rng)
    recolour = recolour if style.shown else _ignoring_photo(recolour)
    return Atlas(image, _boxes(), _mean_colours(image), recolour, fold=FOLD if kind == "leaves" else 0.0)


def tile_alphas(atlas: Atlas) -> NDArray[np.uint8]:
    """Cut the tiles' alpha (k, side, side), 0 to 255, out of the atlas."""
    height, width = atlas.image.shape[:2]
    edges = np.rint(atlas.boxes * np.array([width, height, width, height])).astype(np.int64)
    return np.stack([atlas.image[top:bottom, left:right, 3] for left, top, right, bottom in edges.tolist()])


def tile_labs(atlas: Atlas) -> Floats:
    """Mean colour (k, 3) of each tile, CIE Lab."""
    return lab_from_rgb(np.rint(atlas.colours).astype(np.uint8))


def _in_flower(palette: Palette, kind: FoliageKind, style: LeafStyle) -> bool:
    """Tell whether much of the tree looks like blossom, in a season that allows it."""
    lightness, red, yellow = palette.centres.T
    pale = (np.hypot(red, yellow) < BLOSSOM_CHROMA) & (lightness > BLOSSOM_LIGHTNESS)
    pink = (red > 8) & (yellow < 6) & (lightness > 45)
    may_bloom = style.season == "spring" and (style.species.flowers or style.species == AUTO)
    blooms = style.shown and kind not in EVERGREEN and (style.season not in LEAFY or may_bloom)
    return bool(blooms and palette.shares[pale | pink].sum() > BLOSSOM_SHARE)


def _without_wood(palette: Palette) -> Palette:
    """Keep petals and green leaves of a tree in flower: dark twigs that are seen between them are modelled as wood.

    Clusters that are mostly wood go, unless all are.
    """
    kept = [labs[_petal_or_leaf(labs)] for labs in palette.members]
    left = np.array([len(labs) / len(own) for labs, own in zip(kept, palette.members, strict=True)])
    least = min(0.5, float(left.max()))
    members = tuple(labs for labs, share in zip(kept, left, strict=True) if share >= least)
    shares = (palette.shares * left)[left >= least]
    return Palette(np.stack([labs.mean(axis=0) for labs in members]), shares / shares.sum(), members)


def _petal_or_leaf(labs: Floats) -> Mask:
    """Tell which colours (n, 3), CIE Lab, of a tree in flower are not its wood's."""
    lightness, red, yellow = labs.T
    return np.asarray((lightness > PETAL_LIGHTNESS) | ((red < GREEN_A) & (yellow > GREEN_B)))


def _spray_kinds(palette: Palette, kind: FoliageKind, style: LeafStyle, flower: bool) -> list[SprayKind]:
    """Choose what each cluster is drawn as: flowers only where much of the tree looks like blossom."""
    match kind:
        case "needles" | "scales":
            return [kind]
        case "palm":
            return ["strap" if style.straps else "frond"]
    if style.species.flowers and style.season == "spring":
        return ["blossom"]
    return ["blossom" if flower and bright else "broad" for bright in palette.centres[:, 0] > PETAL_LIGHTNESS]


def _recolour(palette: Palette, kind: FoliageKind, style: LeafStyle) -> Recolour | None:
    """Return the mapping from the photo's colours to the leaves', or None where they stay."""
    if style.picture is not None:
        return picture_recolour(style.picture, palette)
    if not style.shown:
        return recolour_grey(style.season, style.species, kind)
    return recolour_for(style.season, style.species, palette, kind)


def _ignoring_photo(recolour: Recolour | None) -> Recolour | None:
    """Make a recolouring independent of the colours of a photo that shows no leaves."""
    return None if recolour is None else replace(recolour, kept=np.zeros(3))


def _tile(kind: SprayKind, colours: Floats, style: LeafStyle, rng: np.random.Generator) -> NDArray[np.uint8]:
    """Draw one spray (side, side, 4) in colours drawn from (m, 3), CIE Lab."""
    species = style.species if style.length is None else replace(style.species, length=style.length)
    if style.picture is not None:
        return draw_pictured_leaves(style.picture, species, TILE_SIDE, colours, rng)
    return draw_spray(kind, TILE_SIDE, colours, rng, species)


def _windows() -> list[tuple[slice, slice]]:
    """Rows and columns of each tile, px."""
    edges = [slice(index * TILE_SIDE, (index + 1) * TILE_SIDE) for index in range(COLUMNS)]
    return [(rows, columns) for rows in edges for columns in edges]


def _boxes() -> Floats:
    """Texture coordinates (k, 4) of the tiles: left, top, right, bottom, 0 to 1."""
    edges = [(columns.start, rows.start, columns.stop, rows.stop) for rows, columns in _windows()]
    return np.array(edges, dtype=np.float64) / (COLUMNS * TILE_SIDE)


def _mean_colours(image: NDArray[np.uint8]) -> Floats:
    """Mean colour (k, 3), sRGB, of each tile's solid pixels."""
    return np.stack([mean_solid_colour(image[window]) for window in _windows()])
