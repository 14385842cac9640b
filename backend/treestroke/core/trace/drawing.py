"""From a sketch to its 2D skeleton and crown."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.errors import StrokesError
from treestroke.core.imaging.outline import filled_and_crossing
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.skeleton.branched import Branched
from treestroke.core.stroke_rules import CROSSING, check_crown, clamped
from treestroke.core.strokes import Sketch, Stroke, StrokeWarning
from treestroke.core.trace.branch_lines import join_lines
from treestroke.core.trace.crown_hull import estimate_crown
from treestroke.core.trace.ink_lines import follow_ink
from treestroke.core.trace.stroke_lines import link_strokes
from treestroke.core.types import Floats

CHECKED_SIDE = 750
"""Long side, px, of the raster in which a crown is checked, which must be fast while the user draws."""


@dataclass(frozen=True, eq=False)
class Drawing:
    """What a sketch shows.

    Attributes
    ----------
    tree
        The 2D skeleton, canvas px (x right, y down), joints at most `branch_lines.STEP` of its height apart; radii are
        those of the brush, 0 where there was none.
    crown
        (k, 2) closed outline of the foliage, px: as drawn, else the dilated hull of the strokes.
    crown_drawn
        Whether the crown was drawn.
    size
        Width and height of the canvas, px.
    warnings
        One for each repair.
    """

    tree: Branched
    crown: Floats
    crown_drawn: bool
    size: tuple[int, int]
    warnings: tuple[StrokeWarning, ...]


def trace_sketch(sketch: Sketch) -> Drawing:
    """Turn a sketch into one connected 2D tree that every stroke lies along.

    Source: two-sketches paper, section 4; `stroke_lines` and `ink_lines` say where ours differs.

    Raises
    ------
    StrokesError
        There is no trunk, a stroke or the crown is unusable, or the strokes do not form a tree. The message names the
        stroke.
    """
    if sketch.ink is None:
        lines, height, warnings = link_strokes(sketch.branches, sketch.canvas)
    else:
        lines, height, warnings = follow_ink(sketch.ink)
    tree = join_lines(lines, height)
    if sketch.crown is None:
        return Drawing(tree, estimate_crown(tree, height, sketch.canvas), False, sketch.canvas, warnings)
    crown, crossing = _drawn_crown(sketch.crown, tree, sketch.canvas)
    return Drawing(tree, crown, True, sketch.canvas, (*crossing, *warnings))


def _drawn_crown(crown: Stroke, tree: Branched, canvas: tuple[int, int]) -> tuple[Floats, tuple[StrokeWarning, ...]]:
    """Clamp the drawn crown to the canvas; refuse one that is too small or that no branch reaches into."""
    width, height = canvas
    outline = clamped(crown, ("crown",), (width, height), 3, "canvas").points
    coarse = min(1.0, CHECKED_SIDE / max(canvas))
    size = max(1, round(height * coarse)), max(1, round(width * coarse))
    filled, crossing = filled_and_crossing(outline * coarse, *size)
    check_crown(filled, "canvas")
    if not sample_nearest(filled, tree.skeleton.points * coarse, False).any():
        problem = "no branch reaches into it; draw it around the foliage of the tree that is drawn"
        raise StrokesError.at(("crown",), problem, "crown_apart")
    return np.array(outline), (CROSSING,) if crossing else ()
