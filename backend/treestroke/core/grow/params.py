"""Parameters of growth, and their values for each kind of foliage."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from treestroke.core.grow.habit import UNSTEERED, Habit, habit_of
from treestroke.core.types import CONIFEROUS, FoliageKind, TreeForm


@dataclass(frozen=True)
class GrowthParams:
    """How to grow; px are those of a crown 1,000 px wide.

    Source: Tan et al. 2008, section 3, which gives about 100 iterations and 12 angles and no other figure.

    Attributes
    ----------
    iterations
        Number of branches that are replaced.
    attractors
        Approximate number of image attractors.
    candidates
        Number of branches compared in an iteration.
    angles
        Number of turns of each subtree about its branch.
    mode
        Attractors in use: those of the image (E2D), those in space (E3D), or both in alternation.
    spacing_px
        Distance between the samples of a branch.
    closeness_px
        Least distance of a shoot's outer half from the rest of the tree.
    keep_share
        A shoot clipped at the crown's edge to less than this share of its length is dropped.
    inward_cosine
        Least cosine between a shoot and the direction from the crown's foot to the shoot's middle. At
        0.3 limbs and twigs point as those of 9 trees known in 3D do; beyond it more of the foliage stays bare.
    stem_piece, limb_piece
        Greatest length of a piece of a visible stem or limb that is one branch, as a share of the crown's height: with
        longer ones fewer limbs leave a stem, and these are longer.
    leader
        Share of the crown's height to which the first stem is extended where no visible limb reaches it.
    tip_px
        Radius of the thinnest twigs. At 0.4 the pipes of 9 trees add up to the trunk's radius with an exponent of 2.16
        in the median (1.9 to 2.3), as they do where the trees are known in 3D (2.2; 1.8 to 2.4).
    twigs
        Greatest number of twigs added to the grown branches.
    habit
        How the tree's form steers its limbs.
    """

    iterations: int = 300
    attractors: int = 2000
    candidates: int = 20
    angles: int = 12
    mode: Literal["alternating", "image", "space"] = "alternating"
    spacing_px: float = 6.0
    closeness_px: float = 10.0
    keep_share: float = 0.5
    inward_cosine: float = 0.3
    stem_piece: float = 0.3
    limb_piece: float = 0.2
    leader: float = 0.65
    tip_px: float = 0.4
    twigs: int = 0
    habit: Habit = UNSTEERED

    def __post_init__(self) -> None:
        if min(self.iterations, self.twigs) < 0 or min(self.attractors, self.candidates, self.angles) < 1:
            raise ValueError(f"growth needs counts >= 0, attractors, candidates and angles >= 1, got {self}")
        if self.mode not in ("alternating", "image", "space"):
            raise ValueError(f"the mode is alternating, image or space, not {self.mode!r}")
        if min(self.spacing_px, self.closeness_px, self.tip_px, self.stem_piece, self.limb_piece) <= 0:
            raise ValueError(f"spacing, closeness, tip and pieces must be positive, got {self}")
        if not (0 < self.keep_share <= 1 and -1 <= self.inward_cosine <= 1 and 0 <= self.leader <= 1):
            raise ValueError(f"keep share, inward cosine or leader is out of range in {self}")


_OF_FORM: Mapping[TreeForm, Mapping[str, Any]] = {
    "spire": {"stem_piece": 0.07, "leader": 0.98, "inward_cosine": -0.35},
    "columnar": {"stem_piece": 0.12, "leader": 0.9, "inward_cosine": 0.6},
    "umbrella": {"leader": 0.3, "inward_cosine": -0.2},
    "weeping": {"inward_cosine": -1.0},
    "vase": {"stem_piece": 0.08, "leader": 0.3},
    "multi_stem": {"stem_piece": 0.08, "leader": 0.3},
}
"""Parameters of growth that a form changes."""


def growth_for(kind: FoliageKind, iterations: int = 300, form: TreeForm = "round") -> GrowthParams:
    """Return the parameters for a kind of foliage and a form.

    Conifers and spires have one leader and many whorls, bare trees finer twigs; limbs that hang, or leave a stem low
    down to fill the whole crown, may grow inward.
    """
    params = replace(_growth_of_kind(kind, iterations), habit=habit_of(form, kind))
    return replace(params, **_OF_FORM.get(form, {}))


def _growth_of_kind(kind: FoliageKind, iterations: int) -> GrowthParams:
    """Return the parameters for a kind of foliage on a tree of no particular form."""
    if kind in CONIFEROUS:
        return GrowthParams(iterations, stem_piece=0.07, leader=0.98, inward_cosine=-0.35)
    if kind == "bare":
        return GrowthParams(iterations, tip_px=0.2, twigs=6000)
    return GrowthParams(iterations)
