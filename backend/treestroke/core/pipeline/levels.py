"""Levels of detail: the same grown tree for where it is seen smaller."""

from dataclasses import dataclass, replace

import numpy as np

from treestroke.core.geometry.mesh import Surface
from treestroke.core.geometry.silhouette import Framing, framing, silhouettes
from treestroke.core.leaf.cards import cards
from treestroke.core.leaf.thinning import Coverage, thin_leaves
from treestroke.core.mesh.impostor import impostor
from treestroke.core.mesh.lod_tubes import LEAST_TRIANGLES, LodParams, lod_tubes
from treestroke.core.mesh.seen_light import shaded_like
from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.progress import Report, silent
from treestroke.core.types import Floats, Mask

HEIGHTS_PX = (400, 150, 64)
"""Heights of the tree on the screen, px, for which the first level, the second level and the impostor are made."""
_SHARES = (0.30, 0.08)
"""Shares of the whole tree's triangles in the first and second level."""
_BARE_MORE = 1.04
"""Factor on the triangles of a leafless tree's bark, as it has no leaves."""
_LEAST_WOOD, _MOST_WOOD = 0.12, 0.9
"""Share of a level's triangles that is bark: where foliage hides all wood, and where wood stands alone (5 photos)."""
_HIDDEN_BY_WOOD = 0.1
"""Value of covering by leaves what wood covers already."""


@dataclass(frozen=True, eq=False)
class Level:
    """A tree of fewer triangles, with the whole tree's textures (the same arrays)."""

    bark: Surface
    leaf: Surface | None

    @property
    def surfaces(self) -> tuple[Surface, ...]:
        """Bark and, where there are, leaves."""
        return (self.bark,) if self.leaf is None else (self.bark, self.leaf)


@dataclass(frozen=True, eq=False)
class Levels:
    """A tree in less and less detail, for greater and greater distances.

    Attributes
    ----------
    lod1, lod2
        Bark and leaves of 30 % and 8 % of the triangles; their vertices are attached to the whole tree's skeleton.
    impostor
        Pictures of the tree on crossed planes, to be seen from the front of each triangle only; it stands still.
    """

    lod1: Level
    lod2: Level
    impostor: Surface


def levels(tree: TreeModel, report: Report = silent) -> Levels:
    """Make the levels of detail of a finished tree.

    Deterministic. ``report("levels", fraction)`` is called as they are done.
    """
    whole = Level(tree.bark, tree.leaf)
    view = framing(whole.surfaces, HEIGHTS_PX[1])
    expected = silhouettes(whole.surfaces, view)
    report("levels", 0.2)
    wood = _wood_share(tree, view, expected)
    lod1 = _level(tree, 0, wood, view, expected)
    report("levels", 0.4)
    lod2 = _level(tree, 1, wood, view, expected)
    report("levels", 0.5)
    baked = impostor(lod1.surfaces)
    report("levels", 1.0)
    return Levels(lod1, lod2, baked)


def _wood_share(tree: TreeModel, view: Framing, expected: Mask) -> float:
    """Choose the share of triangles that is bark: more where more of the silhouettes is wood alone."""
    if tree.leaf is None:
        return 1.0
    alone = float((expected & ~silhouettes((tree.leaf,), view)).sum()) / max(int(expected.sum()), 1)
    return float(np.clip(_LEAST_WOOD + alone, _LEAST_WOOD, _MOST_WOOD))


def _level(tree: TreeModel, number: int, wood: float, view: Framing, expected: Mask) -> Level:
    """Make the first (0) or second (1) level."""
    cards_before = 0 if tree.cards is None else len(tree.cards)
    whole = len(tree.bark.mesh.triangles) + 2 * cards_before
    aim = _SHARES[number] * whole * (_BARE_MORE if tree.leaf is None else 1.0)
    most = int(max(wood * aim, aim - 2 * cards_before, LEAST_TRIANGLES))
    params = LodParams(most, HEIGHTS_PX[number], root_swelling=tree.grown.root_swelling)
    bark = replace(tree.bark, mesh=shaded_like(lod_tubes(tree.grown.skeleton, params), tree.bark.mesh))
    left = max(0, int(aim - len(bark.mesh.triangles)) // 2)
    return Level(
        bark, _thinned(tree, left, view, np.where(silhouettes((bark,), view), _HIDDEN_BY_WOOD, 1.0) * expected)
    )


def _thinned(tree: TreeModel, count: int, view: Framing, values: Floats) -> Surface | None:
    """Keep ``count`` cards; one at least where there are any."""
    if tree.leaf is None or tree.cards is None or tree.atlas is None:
        return None
    kept = thin_leaves(tree.cards, tree.atlas, max(1, count), Coverage(view, values))
    return replace(tree.leaf, mesh=cards(kept, tree.atlas))
