"""Lowering the nearest cards' depths in plain numpy; ``_covering.c`` does the same some ten times faster."""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Indices


def lower(
    nearest: NDArray[np.float32],
    cards: NDArray[np.float32],
    kinds: Indices,
    dots: NDArray[np.float32],
    starts: Indices,
) -> None:
    """Lower the depths ``nearest`` (h, w), metres, of a grid's cells to those of the cards that hide them.

    Parameters
    ----------
    nearest
        Contiguous; changed.
    cards
        (m, 9) middle, half-extents right and up, and ridge, x and y each, in cells; depth, metres.
    kinds
        (m,) kind of each card: its dots are ``dots[starts[kind]:starts[kind + 1]]``.
    dots
        (k, 2) in half-extents of a card, right and up.
    starts
        (kinds + 1,) first dot of each kind, then their number.
    """
    counts = np.diff(starts)[kinds]
    card = np.repeat(np.arange(len(cards)), counts)
    dot = np.arange(len(card)) + np.repeat(starts[kinds] - (np.cumsum(counts) - counts), counts)
    (right, up), places = dots[dot].T, []
    before = 1 - np.abs(right - up)
    for axis in (0, 1):
        middle, to_right, to_top, ridge = np.ascontiguousarray(cards[:, axis:8:2].T)
        place = right * to_right[card]
        place += up * to_top[card]
        place += before * ridge[card]
        place += middle[card]
        places.append(np.clip(place, 0, nearest.shape[1 - axis] - 1).astype(np.int32))
    column, row = places
    np.minimum.at(nearest.reshape(-1), row * nearest.shape[1] + column, cards[card, 8])  # flat is three times as fast
