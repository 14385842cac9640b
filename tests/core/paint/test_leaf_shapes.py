from typing import get_args

import cv2
import numpy as np
import pytest

from treestroke.core.paint.leaf_shapes import LeafShape, LeafShapeName, leaf_shape

NAMES = get_args(LeafShapeName)


def filled(leaf: LeafShape) -> np.ndarray:
    """Draw a leaf on 200 x 200 px, as long as 160."""
    canvas = np.zeros((200, 200), np.uint8)
    for outline in leaf.outlines:
        cv2.fillPoly(canvas, [np.int32(np.array([100, 180]) + 160 * outline * np.array([1, -1]))], 1)
    return canvas > 0


@pytest.mark.parametrize("name", NAMES)
def test_a_leaf_stands_on_its_stalk_s_foot_and_is_about_as_long_as_1(name):
    leaf = leaf_shape(name)
    points = np.concatenate(leaf.outlines)
    assert leaf.stalk[0].tolist() == [0, 0]
    assert points[:, 1].min() >= -0.1
    assert points[:, 1].max() == pytest.approx(1, abs=0.05)


@pytest.mark.parametrize("name", NAMES)
def test_a_leaf_is_as_wide_to_the_left_as_to_the_right(name):
    points = {(round(x, 6) + 0.0, round(y, 6)) for x, y in np.concatenate(leaf_shape(name).outlines).tolist()}
    assert points == {(-x + 0.0, y) for x, y in points}


@pytest.mark.parametrize("name", NAMES)
def test_halves_lie_to_the_left_within_their_outlines(name):
    leaf = leaf_shape(name)
    assert len(leaf.halves) == len(leaf.outlines)
    for half, outline in zip(leaf.halves, leaf.outlines, strict=True):
        inside = [cv2.pointPolygonTest(np.float32(outline), point.tolist(), True) for point in half]
        assert min(inside) > -0.01


def test_no_two_leaves_have_the_same_outline():
    shapes = [filled(leaf_shape(name)) for name in NAMES]
    overlaps = [(a & b).sum() / (a | b).sum() for i, a in enumerate(shapes) for b in shapes[:i]]
    assert max(overlaps) < 0.92


def test_lobed_leaves_have_bays_and_a_linden_s_has_none():
    def fullness(name: LeafShapeName) -> float:
        outline = np.float32(leaf_shape(name).outlines[0])
        return cv2.contourArea(outline) / cv2.contourArea(cv2.convexHull(outline))

    assert max(fullness("maple"), fullness("oak"), fullness("plane")) < 0.85
    assert fullness("linden") > 0.9


@pytest.mark.parametrize(("name", "leaflets"), [("ash", 7), ("walnut", 13), ("locust", 15), ("horse_chestnut", 7)])
def test_compound_leaves_have_their_number_of_leaflets(name, leaflets):
    assert len(leaf_shape(name).outlines) == leaflets
