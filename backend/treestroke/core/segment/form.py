"""The form of a tree: how its limbs grow, judged by its crown's outline and by its stems."""

from collections.abc import Sequence

import numpy as np

from treestroke.core.segment.cues import Cues
from treestroke.core.types import CONIFEROUS, Floats, FoliageKind, TreeForm

FOOT_SHARE = 0.12
"""A branch that begins within this share of the tree's height above the ground is a stem by itself."""
WEEPING = -0.25
"""Cue ``level`` below which most fine lines hang straight down."""
APART_SHARE = 0.02
"""Stems stand at least this share of the tree's height apart."""


def crown_form(cues: Cues, kind: FoliageKind, branches_px: Sequence[Floats], height_px: float) -> TreeForm:
    """Return the form of a tree where the picture is clear about it, else ``round``.

    The rules are ours, judged by eye on 330 trees.

    Parameters
    ----------
    cues
        Those of `crown_cues`.
    kind
        What the twigs bear.
    branches_px
        The branch strokes (n, 2), px, from the foot up; the trunk's comes first.
    height_px
        The tree's height, px.
    """
    if kind == "palm":
        return "round"
    if _stems(branches_px, height_px) > 1:
        return "multi_stem"
    slimness, needled = float(np.exp(cues["aspect"])), kind in CONIFEROUS
    if _tapering(cues, slimness, needled):
        return "spire"
    if not needled and cues["widest"] < 0.42 and cues["foot"] < 0.4 and cues["shoulder"] > 0.65:
        return "vase"
    if slimness > 2.0:
        return "columnar"
    if slimness < 0.6 and cues["shoulder"] > 0.43 and cues["foot"] < 0.5 and kind != "bare":
        return "umbrella"
    if kind == "leaves" and cues["level"] < WEEPING and cues["widest"] > 0.55:
        return "weeping"
    return "round"


def _tapering(cues: Cues, slimness: float, needled: bool) -> bool:
    """Tell whether a crown tapers from low down to its top; a conifer's may be wider, and blunter if it is slim."""
    if needled:
        return cues["taper"] < min(0.6, slimness - 0.6) and cues["widest"] > 0.5
    return slimness > 1.4 and cues["taper"] < 0.45 and cues["widest"] > 0.7


def _stems(branches_px: Sequence[Floats], height_px: float) -> int:
    """Count the strokes that begin at the ground, each away from the others."""
    ground = branches_px[0][0, 1]
    columns: list[float] = []
    for branch in branches_px:
        x, y = branch[0]
        apart = all(abs(x - other) > APART_SHARE * height_px for other in columns)
        if apart and y > ground - FOOT_SHARE * height_px:
            columns.append(float(x))
    return len(columns)
