"""How alike a tree's levels of detail are to the whole tree."""

from treestroke.core.geometry.silhouette import silhouette_ious
from treestroke.core.pipeline.levels import HEIGHTS_PX, Level, Levels
from treestroke.core.pipeline.photo import TreeModel


def level_ious(tree: TreeModel, made: Levels) -> dict[str, float]:
    """Compare silhouettes with the whole tree's, each level at its own height: the least IoU of 8 azimuths."""
    whole = Level(tree.bark, tree.leaf).surfaces
    coarse = {"lod1": made.lod1.surfaces, "lod2": made.lod2.surfaces, "impostor": (made.impostor,)}
    sizes = zip(coarse.items(), HEIGHTS_PX, strict=True)
    return {name: float(silhouette_ious(whole, surfaces, height).min()) for (name, surfaces), height in sizes}
