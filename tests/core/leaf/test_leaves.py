import numpy as np
import pytest

from treestroke.core.geometry.mesh import ALPHA_CUT
from treestroke.core.leaf.leaves import Leaves, fruit_among, join_leaves, leaf_area, no_leaves
from treestroke.core.paint.atlas import Atlas

LAST_CUT, FIRST_DRAWN = int(np.ceil(255 * ALPHA_CUT)) - 1, int(np.ceil(255 * ALPHA_CUT))


def card(tile: int = 0) -> Leaves:
    """A card of 2 x 4 m."""
    sides = np.array([[1.0, 0, 0]]), np.array([[0, 2.0, 0]])
    return Leaves(np.zeros((1, 3)), *sides, np.array([tile]), np.zeros(1, bool), np.ones(1), np.zeros(1, np.int64))


def atlas_of(alpha: int, fruit: int | None = None) -> Atlas:
    """Two tiles of 8 x 8 px, whose left halves have this alpha and whose right halves are transparent."""
    image = np.zeros((8, 16, 4), np.uint8)
    image[:, [0, 1, 2, 3, 8, 9, 10, 11], 3] = alpha
    boxes = np.array([[0, 0, 0.5, 1], [0.5, 0, 1, 1]])
    return Atlas(image, boxes, np.zeros((2, 3)), fruit=fruit)


@pytest.mark.parametrize(("alpha", "area"), [(255, 4.0), (FIRST_DRAWN, 4.0), (LAST_CUT, 0.0)])
def test_leaf_area_is_what_a_viewer_draws_of_the_cards(alpha, area):
    assert leaf_area(card(), atlas_of(alpha)) == pytest.approx(area)


def test_fruit_is_told_by_its_tile_and_adds_no_leaf_area():
    both, atlas = join_leaves([card(0), card(1)]), atlas_of(255, fruit=1)
    assert fruit_among(both, atlas).tolist() == [False, True]
    assert leaf_area(both, atlas) == pytest.approx(leaf_area(card(), atlas))


def test_no_cards_have_no_area():
    assert leaf_area(join_leaves([]), atlas_of(255)) == leaf_area(no_leaves(), atlas_of(255)) == 0
