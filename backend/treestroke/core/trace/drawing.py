"""The 2D skeleton of a sketch."""

from dataclasses import dataclass

from treestroke.core.geometry.polyline import Floats
from treestroke.core.skeleton.branched import Branched
from treestroke.core.strokes import StrokeWarning


@dataclass(frozen=True, eq=False)
class Drawing:
    """What a sketch shows.

    Attributes
    ----------
    tree
        The 2D skeleton, canvas px (x right, y down), joints at most ``STEP`` of its height apart; radii are those of
        the brush, 0 where there was none.
    crown
        (k, 2) closed outline of the foliage, px: as drawn, else the dilated hull of the strokes.
    crown_drawn
        Whether it was drawn.
    size
        Width and height of the canvas, px.
    warnings
        What was mended.
    """

    tree: Branched
    crown: Floats
    crown_drawn: bool
    size: tuple[int, int]
    warnings: tuple[StrokeWarning, ...]
