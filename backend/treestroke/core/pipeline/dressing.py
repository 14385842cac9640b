"""What a grown tree wears: leaves and bark, from the photo and from what is known of its species and season."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import Surface
from treestroke.core.geometry.polyline import Indices
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
from treestroke.core.pipeline.growing import GrownTree, Seen, drawn_depth
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.progress import Report, silent
from treestroke.core.trace.tracing import Traced

BARE_BREADTH = 0.5
"""Of a visible branch's width: no leaf hangs before it there. More would show sky where the grown wood is thinner."""


def leaf_surface(
    seen: Seen,
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
    front = _front(seen, tree)
    leafy = np.isposinf(front)
    if tree.kind == "bare" or settings.leaf_density == 0 or not leafy.any():
        return None, None, None
    pure = seen.foliage.pure & leafy
    coloured = pure if pure.sum() > 0.1 * leafy.sum() else leafy
    species, photo = KINDS[settings.species], seen.sight.photo
    look = LeafLook(species, settings.season, tree.shows_leaves, leaf_picture)
    atlas = leaf_atlas(photo, coloured, tree.kind, rng, look)
    report("leaf", 0.2)
    size, density = size_and_density(settings.season, species, tree.kind == "needles")
    least = max(LEAST_SIZE, size * settings.leaf_size)
    params = LeafParams(least, density * settings.leaf_density, kind=tree.kind)
    leaves = place_leaves(tree.grown.skeleton, front, tree.envelope, photo, atlas, params, rng, report)
    return (Surface(cards(leaves, atlas), atlas.image), leaves, atlas) if len(leaves) else (None, None, None)


def bark_surface(
    seen: Seen, tree: GrownTree, settings: ModelSettings, rng: np.random.Generator, report: Report = silent
) -> Surface:
    """Wrap the grown tree in bark that is read off the first stem's visible pixels."""
    wrapping = tubes(tree.grown.skeleton)
    report("mesh", 0.6)
    bark, known = KINDS[settings.species].bark, settings.species != "auto"
    stem = first_stem(tree.traced)
    radii = np.where(tree.traced.measured[stem], tree.traced.skeleton.radii[stem], 0.0)
    grain = bark_grain(TEXTURE_SIZE, rng, bark.form)
    params = BarkParams(hidden_colour=bark.colour, form=bark.form if known else None)
    texture = bark_texture(seen.sight.photo, tree.traced.skeleton.points[stem], radii, params, rng, grain)
    return Surface(wrapping, texture, bark_relief(texture, grain, ReliefParams(bark.depth)))


def first_stem(traced: Traced) -> Indices:
    """Joints under the first stroke, root first."""
    return np.flatnonzero(traced.stroke == 0)


def _front(seen: Seen, tree: GrownTree) -> NDArray[np.float32]:
    """World Z (h, w), metres, behind which leaves may lie: infinite in the foliage, that of the wood where it is seen.

    What is a leaf by its colour hangs before the wood.
    """
    traced, foliage = tree.traced, seen.foliage
    what = tree.visible, traced.measured[tree.owner], tree.depth_m, foliage.mask.shape
    wood, middle = drawn_depth(*what, 1.0), drawn_depth(*what, BARE_BREADTH)
    front = np.where(np.isnan(wood) | ~foliage.region, -np.inf, wood)
    leaves = foliage.pure & ~traced.wood & tree.shows_leaves
    front[tree.leafy & (np.isnan(middle) | leaves)] = np.inf
    return front.astype(np.float32)
