from pathlib import Path

import cv2
import numpy as np
import pytest
from tests.conftest import DATA, EXAMPLES

from treestroke.core.segment.occluders import Pole, find_poles, is_branch, painted_over
from treestroke.core.strokes import Strokes
from treestroke.service.loading import load_photo, load_strokes


def maple() -> tuple[np.ndarray, Strokes]:
    return load_photo(EXAMPLES / "sugar_maple_autumn.jpg"), load_strokes(EXAMPLES / "sugar_maple_autumn.strokes.json")


def lines_in(photo: np.ndarray, strokes: Strokes) -> tuple[Pole, ...]:
    return find_poles(photo, strokes.crown.points, [branch.points for branch in strokes.branches])


def with_line(photo: np.ndarray, points: list[list[float]], width: int, colour: tuple[int, int, int]) -> np.ndarray:
    drawn = photo.copy()
    ends = np.round(np.array(points) * 16).astype(np.int32)
    return cv2.polylines(drawn, [ends], False, colour, width, cv2.LINE_AA, 4)


POLE = [[190.0, -5.0], [190.0, 590.0]]
WIRE = [[x, 200 + 0.06 * x - 12 * (1 - ((x - 340) / 340) ** 2)] for x in np.linspace(-5.0, 690.0, 40)]


@pytest.mark.parametrize(
    ("points", "width", "colour"),
    [(POLE, 10, (215, 215, 210)), (POLE, 14, (90, 95, 100)), (WIRE, 3, (20, 20, 22))],
    ids=["white pole", "grey pole", "sagging wire"],
)
def test_a_line_before_the_crown_is_found_over_its_length_and_painted_over(
    points: list[list[float]], width: int, colour: tuple[int, int, int]
) -> None:
    photo, strokes = maple()
    crossed = with_line(photo, points, width, colour)
    (line,) = lines_in(crossed, strokes)
    drawn = np.any(crossed != photo, axis=2)
    painted = painted_over(crossed, (line,))
    assert width <= line.width <= width + 6

    def share_left(picture: np.ndarray) -> float:
        return float((np.abs(picture[drawn].astype(int) - colour).sum(axis=1) < 40).mean())

    assert share_left(painted) < 0.15 < 0.6 < share_left(crossed)
    far = cv2.dilate(drawn.astype(np.uint8), np.ones((9, 9))) == 0
    assert np.array_equal(painted[far], photo[far])


@pytest.mark.parametrize(
    "photo",
    [
        *(
            EXAMPLES / f"{name}.jpg"
            for name in ("sugar_maple_autumn", "burr_oak_dusk", "oak_02", "osage_orange_autumn")
        ),
        *(DATA / f"{name}.jpg" for name in ("redbud_park", "beech_round", "cherry_blossom", "bigleaf_maple_bare")),
    ],
    ids=lambda path: path.stem,
)
def test_no_trunk_or_limb_of_a_real_tree_is_taken_for_a_line(photo: Path) -> None:
    assert lines_in(load_photo(photo), load_strokes(photo.with_suffix(".strokes.json"))) == ()


def test_a_pole_behind_the_crown_is_none_before_it() -> None:
    photo, strokes = maple()
    behind = with_line(photo, POLE, 10, (215, 215, 210))
    crown = cv2.fillPoly(np.zeros(photo.shape[:2], np.uint8), [np.round(strokes.crown.points).astype(np.int32)], 1) > 0
    behind[crown] = photo[crown]
    assert lines_in(behind, strokes) == ()


def test_a_line_that_a_stroke_follows_is_a_branch() -> None:
    _, strokes = maple()
    line = Pole(np.array([[190.0, 100.0], [190.0, 300.0], [190.0, 580.0]]), 10.0)
    trunk = [branch.points for branch in strokes.branches]
    assert not is_branch(line, strokes.crown.points, trunk)
    assert is_branch(line, strokes.crown.points, [*trunk, np.array([[192.0, 580.0], [188.0, 300.0]])])


def test_a_photo_without_lines_stays_as_it_is() -> None:
    photo, _ = maple()
    assert np.array_equal(painted_over(photo, ()), photo)
