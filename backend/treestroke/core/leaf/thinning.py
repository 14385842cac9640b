"""Fewer, larger cards for a tree that is seen small: those that its silhouettes and its near side need."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import ALPHA_CUT
from treestroke.core.geometry.silhouette import HALF_AZIMUTHS_RAD, Framing
from treestroke.core.leaf.fruit import fruit_among
from treestroke.core.leaf.leaves import Leaves, join_leaves
from treestroke.core.paint.atlas import Atlas, tile_alphas
from treestroke.core.types import Floats, Indices, Mask

_DOTS_ACROSS = 8
"""A tile is looked at in 8 x 8 dots: about the texels of the copy that a viewer takes for a card of 10 px."""
_PROBES = 16
"""Dots of a card that are tried."""
_GAIN_LEFT = 0.3
"""What covering a cell once more is worth, over covering it the last time."""
_NEAR_SIDE = 0.4
"""Worth of a cell on the side that faces a viewer, over that of a cell of the silhouette."""
_OUTSIDE = -0.5
"""Worth of a cell beside the silhouette."""
_FRUIT = 0.25
"""Most of the cards kept that are fruit, as long as there are leaves."""


@dataclass(frozen=True)
class ThinningParams:
    """How cards are thinned out.

    Attributes
    ----------
    most_enlarged
        Most that a card's sides grow.
    area_kept
        Share of the area lost with the cards that went that those kept make up for, where they may grow so much.
    most_outside
        Share of a card's dots that may fall outside the silhouettes when it grows.
    rounds
        Rounds of choosing; each takes those that are worth most after the rounds before.
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
    leaves: Leaves,
    atlas: Atlas,
    count: int,
    view: Framing,
    wanted: NDArray[np.float64],
    params: ThinningParams = ThinningParams(),
) -> Leaves:
    """Choose ``count`` of the cards and enlarge the leaves among them, in their order; fruit stays as far as it may.

    Chosen are those that cover most of the silhouettes, and of the sides that the crown shows from eight azimuths;
    cards that would reach over the silhouettes' edge grow less or not at all. Deterministic.

    Parameters
    ----------
    leaves, atlas
        The cards, and the tiles that they show.
    count
        How many to choose.
    view
        How the silhouettes are framed.
    wanted
        (4, height, width) from `HALF_AZIMUTHS_RAD`, what covering a pixel is worth: 1 where the tree hides it, and
        nothing else but its leaves, 0 beside it.
    params
        How.
    """
    if count >= len(leaves):
        return leaves
    fruit = fruit_among(leaves, atlas)
    if fruit.any():
        left = max(int(_FRUIT * count), count - int((~fruit).sum()))
        first = fruit & (np.cumsum(fruit) <= left)
        others = leaves.select(~fruit), replace(atlas, fruit=None), count - int(first.sum())
        foliage = thin_leaves(*others, view, wanted, params)
        return join_leaves([foliage, leaves.select(first)])
    if count <= 0:
        return leaves.select(np.zeros(len(leaves), dtype=bool))
    dots = _dots(tile_alphas(atlas))[leaves.tiles]
    growth = min((len(leaves) / count) ** (0.5 * params.area_kept), params.most_enlarged)
    scales = _scales(leaves, dots, view, wanted.ravel(), growth, params.most_outside)
    grown = replace(leaves, rights=leaves.rights * scales[:, None], ups=leaves.ups * scales[:, None])
    cells = _cells(grown, dots, view)
    needs = np.concatenate([cells, wanted.size * (1 + _near(grown, _PROBES)) + cells], axis=1)
    worth = np.concatenate(
        [np.where(wanted.ravel() > 0, wanted.ravel(), _OUTSIDE), np.full(2 * wanted.size, _NEAR_SIDE)]
    )
    return grown.select(_chosen(needs, worth, count, params.rounds))


def _dots(alphas: NDArray[np.uint8]) -> Floats:
    """Find some of the dots (k, p, 2), in half-extents, that tiles (k, side, side) of alpha show from afar."""
    found = []
    for alpha in alphas:
        coarse = cv2.resize(alpha, (_DOTS_ACROSS, _DOTS_ACROSS), interpolation=cv2.INTER_AREA)
        row, column = np.nonzero(coarse >= min(255 * ALPHA_CUT, float(coarse.max())))
        spread = np.linspace(0, len(row) - 1, _PROBES).round().astype(np.int64)
        x, y = (column + 0.5) * 2 / _DOTS_ACROSS - 1, 1 - (row + 0.5) * 2 / _DOTS_ACROSS
        found.append(np.stack([x, y], axis=1)[spread])
    return np.stack(found)


def _cells(leaves: Leaves, dots: Floats, view: Framing) -> Indices:
    """Pixels (m, views x p) of dots (m, p, 2) on cards, counted through all views."""
    across = dots[..., :1] * np.where(leaves.flips, -1.0, 1.0)[:, None, None]
    points = leaves.centres[:, None] + across * leaves.rights[:, None] + dots[..., 1:] * leaves.ups[:, None]
    found = []
    for number, azimuth in enumerate(HALF_AZIMUTHS_RAD.tolist()):
        column, row = np.floor(view.project(points, azimuth)).astype(np.int64).transpose(2, 0, 1)
        row = np.clip(row, 0, view.height - 1) + number * view.height
        found.append(row * view.width + np.clip(column, 0, view.width - 1))
    return np.concatenate(found, axis=1)


def _scales(leaves: Leaves, dots: Floats, view: Framing, wanted: Floats, growth: float, most_outside: float) -> Floats:
    """Give the greatest factor (m,) up to ``growth`` at which each card stays within the silhouettes."""
    scales = np.ones(len(leaves))
    for factor in np.linspace(1.0, growth, 4)[1:].tolist():
        outside = (wanted[_cells(leaves, factor * dots, view)] <= 0).mean(axis=1)
        scales[outside <= most_outside] = factor
    return scales


def _near(leaves: Leaves, probes: int) -> NDArray[np.bool_]:
    """Tell on which side of the crown's middle cards are (m, views x probes), true for the nearer."""
    sine, cosine = np.sin(HALF_AZIMUTHS_RAD), np.cos(HALF_AZIMUTHS_RAD)
    nearness = leaves.centres[:, [0]] * sine + leaves.centres[:, [2]] * cosine
    return np.repeat(nearness > np.median(nearness, axis=0), probes, axis=1)


def _chosen(needs: Indices, worth: Floats, count: int, rounds: int) -> Mask:
    """Choose ``count`` cards by the cells (m, c) that they serve."""
    chosen = np.zeros(len(needs), dtype=bool)
    for turn in range(rounds):
        taken = count * (turn + 1) // rounds - count * turn // rounds
        left = np.flatnonzero(~chosen)
        # every other card at a time: neighbours that serve the same cells are worth the same
        tried = left[turn % 2 :: 2] if len(left) // 2 > 2 * taken else left
        best = tried[np.argsort(-worth[needs[tried]].sum(axis=1), kind="stable")[:taken]]
        chosen[best] = True
        served = np.bincount(needs[best].ravel(), minlength=len(worth))
        worth = np.where(worth > 0, worth * _GAIN_LEFT**served, worth)
    return chosen
