"""The library of elementary subtrees that growth lays over branches."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children, limbs
from treestroke.core.types import CONIFEROUS, Floats, FoliageKind, Indices, TreeForm

Order = Literal["any", "stem", "limb"]
"""Which branches a subtree may replace."""

MOST_SUBTREES = 8
"""Greatest size of a library (Tan et al. 2008, section 3.1)."""
MOST_SHOOTS = 8
"""Greatest number of shoots of a visible subtree."""
LONGEST_SHOOT = 0.85
"""Length of a visible subtree's longest shoot relative to its support: with longer ones each generation would be
longer than the one before."""
ENOUGH_VISIBLE = 3
"""Number of visible subtrees from which on ``auto`` uses them."""
Row = tuple[int, float, float, float, float]
"""A shoot: parent, fraction, angle from the support and azimuth, degrees, and length relative to the support."""


@dataclass(frozen=True, eq=False)
class Subtree:
    """Shoots on a support that runs from (0, 0, 0) to (0, 1, 0).

    Attributes
    ----------
    parents
        (k,) index of each shoot's parent, smaller than its own; -1 for the support.
    fractions
        (k,) where on its parent each shoot begins, 0 at the base, 1 at the tip.
    vectors
        (k, 3) from each shoot's base to its tip, in lengths of the support.
    replaces
        Which branches it may replace: stems, limbs or any.

    Raises
    ------
    ValueError
        A shape, parent or fraction is wrong, or there are none or over 16 shoots.
    """

    parents: Indices
    fractions: Floats
    vectors: Floats
    replaces: Order = "any"

    def __post_init__(self) -> None:
        k = len(self.parents)
        if not 0 < k <= 16 or self.fractions.shape != (k,) or self.vectors.shape != (k, 3):
            raise ValueError(f"a subtree needs 1 to 16 shoots with parents, fractions and vectors, got {k}")
        if (self.parents >= np.arange(k)).any() or (self.fractions < 0).any() or (self.fractions > 1).any():
            raise ValueError("a shoot's parent comes before it, its fraction lies in 0 to 1")

    @property
    def longest(self) -> float:
        """Length of the longest shoot on the support, in lengths of the support."""
        return float(np.sqrt((self.vectors[self.parents < 0] ** 2).sum(axis=1)).max())


def _subtree(rows: tuple[Row, ...], replaces: Order = "any") -> Subtree:
    """Build a subtree from its shoots."""
    parent, fraction, lean, azimuth, length = (np.array(column) for column in zip(*rows, strict=True))
    lean, azimuth = np.radians(lean), np.radians(azimuth)
    directions = np.array([np.sin(lean) * np.cos(azimuth), np.cos(lean), np.sin(lean) * np.sin(azimuth)])
    return Subtree(parent.astype(np.int64), fraction.astype(np.float64), (directions * length).T.copy(), replaces)


# Every subtree goes on where its support ends, nearly straight, and its other shoots are about 0.65 of the path that is
# left of their parent beyond them: limbs are axes with shorter ones at their sides. No two shoots mirror each other:
# symmetric forks would tie between angles.
# New branches at the end of the support.
TYPE_1 = (
    _subtree(((-1, 1.0, 14, 8, 0.8), (-1, 0.97, 42, 171, 0.58), (0, 0.45, 42, 96, 0.44), (1, 0.55, 40, 301, 0.34))),
    _subtree(
        (
            (-1, 1.0, 19, 15, 0.76),
            (-1, 0.93, 43, 150, 0.6),
            (-1, 0.86, 47, 266, 0.64),
            (0, 0.55, 40, 203, 0.34),
            (1, 0.5, 42, 41, 0.3),
        )
    ),
    _subtree(((-1, 1.0, 11, 77, 0.8), (-1, 0.93, 38, 238, 0.61), (-1, 0.86, 48, 5, 0.66), (0, 0.5, 39, 322, 0.4))),
)

# New branches along the support, in spirals and loose pairs.
TYPE_2 = (
    _subtree(
        (
            (-1, 0.27, 53, 4, 0.91),
            (-1, 0.42, 50, 143, 0.78),
            (-1, 0.58, 47, 281, 0.72),
            (-1, 0.71, 44, 61, 0.58),
            (-1, 0.86, 40, 196, 0.51),
            (-1, 1.0, 13, 334, 0.65),
        )
    ),
    _subtree(
        (
            (-1, 0.35, 51, 20, 0.84),
            (-1, 0.55, 47, 218, 0.74),
            (-1, 0.76, 43, 112, 0.56),
            (-1, 1.0, 16, 299, 0.65),
            (0, 0.55, 40, 150, 0.36),
            (1, 0.6, 38, 12, 0.3),
        )
    ),
    _subtree(
        (
            (-1, 0.31, 59, 11, 0.87),
            (-1, 0.36, 55, 184, 0.8),
            (-1, 0.62, 51, 98, 0.68),
            (-1, 0.67, 49, 274, 0.61),
            (-1, 0.93, 40, 33, 0.44),
            (-1, 1.0, 12, 217, 0.65),
        )
    ),
)

# Conifers: whorls about the stem, a flat spray along the limbs.
WHORLS = (
    _subtree(
        (
            (-1, 0.93, 77, 3, 1.0),
            (-1, 0.99, 74, 77, 0.94),
            (-1, 0.95, 80, 142, 0.98),
            (-1, 0.98, 73, 221, 0.91),
            (-1, 0.91, 78, 290, 0.96),
        ),
        "stem",
    ),
    _subtree(
        (
            (-1, 0.42, 79, 21, 0.97),
            (-1, 0.55, 76, 163, 1.0),
            (-1, 0.51, 81, 248, 0.92),
            (-1, 0.92, 75, 81, 0.95),
            (-1, 0.97, 73, 204, 0.9),
            (-1, 0.99, 77, 318, 0.93),
        ),
        "stem",
    ),
)
SPRAYS = (
    _subtree(
        (
            (-1, 0.24, 57, 4, 0.5),
            (-1, 0.33, 54, 187, 0.52),
            (-1, 0.5, 51, 351, 0.45),
            (-1, 0.59, 52, 172, 0.4),
            (-1, 0.74, 47, 9, 0.33),
            (-1, 0.82, 45, 183, 0.28),
            (-1, 0.96, 33, 348, 0.24),
        ),
        "limb",
    ),
)


def visible_subtrees(skeleton: Skeleton) -> tuple[Subtree, ...]:
    """Make a subtree of each visible limb with at least two child limbs (3D, metres), the one with most children first.

    A limb's support is its chord; its shoots are the chords of its child limbs. All are scaled so that the longest
    shoot has 0.85 of the support. Source: Tan et al. 2008, section 3.1, where subtrees keep their size.
    """
    successors = heaviest_children(skeleton, accumulate_to_root(skeleton, edge_lengths(skeleton)))
    chains = [chain for chain in limbs(skeleton, successors) if len(chain) > 1]
    limb_of = {joint: i for i, chain in enumerate(chains) for joint in chain[1:].tolist()}
    children: list[list[Indices]] = [[] for _ in chains]
    for chain in chains:
        if (parent := limb_of.get(int(chain[0]))) is not None:
            children[parent].append(chain)
    found = []
    for chain, forks in zip(chains, children, strict=True):
        subtree = _subtree_of(skeleton, chain, forks[:MOST_SHOOTS]) if len(forks) >= 2 else None
        if subtree is not None:
            found.append(subtree)
    return tuple(sorted(found, key=lambda subtree: -len(subtree.parents)))


def _subtree_of(skeleton: Skeleton, chain: Indices, children: list[Indices]) -> Subtree | None:
    """Transform a limb and its child limbs to the unit support; None where a chord has no length."""
    start, chord = skeleton.points[chain[0]], skeleton.points[chain[-1]] - skeleton.points[chain[0]]
    length = float(np.sqrt((chord**2).sum()))
    vectors = np.array([skeleton.points[other[-1]] - skeleton.points[other[0]] for other in children])
    if length <= 0 or not (np.abs(vectors).max(axis=1) > 0).all():
        return None
    up = chord / length
    side = np.cross(up, [0.0, 0.0, 1.0] if abs(up[2]) <= 0.9 else [1.0, 0.0, 0.0])
    side /= np.sqrt((side**2).sum())
    frame = np.array([side, up, np.cross(side, up)])
    local = vectors @ frame.T
    local *= LONGEST_SHOOT / np.sqrt((local**2).sum(axis=1)).max()
    fractions = [float((skeleton.points[other[0]] - start) @ up) / length for other in children]
    return Subtree(np.full(len(children), -1), np.clip(fractions, 0.05, 1.0), local)


def choose_library(name: str, kind: FoliageKind, skeleton: Skeleton, form: TreeForm = "round") -> tuple[Subtree, ...]:
    """Choose at most 8 subtrees by the setting's name, the kind of foliage, the visible tree (3D, metres) and the form.

    ``auto`` takes two visible subtrees beside the predefined ones if at least three are visible, else none;
    ``visible`` falls back to the predefined ones where nothing visible forks. A conifer gets whorls and sprays and both
    types beside them: with whorls and sprays alone its crown stays half empty. Source: Tan et al. 2008, section 3.1.

    Raises
    ------
    ValueError
        The name is unknown.
    """
    predefined = {"type1": TYPE_1, "type2": TYPE_2, "both": TYPE_1 + TYPE_2}
    visible = visible_subtrees(skeleton) if name in ("auto", "visible") else ()
    if name in predefined:
        return predefined[name]
    if name == "visible":
        return visible[:MOST_SUBTREES] or predefined["both"]
    if name != "auto":
        raise ValueError(f"the library is auto, visible, type1, type2 or both, not {name!r}")
    if kind in CONIFEROUS or form == "spire":
        return WHORLS + SPRAYS + TYPE_1[:2] + TYPE_2
    return ((visible[:2] if len(visible) >= ENOUGH_VISIBLE else ()) + predefined["both"])[:MOST_SUBTREES]
