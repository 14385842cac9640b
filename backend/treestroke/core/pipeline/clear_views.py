"""Views freed of their background and brought to the light that leaves and bark are shown in."""

from dataclasses import replace

import numpy as np

from treestroke.core.appearance import Appearance, View
from treestroke.core.imaging.light import evened, exposed
from treestroke.core.imaging.unmix import unmixed
from treestroke.core.side_by_side import side_by_side


def clear_views(appearance: Appearance, light: str) -> Appearance:
    """Leave the colours of leaf and wood alone in all views; ``light`` is one of the setting's values.

    Where the views show no leaves, only wood is read of them.
    """
    return replace(appearance, views=tuple(side_by_side(lambda view: _clear(view, light), appearance.views)))


def _clear(view: View, light: str) -> View:
    """Unmix a view's colours by its opacity, and set its exposure by its leaves and wood."""
    wood = view.tree & ~view.foliage
    opacity = np.maximum(view.opacity, wood.astype(np.float32))
    picture = unmixed(view.picture, opacity, view.leaf_coloured | wood)
    picture = exposed(picture, (view.leaf_coloured & view.foliage) | wood)
    if light == "even":
        picture = evened(picture, view.tree)
    return replace(view, picture=picture)
