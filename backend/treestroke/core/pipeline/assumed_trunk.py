"""Where a tree's trunk stands, if only its outline was drawn."""

from dataclasses import replace

import numpy as np

from treestroke.core.strokes import Stroke, Strokes, StrokeWarning
from treestroke.core.types import Floats, Picture

_FOOT = 0.08  # of the outline's height, from its lowest point, in which a trunk that was drawn around stands alone
_SLIM = 0.3  # of the outline's width, up to which that is a trunk
_BARE = 0.18  # of the crown's height, that a trunk stands out below a crown that was drawn without it
_UP = 0.6  # of the outline's height, up to which the trunk is drawn


def with_trunk(photo: Picture, strokes: Strokes) -> tuple[Strokes, tuple[StrokeWarning, ...]]:
    """Return strokes with a trunk's stroke, assumed where there is none; and a warning that says so.

    An outline (px of the photo) that ends in something slim goes around the trunk, too; below any other the trunk is
    taken to stand under the middle of the crown.
    """
    if strokes.branches:
        return strokes, ()
    outline = strokes.crown.points
    top, bottom = float(outline[:, 1].min()), float(outline[:, 1].max())
    height = bottom - top
    left, right = _width_at(outline, bottom - _FOOT * height)
    foot = np.array([(left + right) / 2.0, bottom])
    if right - left > _SLIM * float(np.ptp(outline[:, 0])):
        foot = np.array([_middle(outline), min(bottom + _BARE * height, photo.shape[0] - 1.0)])
    head = np.array([_middle(outline), bottom - _UP * height])
    trunk = Stroke(np.linspace(foot, head, 5))
    detail = (
        "no trunk was drawn; it was assumed under the crown's middle; draw a stroke up the trunk if it is elsewhere"
    )
    return replace(strokes, branches=(trunk,)), (StrokeWarning("trunk_assumed", "branches", detail),)


def _width_at(outline: Floats, row: float) -> tuple[float, float]:
    """Return the outermost places of a closed outline (n, 2) at a row, px."""
    ends = np.roll(outline, -1, axis=0)
    crossing = (outline[:, 1] - row) * (ends[:, 1] - row) < 0
    start, end = outline[crossing], ends[crossing]
    if not len(start):
        return float(outline[:, 0].min()), float(outline[:, 0].max())
    share = (row - start[:, 1]) / (end[:, 1] - start[:, 1])
    across = start[:, 0] + share * (end[:, 0] - start[:, 0])
    return float(across.min()), float(across.max())


def _middle(outline: Floats) -> float:
    """Return the column of the centre of the area within an outline (n, 2), px."""
    ends = np.roll(outline, -1, axis=0)
    cross = outline[:, 0] * ends[:, 1] - ends[:, 0] * outline[:, 1]
    area = cross.sum()
    if abs(area) < 1e-9:
        return float(outline[:, 0].mean())
    return float(((outline[:, 0] + ends[:, 0]) * cross).sum() / (3.0 * area))
