"""How much leaf a tree bears."""

import numpy as np

from treestroke.core.leaf.fruit import fruit_among
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.paint.atlas import Atlas, tile_alphas


def leaf_area(leaves: Leaves, atlas: Atlas) -> float:
    """Sum the opaque area of all leaves, one side, square metres; those that hide each other in a spray count once."""
    leaves = leaves.select(~fruit_among(leaves, atlas))
    opaque = (tile_alphas(atlas) > 127).mean(axis=(1, 2))
    sides = 4 * np.linalg.norm(leaves.rights, axis=1) * np.linalg.norm(leaves.ups, axis=1)
    return float((sides * opaque[leaves.tiles]).sum())
