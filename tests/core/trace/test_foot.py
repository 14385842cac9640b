import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from treestroke.core.strokes import Sketch
from treestroke.core.trace.drawing import Drawing, draw_up
from treestroke.core.trace.foot import stood

SIZE = 400
GROUND = 380


def inked(*outlines: list[tuple[int, int]]) -> NDArray[np.bool_]:
    picture = np.zeros((SIZE, SIZE), np.uint8)
    for outline in outlines:
        cv2.fillPoly(picture, [np.array(outline, dtype=np.int32)], 255)
    return picture > 0


def traced(ink: NDArray[np.bool_]) -> Drawing:
    return draw_up(Sketch((SIZE, SIZE), None, (), ink))


def straight(top: tuple[float, float], root: tuple[float, float], radius: float) -> tuple[np.ndarray, np.ndarray]:
    line = np.linspace(root, top, 300)
    return line, np.full(len(line), radius)


def test_a_wide_foot_is_stood_on_in_its_middle_and_as_wide_as_it_is() -> None:
    trunk = [(185, 20), (215, 20), (215, 330), (255, GROUND), (165, GROUND), (185, 340)]
    tree = traced(inked(trunk)).tree.skeleton
    assert tree.points[0] == pytest.approx([210.5, GROUND + 1], abs=2)
    assert tree.radii[0] == pytest.approx(45.5, abs=2)
    assert tree.radii[np.abs(tree.points[:, 1] - 200).argmin()] == pytest.approx(15.5, abs=1.5)


def test_a_round_end_is_no_narrower_foot() -> None:
    picture = np.zeros((SIZE, SIZE), np.uint8)
    cv2.line(picture, (200, 30), (200, 350), 255, 40)
    tree = traced(picture > 0).tree.skeleton
    assert tree.points[0] == pytest.approx([200.5, 371], abs=2)
    assert tree.radii[0] == pytest.approx(20, abs=1.5)


def test_a_drawn_ground_is_no_foot() -> None:
    trunk, ground = [(190, 20), (210, 20), (210, GROUND), (190, GROUND)], [(20, 350), (380, 350), (380, 365), (20, 365)]
    ink = inked(trunk, ground)
    line, radii = straight((200.0, 20.0), (200.0, GROUND), 10.5)
    points, wide = stood(line, radii, ink)
    assert np.array_equal(points, line)
    assert np.array_equal(wide, radii)


def test_a_line_that_lies_is_left_as_it_is() -> None:
    ink = inked([(20, 190), (380, 190), (380, 210), (20, 210)])
    line, radii = straight((380.0, 200.0), (20.0, 200.0), 10.0)
    points, wide = stood(line, radii, ink)
    assert np.array_equal(points, line)
    assert np.array_equal(wide, radii)
