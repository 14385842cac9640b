"""What a grown tree wears: leaves and bark, from the photo and from what is known of its species and season."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import Surface
from treestroke.core.leaf.atlas import Atlas, LeafLook, leaf_atlas
from treestroke.core.leaf.cards import cards
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.leaf.placement import LEAST_SIZE, LeafParams, place_leaves
from treestroke.core.leaf.seasons import size_and_density
from treestroke.core.leaf.species import KINDS
from treestroke.core.mesh.bark import TEXTURE_SIZE, BarkParams, bark_texture
from treestroke.core.mesh.grain import bark_grain
from treestroke.core.mesh.relief import ReliefParams, bark_relief
from treestroke.core.mesh.tubes import tubes
from treestroke.core.pipeline.grown_tree import GrownTree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.progress import Report, silent


def leaf_surface(
    tree: GrownTree,
    settings: ModelSettings,
    leaf_picture: NDArray[np.uint8] | None,
    rng: np.random.Generator,
    report: Report = silent,
) -> tuple[Surface, Leaves, Atlas] | tuple[None, None, None]:
    """Hang leaves on the grown tree: their surface, and what it is made from; None where it bears none.

    ``leaf_picture`` (h, w, 4), sRGB with straight alpha, stalk down, is drawn instead of the species' leaf.

    Raises
    ------
    ValueError
        The picture is none, or transparent.
    """
    portrait = tree.portrait
    leafy = np.isposinf(portrait.front)
    if tree.kind == "bare" or settings.leaf_density == 0 or not leafy.any():
        return None, None, None
    pure = portrait.leaves & leafy
    coloured = pure if pure.sum() > 0.1 * leafy.sum() else leafy
    species = KINDS[settings.species]
    look = LeafLook(species, settings.season, portrait.shows_leaves, leaf_picture)
    atlas = leaf_atlas(portrait.photo, coloured, tree.kind, rng, look)
    report("leaf", 0.2)
    size, density = size_and_density(settings.season, species, tree.kind == "needles")
    least = max(LEAST_SIZE, size * settings.leaf_size)
    params = LeafParams(least, density * settings.leaf_density, kind=tree.kind)
    what = tree.grown.skeleton, portrait.front, tree.envelope, portrait.photo
    leaves = place_leaves(*what, atlas, params, rng, report)
    return (Surface(cards(leaves, atlas), atlas.image), leaves, atlas) if len(leaves) else (None, None, None)


def bark_surface(
    tree: GrownTree, settings: ModelSettings, rng: np.random.Generator, report: Report = silent
) -> Surface:
    """Wrap the grown tree in bark that is read off the first stem's visible pixels."""
    wrapping, portrait = tubes(tree.grown.skeleton), tree.portrait
    report("mesh", 0.6)
    bark, known = KINDS[settings.species].bark, settings.species != "auto"
    grain = bark_grain(TEXTURE_SIZE, rng, bark.form)
    params = BarkParams(hidden_colour=bark.colour, form=bark.form if known else None)
    texture = bark_texture(portrait.photo, portrait.stem, portrait.stem_radii, params, rng, grain)
    return Surface(wrapping, texture, bark_relief(texture, grain, ReliefParams(bark.depth)))
