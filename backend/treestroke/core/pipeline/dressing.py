"""What a grown tree wears: leaves, fruit and bark, from its picture and from what is known of species and season."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import Surface
from treestroke.core.geometry.views import CrownViews, View
from treestroke.core.leaf.cards import cards
from treestroke.core.leaf.fruit import FruitParams, hang_fruit, with_fruit
from treestroke.core.leaf.leaves import Leaves, no_leaves
from treestroke.core.leaf.placement import LEAST_SIZE, LeafParams, place_leaves
from treestroke.core.mesh.bark import TEXTURE_SIZE, BarkParams, bark_texture
from treestroke.core.mesh.bark_pattern import bark_pattern
from treestroke.core.mesh.normal_map import NormalMapParams, bark_normal_map
from treestroke.core.mesh.tubes import tubes
from treestroke.core.paint.atlas import Atlas, LeafStyle, leaf_atlas
from treestroke.core.paint.cut_outs import opaque_part, reduced
from treestroke.core.paint.seasons import size_and_density
from treestroke.core.paint.species import AUTO, SPECIES
from treestroke.core.pipeline.crowns import CLOSED_SHARE, closed
from treestroke.core.pipeline.grown_tree import GrownTree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.progress import Report, silent


@dataclass(frozen=True, eq=False)
class OwnPictures:
    """Pictures, (h, w, 4), sRGB with straight alpha, that somebody gives of what the tree bears; None: no own one.

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
    """Hang leaves and fruit on the grown tree: their surface, and what it is made from; None where it bears none.

    Raises
    ------
    ValueError
        A picture is none, or transparent.
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
    """Hang leaves; a tree that bears none has no atlas of them."""
    portrait = tree.portrait
    leafy = np.isposinf(portrait.front)
    if tree.kind == "bare" or settings.leaf_density == 0 or not leafy.any():
        return no_leaves(), None
    pure = portrait.leaves & leafy
    coloured = pure if pure.sum() > 0.1 * leafy.sum() else leafy
    species = SPECIES.get(settings.species, AUTO)
    style = LeafStyle(species, settings.season, portrait.shows_leaves, picture)
    atlas = leaf_atlas(portrait.photo, coloured, tree.kind, rng, style)
    report("leaf", 0.2)
    size, density = size_and_density(settings.season, species, tree.kind == "needles")
    least = max(LEAST_SIZE, size * settings.leaf_size)
    params = LeafParams(least, density * settings.leaf_density, kind=tree.kind)
    what = tree.grown.skeleton, portrait.front, tree.envelope, portrait.photo
    return place_leaves(*what, atlas, params, rng, report), atlas


def _with_fruit(
    tree: GrownTree, leaves: Leaves, atlas: Atlas | None, picture: NDArray[np.uint8], rng: np.random.Generator
) -> tuple[Leaves, Atlas]:
    """Hang fruit too, by numbers of its own: leaves and wood are those of the tree without fruit."""
    own, envelope = rng.spawn(1)[0], tree.envelope
    crown = closed(tree.likeness | np.isposinf(tree.portrait.front), CLOSED_SHARE["bare"])
    views = CrownViews(View(crown, envelope.camera))
    fruit = hang_fruit(tree.grown.skeleton, envelope, views, picture, FruitParams(), own)
    return with_fruit(leaves, atlas if len(leaves) else None, fruit, picture)


def bark_surface(
    tree: GrownTree, settings: ModelSettings, rng: np.random.Generator, report: Report = silent
) -> Surface:
    """Wrap the grown tree in bark that is read off the first stem's visible pixels."""
    wrapping, portrait = tubes(tree.grown.skeleton), tree.portrait
    report("mesh", 0.6)
    bark, known = SPECIES.get(settings.species, AUTO).bark, settings.species != "auto"
    grain = bark_pattern(TEXTURE_SIZE, rng, bark.form)
    params = BarkParams(hidden_colour=bark.colour, form=bark.form if known else None)
    texture = bark_texture(portrait.photo, portrait.stem, portrait.stem_radii, params, rng, grain)
    return Surface(wrapping, texture, bark_normal_map(texture, grain, NormalMapParams(bark.depth)))
