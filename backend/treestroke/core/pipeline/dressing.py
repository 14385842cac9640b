"""Leaves, fruit and bark of a grown tree, from its appearance and from its species and season."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from treestroke.core.appearance import View
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.mesh import Surface
from treestroke.core.grow.palm import is_forked
from treestroke.core.leaf.cards import cards
from treestroke.core.leaf.fruit import FruitParams, hang_fruit, with_fruit
from treestroke.core.leaf.grid import breadth
from treestroke.core.leaf.leaf_crown import AROUND, LEAST_SIZE, MOST_SIZE, SIDES, leaf_crown
from treestroke.core.leaf.leaves import Leaves, no_leaves
from treestroke.core.leaf.placement import LeafParams, place_leaves
from treestroke.core.mesh.bark import TEXTURE_SIZE, BarkParams, bark_texture
from treestroke.core.mesh.bark_pattern import bark_pattern
from treestroke.core.mesh.normal_map import NormalMapParams, bark_normal_map
from treestroke.core.mesh.seen_light import lit_as_seen
from treestroke.core.mesh.tubes import TubeParams, tubes
from treestroke.core.paint.atlas import Atlas, LeafStyle, leaf_atlas
from treestroke.core.paint.cut_outs import opaque_part, reduced
from treestroke.core.paint.leaf_scale import bounded_length, leaf_length_px
from treestroke.core.paint.seasons import size_and_density
from treestroke.core.paint.species import AUTO, SPECIES, Species, species_for
from treestroke.core.paint.sprays import CARD_SIZE
from treestroke.core.pipeline.crowns import CLOSED_SHARE, closed
from treestroke.core.pipeline.grown_tree import GrownTree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.progress import Report, silent
from treestroke.core.types import Opacity, Picture

BARE_TUBES = TubeParams(max_triangles=130_000)
"""A bare tree has no leaves, and all its twigs are bark."""
PAINTED = 6
"""Of many views, how many show what leaves look like."""
OF_CARD = 0.45
"""Length of a leaf, over a card's side, up to which cards are enlarged for the leaves that many views show."""
MOST_LARGER = 1.8
"""Greatest factor on the size of cards by the leaves that many views show."""


@dataclass(frozen=True, eq=False)
class OwnPictures:
    """Pictures (h, w, 4), sRGB with straight alpha, that a person provides for leaf and fruit; None where not.

    Attributes
    ----------
    leaf
        Its stalk down; drawn instead of the species' leaf.
    fruit
        Its stalk up; a tree bears fruit where there is a picture of it.
    """

    leaf: NDArray[np.uint8] | None = None
    fruit: NDArray[np.uint8] | None = None


NO_PICTURES = OwnPictures()


def leaf_surface(
    tree: GrownTree,
    settings: ModelSettings,
    pictures: OwnPictures,
    rng: np.random.Generator,
    report: Report = silent,
) -> tuple[Surface, Leaves, Atlas] | tuple[None, None, None]:
    """Hang leaves and fruit on the grown tree: return their surface, cards and atlas; None where it bears none.

    ``pictures`` (h, w, 4), RGBA, replace the species' leaf and add fruit.

    Raises
    ------
    ValueError
        A picture has no pixels, or only transparent ones.
    """
    leaves, atlas = _leaves(tree, settings, pictures.leaf, rng, report)
    if pictures.fruit is not None:
        leaves, atlas = _with_fruit(tree, leaves, atlas, reduced(opaque_part(pictures.fruit)), rng)
    if atlas is None or len(leaves) == 0:
        return None, None, None
    return Surface(cards(leaves, atlas), atlas.image), leaves, atlas


