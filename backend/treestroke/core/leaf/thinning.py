"""Fewer, larger cards for a tree that is seen small, chosen by what its silhouettes and its near side need."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import ALPHA_CUT
from treestroke.core.geometry.silhouette import HALF_AZIMUTHS_RAD, Framing
from treestroke.core.leaf.leaves import Leaves, fruit_among, join_leaves
from treestroke.core.paint.atlas import Atlas, tile_alphas
from treestroke.core.types import Floats, Indices, Mask

_GRID = 8
"""Dots a side in which a tile is sampled: about the texels of the mip level that a card of 10 px shows."""
_PROBES = 16
"""Opaque dots of a card that are tested."""
_REPEAT_VALUE = 0.3
"""Value of covering a cell again, relative to the time before."""
_NEAR_SIDE_VALUE = 0.4
"""Value of a cell on the side that faces a viewer, relative to a cell of the silhouette."""
_OUTSIDE_VALUE = -0.5
"""Value of a cell beside the silhouette."""
_MOST_FRUIT = 0.25
"""Greatest share of the kept cards that are fruit, as long as there are leaves."""


@dataclass(frozen=True, eq=False)
class Coverage:
    """The silhouettes that the remaining cards should cover.

    Attributes
    ----------
    framing
        Framing of the silhouettes, px.
    values
        (4, height, width) value of covering each pixel seen from `HALF_AZIMUTHS_RAD`, 0 to 1: 1 where leaves alone hide
        the background, 0 beside the tree.
    """

    framing: Framing
    values: Floats


@dataclass(frozen=True)
class ThinningParams:
    """How cards are thinned out.

    Attributes
    ----------
    most_enlarged
        Greatest factor on the sides of a card.
    area_kept
        Share of the removed cards' area that the others make up for by growing, as far as ``most_enlarged`` allows.
    most_outside
        Greatest share of a card's dots that may fall outside the silhouettes as it grows.
    rounds
        Rounds of choosing; each takes the cards of most value after the rounds before.
    """

    most_enlarged: float = 2.4
    area_kept: float = 0.9
    most_outside: float = 0.1
    rounds: int = 12

    def __post_init__(self) -> None:
        if self.rounds < 1 or self.most_enlarged < 1:
            raise ValueError(f"thinning needs a round and cards that do not shrink, got {self}")
        if not (0 <= self.area_kept <= 1 and 0 <= self.most_outside <= 1):
            raise ValueError(f"shares must be 0 to 1, got {self}")


def thin_leaves(
    leaves: Leaves, atlas: Atlas, count: int, coverage: Coverage, params: ThinningParams = ThinningParams()
) -> Leaves:
    """Choose ``count`` of the cards (m,), in their order, and enlarge the leaves among them.

    The cards chosen are those that cover most of the silhouettes, and of the sides that the crown shows from eight
    azimuths. A card that would reach beyond the silhouettes' edge grows less or not at all. Fruit keeps its size and is
    kept as far as its share allows. Deterministic.

    Source: the greedy choice for maximum coverage, Nemhauser, Wolsey and Fisher 1978; docs/decisions/0013
    describes the cells.

    Parameters
    ----------
    leaves, atlas
        The cards, metres, and the tiles that they show.
    count
        Number of cards to keep.
    coverage
        Silhouettes to cover, px.
    params
        How cards are thinned out.
    """
    if count >= len(leaves):
        return leaves
    fruit = fruit_among(leaves, atlas)
    if fruit.any():
        most_fruit = max(int(_MOST_FRUIT * count), count - int((~fruit).sum()))
        kept_fruit = fruit & (np.cumsum(fruit) <= most_fruit)
        leaves_left = count - int(kept_fruit.sum())
        foliage = thin_leaves(leaves.select(~fruit), replace(atlas, fruit=None), leaves_left, coverage, params)
        return join_leaves([foliage, leaves.select(kept_fruit)])
    if count <= 0:
        return leaves.select(np.zeros(len(leaves), dtype=bool))
    dots = _opaque_dots(tile_alphas(atlas))[leaves.tiles]
    growth = min((len(leaves) / count) ** (0.5 * params.area_kept), params.most_enlarged)
    scales = _scales(leaves, dots, coverage, growth, params.most_outside)
    enlarged = replace(leaves, rights=leaves.rights * scales[:, None], ups=leaves.ups * scales[:, None])
    covered, values = _covered_cells(enlarged, dots, coverage)
    return enlarged.select(_most_valuable(covered, values, count, params.rounds))


def _opaque_dots(alphas: NDArray[np.uint8]) -> Floats:
    """Positions (k, _PROBES, 2), in half-extents, of dots that stay opaque in small copies of tiles (k, side, side)."""
    found = []
    for alpha in alphas:
        coarse = cv2.resize(alpha, (_GRID, _GRID), interpolation=cv2.INTER_AREA)
        row, column = np.nonzero(coarse >= min(255 * ALPHA_CUT, float(coarse.max())))
        spread = np.linspace(0, len(row) - 1, _PROBES).round().astype(np.int64)
        x, y = (column + 0.5) * 2 / _GRID - 1, 1 - (row + 0.5) * 2 / _GRID
        found.append(np.stack([x, y], axis=1)[spread])
    return np.stack(found)


def _silhouette_pixels(leaves: Leaves, dots: Floats, framing: Framing) -> Indices:
    """Flat pixel indices (m, views x p), through all views, of the cards' dots (m, p, 2), in half-extents."""
    across = dots[..., :1] * np.where(leaves.flips, -1.0, 1.0)[:, None, None]
    points = leaves.centres[:, None] + across * leaves.rights[:, None] + dots[..., 1:] * leaves.ups[:, None]
    found = []
    for number, azimuth in enumerate(HALF_AZIMUTHS_RAD.tolist()):
        column, row = np.floor(framing.project(points, azimuth)).astype(np.int64).transpose(2, 0, 1)
        row = np.clip(row, 0, framing.height - 1) + number * framing.height
        found.append(row * framing.width + np.clip(column, 0, framing.width - 1))
    return np.concatenate(found, axis=1)


