from dataclasses import replace

import numpy as np
import pytest

from treestroke.core.strokes import Stroke, Strokes, same_strokes

LINE = Stroke(np.array([[1.0, 2.0], [3.0, 4.0]]))
DRAWN = Strokes(LINE, (LINE, Stroke(LINE.points + 5, 3.0)), (LINE,))
MOVED = Stroke(LINE.points + 1e-9)


def copied(stroke: Stroke) -> Stroke:
    return replace(stroke, points=stroke.points.copy())


def test_copies_are_the_same() -> None:
    branches, erase = tuple(map(copied, DRAWN.branches)), tuple(map(copied, DRAWN.erase))
    assert same_strokes(DRAWN, Strokes(copied(DRAWN.crown), branches, erase))


@pytest.mark.parametrize(
    "other",
    [
        replace(DRAWN, crown=MOVED),
        replace(DRAWN, branches=(MOVED, DRAWN.branches[1])),
        replace(DRAWN, branches=(LINE, replace(DRAWN.branches[1], width=None))),
        replace(DRAWN, branches=(LINE,)),
        replace(DRAWN, erase=()),
        replace(DRAWN, branches=(*DRAWN.branches, LINE), erase=()),
    ],
    ids=["crown", "points", "width", "fewer", "erase", "moved over"],
)
def test_any_other_stroke_is_noticed(other: Strokes) -> None:
    assert not same_strokes(DRAWN, other)
