import cv2
import numpy as np
import pytest
from tests.sketches import ARMS, SIZE, TRUNK, sketch

from treestroke.core.errors import StrokesError
from treestroke.core.trace.drawing import trace_sketch

CROWN = [[100, 100], [800, 100], [800, 700], [100, 700]]


def test_a_drawn_crown_is_kept() -> None:
    drawing = trace_sketch(sketch(TRUNK, *ARMS, crown=CROWN))
    assert drawing.crown.tolist() == CROWN


def test_without_a_drawn_crown_it_surrounds_all_but_the_bare_trunk() -> None:
    drawing = trace_sketch(sketch(TRUNK, *ARMS))
    crown = drawing.crown.astype(np.float32)
    for x, y in [TRUNK[-1], *(arm[-1] for arm in ARMS)]:
        assert cv2.pointPolygonTest(crown, (x, y), True) > 30
    assert cv2.pointPolygonTest(crown, (450, 1000), False) < 0
    assert (drawing.crown >= 0).all()
    assert (drawing.crown <= SIZE).all()


def test_a_crown_that_crosses_itself_is_kept_with_a_warning() -> None:
    drawing = trace_sketch(sketch(TRUNK, crown=[[100, 100], [800, 700], [800, 100], [100, 700]]))
    assert [one.code for one in drawing.warnings] == ["crown_crosses_itself"]


@pytest.mark.parametrize(
    ("crown", "message", "code"),
    [
        ([[10, 10], [90, 90], [10, 10]], "^crown: it has 2 distinct points", "stroke_too_short"),
        ([[10, 10], [20, 10], [20, 20]], r"^crown: it encloses 0\.0.% of the canvas", "crown_too_small"),
        ([[10, 10], [200, 10], [200, 200], [10, 200]], "^crown: no branch reaches into it", "crown_apart"),
    ],
)
def test_an_unusable_crown_is_refused(crown: object, message: str, code: str) -> None:
    with pytest.raises(StrokesError, match=message) as refused:
        trace_sketch(sketch(TRUNK, *ARMS, crown=crown))
    assert (refused.value.code, refused.value.pointer) == (code, "/crown")
