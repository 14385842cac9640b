"""Names of arrays and of values that several stages share."""

from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Mask = NDArray[np.bool_]
"""(h, w) where it belongs to a picture."""
Opacity = NDArray[np.float32]
"""(h, w) share of each pixel of a picture, 0 to 1, that something covers."""
Picture = NDArray[np.uint8]
"""(h, w, 3) sRGB, or (h, w, 4) with straight alpha."""
FoliageKind = Literal["leaves", "needles", "scales", "palm", "bare"]
"""What twigs bear: scales are those of cypress, thuja and juniper, palm is fronds or straps in crowns of their own."""
TreeForm = Literal["round", "spire", "columnar", "umbrella", "weeping", "vase", "multi_stem"]
"""How a tree's limbs grow: evenly, about one leader, steeply, flat, hanging, spreading, or on several stems."""
FOLIAGE_KINDS: tuple[FoliageKind, ...] = get_args(FoliageKind)
TREE_FORMS: tuple[TreeForm, ...] = get_args(TreeForm)
CONIFEROUS: tuple[FoliageKind, ...] = ("needles", "scales")
EVERGREEN: tuple[FoliageKind, ...] = (*CONIFEROUS, "palm")
"""Kinds that keep their colour all year and bear no blossom, unless the species says otherwise."""