def _scales(leaves: Leaves, dots: Floats, coverage: Coverage, growth: float, most_outside: float) -> Floats:
    """Greatest factor (m,), up to ``growth``, at which each card stays within the silhouettes."""
    scales, values = np.ones(len(leaves)), coverage.values.ravel()
    for factor in np.linspace(1.0, growth, 4)[1:].tolist():
        pixels = _silhouette_pixels(leaves, factor * dots, coverage.framing)
        scales[(values[pixels] <= 0).mean(axis=1) <= most_outside] = factor
    return scales


def _covered_cells(leaves: Leaves, dots: Floats, coverage: Coverage) -> tuple[Indices, Floats]:
    """Return the indices (m, c) of the cells that each card covers, and the value of every cell.

    Cells are the pixels of the silhouettes, then those of the far and of the near side of the crown in each view.
    """
    pixels, values = _silhouette_pixels(leaves, dots, coverage.framing), coverage.values.ravel()
    sides = len(values) * (1 + _on_near_side(leaves, dots.shape[1])) + pixels
    silhouette_values = np.where(values > 0, values, _OUTSIDE_VALUE)
    return (
        np.concatenate([pixels, sides], axis=1),
        np.concatenate([silhouette_values, np.full(2 * len(values), _NEAR_SIDE_VALUE)]),
    )


def _on_near_side(leaves: Leaves, dots: int) -> Mask:
    """Tell which dots (m, views x dots) lie on cards in the half of the crown that is nearer to the viewer."""
    sine, cosine = np.sin(HALF_AZIMUTHS_RAD), np.cos(HALF_AZIMUTHS_RAD)
    nearness = leaves.centres[:, [0]] * sine + leaves.centres[:, [2]] * cosine
    return np.repeat(nearness > np.median(nearness, axis=0), dots, axis=1)


def _most_valuable(covered: Indices, values: Floats, count: int, rounds: int) -> Mask:
    """Choose ``count`` cards (m,) greedily by the values of the cells (m, c) that they cover."""
    chosen = np.zeros(len(covered), dtype=bool)
    for turn in range(rounds):
        taken = count * (turn + 1) // rounds - count * turn // rounds
        left = np.flatnonzero(~chosen)
        # Every other card in turn: neighbours cover the same cells, so that both would seem to be of most value.
        candidates = left[turn % 2 :: 2] if len(left) // 2 > 2 * taken else left
        best = candidates[np.argsort(-values[covered[candidates]].sum(axis=1), kind="stable")[:taken]]
        chosen[best] = True
        times = np.bincount(covered[best].ravel(), minlength=len(values))
        values = np.where(values > 0, values * _REPEAT_VALUE**times, values)
    return chosen