def _leaves(
    tree: GrownTree,
    settings: ModelSettings,
    picture: NDArray[np.uint8] | None,
    rng: np.random.Generator,
    report: Report,
) -> tuple[Leaves, Atlas | None]:
    """Hang leaves; without leaves there is no atlas."""
    leafy = tuple(view for view in tree.appearance.views if view.foliage.any())
    if tree.kind == "bare" or settings.leaf_density == 0 or not leafy:
        return no_leaves(), None
    species = species_for(settings.species, tree.kind, tree.taken.form)
    straps = tree.kind == "palm" and is_forked(tree.grown)
    shown = tuple(leafy[index] for index in np.unique(np.linspace(0, len(leafy) - 1, PAINTED).astype(int)))
    length, larger = None, 1.0
    if tree.kind == "leaves" and tree.appearance.shows_leaves:
        length, larger = _seen_length(shown, species)
    across = None if len(leafy) < AROUND else max(breadth(view.foliage) for view in shown)
    style = LeafStyle(species, settings.season, tree.appearance.shows_leaves, picture, straps, length, across)
    atlas = leaf_atlas(*_coloured(shown), tree.kind, rng, style)
    report("leaf", 0.2)
    size, density = size_and_density(settings.season, species, tree.kind)
    size *= larger
    crown = leaf_crown(
        replace(tree.appearance, views=leafy),
        tree.volume,
        atlas,
        float(np.clip(size * CARD_SIZE[tree.kind] * settings.leaf_size, LEAST_SIZE, MOST_SIZE)),
        rng,
    )
    params = LeafParams(density * settings.leaf_density, kind=tree.kind, form=tree.taken.form)
    return place_leaves(tree.grown.skeleton, crown, params, rng, report), atlas


def _seen_length(views: tuple[View, ...], species: Species) -> tuple[float | None, float]:
    """Length of a leaf that views show, as a share of the side of a card; None where they show none. And a factor.

    Many views show a crown so well that cards may be as much larger, by the factor, as its leaves are.
    """
    seen = []
    for view in views if len(views) >= AROUND else views[:1]:
        spray_px = 0.5 * sum(SIDES) * breadth(view.foliage)
        seen_px = leaf_length_px(view.picture, view.own_colour, spray_px)
        seen += [] if seen_px is None else [seen_px / spray_px]
    if not seen:
        return None, 1.0
    usual = float(np.median(seen))
    larger = min(max(usual / OF_CARD, 1.0), MOST_LARGER) if len(views) >= AROUND else 1.0
    return bounded_length(usual / larger, species), larger


def _coloured(views: tuple[View, ...]) -> tuple[Picture, Opacity]:
    """Lay the views' pictures side by side, with the share of each pixel that shows a leaf in its own colour."""
    height = max(view.camera.height for view in views)
    pictures, covers = [], []
    for view in views:
        below = ((0, height - view.camera.height), (0, 0))
        pictures.append(np.pad(view.picture, (*below, (0, 0))))
        covers.append(np.pad(view.own_colour, below))
    return np.hstack(pictures), np.hstack(covers)


def _with_fruit(
    tree: GrownTree, leaves: Leaves, atlas: Atlas | None, picture: NDArray[np.uint8], rng: np.random.Generator
) -> tuple[Leaves, Atlas]:
    """Hang fruit too, by random numbers of its own: leaves and wood are those of the tree without fruit."""
    crowns = [
        Silhouette(closed(view.tree | view.foliage, CLOSED_SHARE["bare"]), view.camera)
        for view in tree.appearance.views
    ]
    params = FruitParams(aspect=picture.shape[0] / picture.shape[1])
    fruit = hang_fruit(tree.grown.skeleton, tree.volume, crowns, params, rng.spawn(1)[0])
    return with_fruit(leaves, atlas if len(leaves) else None, fruit, picture)


def bark_surface(
    tree: GrownTree, settings: ModelSettings, rng: np.random.Generator, report: Report = silent
) -> Surface:
    """Wrap the grown tree in bark that is read off the first stem's visible pixels."""
    is_bare, view = tree.kind == "bare", tree.appearance.bark_view
    width = replace(BARE_TUBES if is_bare else TubeParams(), root_swelling=tree.grown.root_swelling)
    surface = tubes(tree.grown.skeleton, width)
    report("mesh", 0.6)
    bark, known = SPECIES.get(settings.species, AUTO).bark, settings.species != "auto"
    grain = bark_pattern(TEXTURE_SIZE, rng, bark.form)
    params = BarkParams(hidden_colour=bark.colour, form=bark.form if known else None)
    texture = bark_texture(view.picture, view.stem, params, rng, grain)
    wrapped = Surface(surface, texture, bark_normal_map(texture, grain, NormalMapParams(bark.depth)))
    as_in_photo = is_bare and not known and settings.season == "photo"
    return lit_as_seen(wrapped, view) if as_in_photo else wrapped
