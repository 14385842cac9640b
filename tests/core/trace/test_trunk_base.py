import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from treestroke.core.strokes import Sketch
from treestroke.core.trace.drawing import Drawing, trace_sketch
from treestroke.core.trace.trunk_base import centre_trunk_base

SIZE = 400
GROUND = 380


def inked(*outlines: list[tuple[int, int]]) -> NDArray[np.bool_]:
    picture = np.zeros((SIZE, SIZE), np.uint8)
    for outline in outlines:
        cv2.fillPoly(picture, [np.array(outline, dtype=np.int32)], 255)
    return picture > 0


def traced(ink: NDArray[np.bool_]) -> Drawing:
    return trace_sketch(Sketch((SIZE, SIZE), None, (), ink))


def straight(top: tuple[float, float], root: tuple[float, float], radius: float) -> tuple[np.ndarray, np.ndarray]:
    line = np.linspace(root, top, 300)
    return line, np.full(len(line), radius)


def test_a_wide_base_is_met_in_its_middle_and_in_its_width() -> None:
    trunk = [(185, 20), (215, 20), (215, 330), (255, GROUND), (165, GROUND), (185, 340)]
    tree = traced(inked(trunk)).tree.skeleton
    assert tree.points[0] == pytest.approx([210.5, GROUND + 1], abs=2)
    assert tree.radii[0] == pytest.approx(45.5, abs=2)
    assert tree.radii[np.abs(tree.points[:, 1] - 200).argmin()] == pytest.approx(15.5, abs=1.5)


def test_a_round_end_does_not_narrow_the_base() -> None:
    picture = np.zeros((SIZE, SIZE), np.uint8)
    cv2.line(picture, (200, 30), (200, 350), 255, 40)
    tree = traced(picture > 0).tree.skeleton
    assert tree.points[0] == pytest.approx([200.5, 371], abs=2)
    assert tree.radii[0] == pytest.approx(20, abs=1.5)


def test_a_drawn_ground_is_not_the_base() -> None:
    trunk, ground = [(190, 20), (210, 20), (210, GROUND), (190, GROUND)], [(20, 350), (380, 350), (380, 365), (20, 365)]
    ink = inked(trunk, ground)
    line, radii = straight((200.0, 20.0), (200.0, GROUND), 10.5)
    points, wide = centre_trunk_base(line, radii, ink)
    assert np.array_equal(points, line)
    assert np.array_equal(wide, radii)


def test_a_level_line_is_unchanged() -> None:
    ink = inked([(20, 190), (380, 190), (380, 210), (20, 210)])
    line, radii = straight((380.0, 200.0), (20.0, 200.0), 10.0)
    points, wide = centre_trunk_base(line, radii, ink)
    assert np.array_equal(points, line)
    assert np.array_equal(wide, radii)
