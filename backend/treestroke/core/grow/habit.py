"""Habits: how the limbs of each form of tree grow where the photo shows none.

Weber and Penn 1995 describe a tree's form by its branches' angles and their vertical attraction; so do we, but the
branches are still chosen by what fills the crown (`replacement`).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from treestroke.core.types import Floats, FoliageKind, Indices, TreeForm

STEERED = 3
"""Generations of branches that a form steers; finer shoots fill what these leave empty."""


class Rise(NamedTuple):
    """How steep shoots are: the share of their own rise that is kept, and the rise that is added.

    What is added is relative to a shoot's length, which stays: (1, 0, 0) leaves shoots as they are, a great positive
    number makes them stand, a great negative one makes them hang. It runs from ``low``, where the stem enters the
    crown, to ``high``, at the crown's top.
    """

    kept: float = 1.0
    low: float = 0.0
    high: float = 0.0


AS_GROWN = Rise()
"""Shoots stay as they are."""


@dataclass(frozen=True)
class Habit:
    """How the unseen limbs of a tree grow.

    Attributes
    ----------
    limbs, outer
        How steep the limbs are that leave a stem, and all branches that leave a limb.
    leave
        Heights in the crown, 0 where the stem enters it to 1 at its top, between which limbs leave a stem.
    stretch
        How far limbs from a stem reach at least, as a share of the crown's height above their start.
    sag, turn_up
        Weights of sagging where a shoot starts, and of turning up at its tip; negative ones arch it and let it hang.
    """

    limbs: Rise = AS_GROWN
    outer: Rise = AS_GROWN
    leave: tuple[float, float] = (-math.inf, math.inf)
    stretch: float = 0.0
    sag: float = 0.22
    turn_up: float = 0.38

    def steering(self, generations: Indices, heights: Floats) -> Floats:
        """Return the steering (k, 2) of `placements.Evaluator` for branches: generations, 1 on a stem, and heights."""
        which = np.where(generations > STEERED, 2, np.where(generations == 1, 0, 1))
        kept, low, high = np.array([self.limbs, self.outer, AS_GROWN])[which].T
        added = low + (high - low) * np.minimum(np.maximum(heights, 0.0), 1.0)
        return np.stack([kept, added], axis=1)


UNSTEERED = Habit()
"""Limbs grow wherever they fill the crown."""
HABITS: Mapping[TreeForm, Habit] = MappingProxyType(
    {
        "round": UNSTEERED,
        "spire": Habit(Rise(0.3, -0.3, 0.25), Rise(0.2, -0.12, 0.05), sag=0.1, turn_up=0.15),
        "columnar": Habit(Rise(0.6, 1.3, 1.3), Rise(0.8, 0.4, 0.4), stretch=0.4),
        "umbrella": Habit(Rise(0.5, 1.0, 0.5), Rise(0.15, 0.1, 0.1), (-math.inf, 0.5), 0.8, sag=-0.2, turn_up=0.0),
        "weeping": Habit(Rise(0.6, 0.5, 0.5), Rise(0.3, -1.6, -1.6), sag=-0.5, turn_up=-0.9),
        "vase": Habit(Rise(0.5, 1.1, 0.9), Rise(0.8, 0.2, 0.0), (-math.inf, 0.35), 0.9, sag=-0.35, turn_up=-0.3),
        "multi_stem": Habit(Rise(0.5, 1.8, 1.3), Rise(0.8, 0.25, 0.2), (-math.inf, 0.3), 1.0, sag=0.1, turn_up=0.5),
    }
)
"""Judged on renders from four sides of an oak, an aspen and a pine."""

UPRIGHT_SPIRE = Habit(Rise(0.5, 0.2, 1.2), Rise(0.7, 0.35, 0.45), sag=0.1)
"""A spire of scales (cypress, thuja): upright plumes without tiers (judged on two cypresses)."""


def habit_of(form: TreeForm, kind: FoliageKind) -> Habit:
    """Return the habit of a form, which for a spire depends on what its twigs bear."""
    return UPRIGHT_SPIRE if form == "spire" and kind == "scales" else HABITS[form]
