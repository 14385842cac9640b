"""Radii of limbs, measured by how wide the shots show them."""

from collections.abc import Sequence

import numpy as np

from treestroke.core.lift.thin_hull import ShownArea
from treestroke.core.types import Floats, Indices

QUANTILE, INSIDE_QUANTILE = 0.3, 0.65
"""Which of the shots' radii tells, from the least up: in others, other wood or leaves stand beside the limb. Of the
radii of the wood alone a greater one: leaves before it narrow it. On a bare oak the radii come out as 0.97, 1.14, 1.12
and 1.05 of the true ones of levels 0 to 3, in the median, with true mattes."""
OUTLINE_PX = 0.5
"""How much further the next pixel beside the wood is than its outline, px."""
FEWEST = 2
"""Shots that must show a place."""


def limb_radii(
    points: Floats, areas: Sequence[ShownArea], quantiles: tuple[float, float] = (QUANTILE, INSIDE_QUANTILE)
) -> Floats:
    """Measure the radius of the wood (n,), metres, about points (n, 3) on centre lines; 0 where too few shots show it.

    In each shot it is the greatest distance from the outline near the point; ``quantiles`` tell which of the shots'
    counts, of the tree's outline and of the wood's.
    """
    within, inside = (np.full((len(areas), len(points)), np.inf) for _ in range(2))
    for number, area in enumerate(areas):
        pixel = area.shot.camera.pixel_size(points)
        of_tree, of_wood = area.widest(points)
        shows = of_wood > 0
        within[number, shows] = ((of_tree - OUTLINE_PX) * pixel)[shows]
        inside[number, shows] = ((of_wood - OUTLINE_PX) * pixel)[shows]
    told = np.isfinite(within).sum(axis=0)
    radii = np.minimum(_ranked(within, told, quantiles[0]), _ranked(inside, told, quantiles[1]))
    return np.where(told >= FEWEST, np.maximum(radii, 0.0), 0.0)


def _ranked(radii: Floats, told: Indices, quantile: float) -> Floats:
    """Return the radii (n,) at a quantile of those told (n,) by shots, (shots, n); infinite ones are not told."""
    place = np.floor(quantile * np.maximum(told - 1, 0)).astype(np.int64)
    return np.asarray(np.take_along_axis(np.sort(radii, axis=0), place[None], axis=0)[0])
