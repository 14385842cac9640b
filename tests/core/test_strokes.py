from dataclasses import replace

import numpy as np
import pytest

from treestroke.core.strokes import Length, Stroke, Strokes, same_strokes

LINE = Stroke(np.array([[1.0, 2.0], [3.0, 4.0]]))
DRAWN = Strokes(LINE, (LINE, Stroke(LINE.points + 5, 3.0)), (LINE,))
MOVED = Stroke(LINE.points + 1e-9)


def copied(stroke: Stroke) -> Stroke:
    return replace(stroke, points=stroke.points.copy())


def test_copies_are_the_same() -> None:
    branches, erase = tuple(map(copied, DRAWN.branches)), tuple(map(copied, DRAWN.erase))
    assert same_strokes(DRAWN, Strokes(copied(DRAWN.crown), branches, erase))


def test_a_known_length_is_compared_by_its_ends_and_its_metres() -> None:
    lengths = [Length(LINE.points.copy(), 2.0), Length(LINE.points, 2.5), Length(MOVED.points, 2.0)]
    measured = replace(DRAWN, scale=Length(LINE.points, 2.0))
    assert [same_strokes(measured, replace(DRAWN, scale=one)) for one in lengths] == [True, False, False]


@pytest.mark.parametrize(
    "other",
    [
        replace(DRAWN, crown=MOVED),
        replace(DRAWN, branches=(MOVED, DRAWN.branches[1])),
        replace(DRAWN, branches=(LINE, replace(DRAWN.branches[1], width=None))),
        replace(DRAWN, branches=(LINE,)),
        replace(DRAWN, erase=()),
        replace(DRAWN, branches=(*DRAWN.branches, LINE), erase=()),
        replace(DRAWN, scale=Length(LINE.points, 2.0)),
    ],
    ids=["crown", "points", "width", "fewer", "erase", "moved over", "scale"],
)
def test_any_other_stroke_is_noticed(other: Strokes) -> None:
    assert not same_strokes(DRAWN, other)
