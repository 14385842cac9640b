"""How alike a tree's levels of detail are to the whole tree."""

from collections.abc import Sequence

import numpy as np

from treestroke.core.geometry.mesh import Surface
from treestroke.core.geometry.silhouette import framing, overlap, silhouettes
from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.pipeline.levels import HEIGHTS_PX, Level, Levels


def silhouette_ious(fine: Sequence[Surface], coarse: Sequence[Surface], height_px: int) -> np.ndarray:
    """Compare silhouettes (8,) from `AZIMUTHS_RAD`, the finer tree ``height_px`` tall: intersection over union.

    Those from behind equal those from the front, being of the mirror images.
    """
    view = framing(fine, height_px)
    pairs = zip(silhouettes(coarse, view), silhouettes(fine, view), strict=True)
    found = [overlap(seen, wanted) for seen, wanted in pairs]
    return np.array(found + found)


def level_ious(tree: TreeModel, made: Levels) -> dict[str, float]:
    """Compare silhouettes with the whole tree's, each level at its own height: the least IoU of 8 azimuths."""
    whole = Level(tree.bark, tree.leaf).surfaces
    coarse = {"lod1": made.lod1.surfaces, "lod2": made.lod2.surfaces, "impostor": (made.impostor,)}
    sizes = zip(coarse.items(), HEIGHTS_PX, strict=True)
    return {name: float(silhouette_ious(whole, surfaces, height).min()) for (name, surfaces), height in sizes}
