"""Leaves: the cards of one tree, as arrays; fruit hangs among them."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from treestroke.core.geometry.mesh import ALPHA_CUT
from treestroke.core.paint.atlas import Atlas, tile_alphas
from treestroke.core.types import Floats, Indices, Mask


@dataclass(frozen=True, eq=False)
class Leaves:
    """m cards; each shows one tile of the atlas, a spray that grows in the direction of ``ups``.

    A card is a rectangle, or one that is folded along the diagonal from its tile's lower left to the upper right.

    Attributes
    ----------
    centres
        (m, 3) middle of each card, metres, world.
    rights, ups
        (m, 3) half its width and half its height, metres, at right angles; right x up points outward.
    tiles
        (m,) index of its tile in the atlas.
    flips
        (m,) whether it shows the tile mirrored.
    shades
        (m,) brightness, 0 to 1.
    joints
        (m,) index of the skeleton's joint whose edge it hangs on.
    """

    centres: Floats
    rights: Floats
    ups: Floats
    tiles: Indices
    flips: Mask
    shades: Floats
    joints: Indices

    def __post_init__(self) -> None:
        m = len(self.centres)
        if any(getattr(self, name).shape != (m, 3) for name in ("centres", "rights", "ups")):
            raise ValueError("centres, rights and ups must be (m, 3)")
        if any(getattr(self, name).shape != (m,) for name in ("tiles", "flips", "shades", "joints")):
            raise ValueError(f"{m} cards need as many tiles, flips, shades and joints")

    def __len__(self) -> int:
        return len(self.centres)

    def ridges(self, fold: float) -> Floats:
        """How far (m, 3), metres, the folds of cards stand before their flat middles, for a fold as an atlas has it."""
        size = np.maximum(np.linalg.norm(self.rights, axis=1, keepdims=True), 1e-12)
        return np.asarray(fold * np.cross(self.rights, self.ups) / size)

    def select(self, kept: Mask) -> "Leaves":
        """Keep the marked cards (m,), a mask."""
        return Leaves(*(getattr(self, field.name).compress(kept, axis=0) for field in fields(self)))


def join_leaves(parts: Sequence[Leaves]) -> Leaves:
    """Concatenate cards in the order given; without parts there are no cards."""
    if not parts:
        return no_leaves()
    return Leaves(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Leaves)))


def no_leaves() -> Leaves:
    """Return no cards."""
    vectors, indices = np.zeros((0, 3)), np.zeros(0, dtype=np.int64)
    return Leaves(vectors, vectors, vectors, indices, np.zeros(0, dtype=np.bool_), np.zeros(0), indices)


def fruit_among(leaves: Leaves, atlas: Atlas) -> Mask:
    """Tell which cards (m,) are fruit: those that show the atlas's fruit tile."""
    return np.zeros(len(leaves), dtype=bool) if atlas.fruit is None else leaves.tiles == atlas.fruit


def leaf_area(leaves: Leaves, atlas: Atlas) -> float:
    """One-sided area of all leaves, square metres: what remains of their cards when cut at `ALPHA_CUT`.

    Leaves that overlap within one spray count once; fruit does not count.
    """
    leaves = leaves.select(~fruit_among(leaves, atlas))
    drawn = (tile_alphas(atlas) >= 255 * ALPHA_CUT).mean(axis=(1, 2))
    folding = np.sqrt(1 + 2 * atlas.fold**2)  # over the area of a flat square
    card_areas = 4 * folding * np.linalg.norm(leaves.rights, axis=1) * np.linalg.norm(leaves.ups, axis=1)
    return float((card_areas * drawn[leaves.tiles]).sum())
