"""Pictures that are like another one: patches of it, put together along a new outline."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Indices, Mask

PATCH, MARGIN = 8, 2
"""Side of the patches, and how far around a patch its surroundings must be alike, px."""
CANDIDATES = 400
"""Patches, drawn at random, of which each place gets the one most alike."""
LEVEL = 0.1
"""How far above or below its own height a patch may come from, as a share of the picture's height."""
SIDE = PATCH + 2 * MARGIN
"""Side of a patch with its surroundings, px; depths beyond it count as so deep."""
WITHIN = slice(MARGIN, MARGIN + PATCH)
"""Where the patch lies in its surroundings, along both sides."""


@dataclass(frozen=True, eq=False)
class Analogy:
    """Which pixel of a picture each pixel of the new one is a copy of.

    Attributes
    ----------
    row, column
        (h, w) the pixel of the old picture; -1 where the new one is blank.
    mirrored
        (h, w) whether it comes from a mirrored patch.
    """

    row: Indices
    column: Indices
    mirrored: Mask

    def of(self, picture: Mask) -> Mask:
        """Make the new picture (h, w) of the old one."""
        return np.asarray((self.row >= 0) & picture[self.row, self.column])


@dataclass(frozen=True, eq=False)
class _Patches:
    """Patches of a picture with what is around them: n in all.

    ``rows`` (n, s, 1) and ``columns`` (n, 1, s) are pixels of the picture with its border; ``depths`` and ``shown``
    (n, s, s) are how far they lie in the outline and what they show.
    """

    rows: Indices
    columns: Indices
    depths: NDArray[np.float32]
    shown: NDArray[np.float32]

    def alike(self, depths: NDArray[np.float32], shown: NDArray[np.float32], known: Mask) -> int:
        """Find the patch that lies to its outline as here (s, s), and shows what is ``known`` (s, s) here already."""
        cost = np.square(self.depths - depths).mean(axis=(1, 2)) / SIDE
        if known.any():
            cost += np.abs(self.shown - shown)[:, known].mean(axis=1)
        return int(cost.argmin())


def analogy(picture: Mask, depths: Floats, new_depths: Floats, rng: np.random.Generator) -> Analogy:
    """Make up a picture that is to a new outline as the old one is to its own.

    ``depths`` says for each pixel of the ``picture`` (h, w) how far it lies within its outline, px, negative outside,
    and ``new_depths`` (h, v) for each pixel of the new one. This is put together patch by patch, each from about the
    same height, perhaps mirrored, where it lies to the outline as it is to lie now and continues its neighbours.

    Source: image analogies, Hertzmann et al. 2001, section 3, patch by patch as in image quilting, Efros and Freeman
    2001.
    """
    border = (MARGIN, MARGIN + PATCH)
    old, new = (
        np.pad(np.clip(of, -SIDE, SIDE).astype(np.float32), border, constant_values=-SIDE)
        for of in (depths, new_depths)
    )
    shown, made = np.pad(picture, border).astype(np.float32), np.zeros(new.shape, dtype=np.float32)
    known = np.zeros(new.shape, dtype=np.bool_)
    source = np.full((3, *new.shape), -1)
    for top in range(0, len(new_depths), PATCH):
        patches = _drawn(old, shown, top, rng)
        for left in range(0, new_depths.shape[1], PATCH):
            around = (slice(top, top + SIDE), slice(left, left + SIDE))
            if new[around].max() <= -SIDE / 2:
                continue
            best = patches.alike(new[around], made[around], known[around])
            rows, columns = patches.rows[best][WITHIN], patches.columns[best][:, WITHIN]
            place = (slice(top + MARGIN, top + MARGIN + PATCH), slice(left + MARGIN, left + MARGIN + PATCH))
            made[place], known[place] = patches.shown[best][WITHIN, WITHIN], True
            source[(0, *place)], source[(1, *place)] = rows - MARGIN, columns - MARGIN
            source[(2, *place)] = columns[0, 0] > columns[0, 1]
    row, column, mirrored = source[:, MARGIN : MARGIN + len(new_depths), MARGIN : MARGIN + new_depths.shape[1]]
    blank = (row < 0) | (row >= len(picture)) | (column < 0) | (column >= picture.shape[1])
    return Analogy(np.where(blank, -1, row), np.where(blank, -1, column), mirrored > 0)


def _drawn(old: NDArray[np.float32], shown: NDArray[np.float32], top: int, rng: np.random.Generator) -> _Patches:
    """Draw patches of a picture (h, w), its border included, from about this height, half of them mirrored."""
    height, width = (n - SIDE for n in old.shape)
    low, high = (np.clip(top + way * LEVEL * height, 0, height - 1).astype(np.int64) for way in (-1, 1))
    first_row, first_column = rng.integers(low, high + 1, CANDIDATES), rng.integers(0, width + 1, CANDIDATES)
    ahead = np.arange(SIDE)
    rows = first_row[:, None, None] + ahead[:, None]
    columns = first_column[:, None, None] + np.where(rng.random((CANDIDATES, 1, 1)) < 0.5, ahead[::-1], ahead)
    return _Patches(rows, columns, old[rows, columns], shown[rows, columns])
