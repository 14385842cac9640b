"""Colours of a tree's leaves and wood, and of what is around it, carried from stroked shots to the others."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np

from treestroke.core.imaging.mixture import (
    Mixture,
    fit_mixture,
    join_mixtures,
    log_density,
    table_colours,
    table_index,
)
from treestroke.core.segment.view_mattes_drawn import DrawnTree
from treestroke.core.types import Mask, Opacity, Picture

LEAF_COMPONENTS, WOOD_COMPONENTS, GROUND_COMPONENTS = 8, 5, 16
SAMPLES = 8000
"""Approximate number of pixels that a mixture is fitted to."""
SURE = 0.95
"""Opacity from which on a pixel shows the tree alone: mixed pixels would make sky between twigs a colour of theirs."""
WOOD_SHARE = 0.2
"""Share of wood in what is seen of a tree in leaf."""
FEWEST = 100
"""Least number of pixels that teach the colours of wood."""
MOST = 6.0
"""Greatest log odds of wood against leaves."""


@dataclass(frozen=True, eq=False)
class TreeColours:
    """Colour models of a tree's leaves and of its wood: a bare tree has no leaves, one without a stem no wood."""

    leaf: Mixture | None
    wood: Mixture | None

    @cached_property
    def tree(self) -> Mixture:
        """Both together."""
        if self.leaf is None or self.wood is None:
            only = self.leaf or self.wood
            assert only is not None
            return only
        return join_mixtures([self.leaf, self.wood], [1 - WOOD_SHARE, WOOD_SHARE])

    def wood_share(self, pixels: Picture) -> Opacity:
        """Return how likely each pixel (h, w, 3), sRGB, is wood, if it is the tree."""
        if self.leaf is None or self.wood is None:
            return np.full(pixels.shape[:2], float(self.leaf is None), dtype=np.float32)
        colours = table_colours()
        odds = log_density(self.wood, colours) - log_density(self.leaf, colours)
        odds = np.clip(odds, -MOST, MOST) + np.log(WOOD_SHARE / (1 - WOOD_SHARE))
        return np.asarray((1 / (1 + np.exp(-odds))).astype(np.float32)[table_index(pixels)])


def tree_colours(
    pictures: Sequence[Picture],
    trees: Sequence[DrawnTree],
    kept: Sequence[Mask],
    further: tuple[Sequence[Picture], Sequence[Picture]] = ((), ()),
) -> TreeColours:
    """Fit the colour models to what stroked shots (h, w, 3), sRGB, show of the tree for sure.

    ``kept`` (h, w) is where that is believed. ``further`` are pixels (n, 3) of the crown and of
    the trunk in other shots: the sun shines on another side of them there.
    """
    crowns, stems = [], []
    for picture, tree, believed in zip(pictures, trees, kept, strict=True):
        stem = inner(tree.stem)
        sure = (tree.alpha > SURE) & believed
        crown = (sure if tree.bare else inner(sure)) & ~stem
        crowns.append(picture[crown])
        stems.append(picture[stem])
    crown_colours, stem_colours = np.concatenate(crowns), np.concatenate([*stems, *further[1]])
    if any(tree.bare for tree in trees) or not len(crown_colours):
        return TreeColours(None, fitted([crown_colours, stem_colours], LEAF_COMPONENTS + WOOD_COMPONENTS))
    parts = [_sample(crown_colours)]
    if further[0]:
        parts.append(_sample(np.concatenate(further[0])))
    leaf = fit_mixture(np.concatenate(parts), LEAF_COMPONENTS)
    wood = fitted([stem_colours], WOOD_COMPONENTS) if len(stem_colours) >= FEWEST else None
    return TreeColours(leaf, wood)


def ground_colours(pictures: Sequence[Picture], elsewhere: Sequence[Mask]) -> Mixture:
    """Fit a colour model to what all shots (h, w, 3), sRGB, show away from the tree (h, w)."""
    return fitted([picture[away] for picture, away in zip(pictures, elsewhere, strict=True)], GROUND_COMPONENTS)


def fitted(parts: Sequence[Picture], components: int) -> Mixture:
    """Fit a mixture to about `SAMPLES` of some pixels, each part (n, 3), sRGB."""
    return fit_mixture(_sample(np.concatenate(parts)), components)


def _sample(pixels: Picture) -> Picture:
    """Take about `SAMPLES` of some pixels (n, 3), evenly spaced."""
    return pixels[:: max(1, len(pixels) // SAMPLES)]


def inner(mask: Mask) -> Mask:
    """Return the pixels of a mask (h, w) whose eight neighbours belong to it."""
    return np.asarray(cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0)
