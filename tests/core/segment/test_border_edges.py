import numpy as np

from treestroke.core.segment.border_edges import share_without_edge

REGION = np.ones((60, 80), np.bool_)
FOUND = np.zeros((60, 80), np.bool_)
FOUND[20:40, 30:50] = True


def test_what_is_found_ends_at_its_edges() -> None:
    photo = np.where(FOUND[..., None], (60, 120, 40), (30, 30, 30)).astype(np.uint8)
    assert share_without_edge(photo, FOUND, REGION) == 0


def test_background_taken_for_a_tree_ends_where_there_is_no_edge() -> None:
    photo = np.full((60, 80, 3), 30, np.uint8)
    photo[:, 40:] = (
        60,
        120,
        40,
    )  # the right half of what was found is of one piece with what is beside it, as the left
    assert share_without_edge(photo, FOUND, REGION) > 0.8


def test_the_end_of_the_region_does_not_count() -> None:
    photo = np.full((60, 80, 3), 30, np.uint8)
    assert share_without_edge(photo, FOUND, FOUND) == 0
