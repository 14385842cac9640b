import cv2
import numpy as np
from tests.core.segment.walked_tree import strokes_on, walk

from treestroke.core.segment.view_mattes_drawn import drawn_tree
from treestroke.core.strokes import Stroke, Strokes
from treestroke.core.types import Mask, Picture


def herb() -> tuple[Picture, Mask, Strokes]:
    """A thin stem with pods before a dark cloth in uneven light, drawn roughly: the stem's stroke runs beside it."""
    rng = np.random.default_rng(2)
    y, x = np.mgrid[:480, :400]
    light = 18 + 20 * np.exp(-(((x - 200) / 90) ** 2) - ((y - 150) / 120) ** 2)
    plant = np.zeros((480, 400), np.uint8)
    cv2.line(plant, (200, 460), (205, 40), 1, 5)
    for place in range(60, 440, 30):
        end = (200 + (45 if place % 60 else -45), place - 20)
        cv2.line(plant, (202, place), end, 1, 4)
    photo = np.where(plant[..., None] > 0, np.array([110, 140, 40]), light[..., None] * np.ones(3))
    noisy = np.clip(photo + rng.normal(0, 2, photo.shape), 0, 255).astype(np.uint8)
    crown = np.array([[130, 20], [270, 20], [270, 465], [130, 465]], float)
    stem = np.array([[203, 462], [207, 300], [202, 60]], float)
    return noisy, plant > 0, Strokes(Stroke(crown), (Stroke(stem),))


def test_a_thin_plant_is_found_and_not_the_cloth_behind_it() -> None:
    photo, plant, strokes = herb()
    drawn = drawn_tree(photo, strokes)
    found = drawn.alpha > 0.5
    assert (found & plant).sum() / (found | plant).sum() > 0.8
    assert drawn.bare


def test_a_tree_in_leaf_keeps_its_leaves() -> None:
    shots, trees = walk(1)
    drawn = drawn_tree(shots[0].picture, strokes_on(shots[0]))
    assert not drawn.bare
    assert (drawn.alpha > 0.5)[trees[0]].mean() > 0.85
