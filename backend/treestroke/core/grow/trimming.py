"""Cuts twig ends back to the foliage."""

from dataclasses import replace

import numpy as np

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.grow.grown import Grown
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root


def trimmed(grown: Grown, foliage: Silhouette[Camera]) -> Grown:
    """Drop the ends of twigs outside the foliage, where no leaf would hide them; twigs that reenter it stay.

    Growth may cross the gaps of a crown, as branches do. Visible joints stay.
    """
    tree = grown.skeleton
    wanted = (grown.born == 0) | foliage.shows(tree.points)
    kept = accumulate_to_root(tree, wanted.astype(np.float64)) > 0
    number = np.cumsum(kept) - 1
    parents = np.where(tree.parents < 0, -1, number[tree.parents])[kept]
    return replace(grown, skeleton=Skeleton(tree.points[kept], tree.radii[kept], parents), born=grown.born[kept])
