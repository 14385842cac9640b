import cv2
import numpy as np
import pytest

from treestroke.core.segment.cut_foliage import cut_foliage

SIZE = 400


def disc(radius: float, centre: tuple[int, int] = (200, 200)) -> np.ndarray:
    return cv2.circle(np.zeros((SIZE, SIZE), np.uint8), centre, int(radius), 1, -1) > 0


def odds(leaf: np.ndarray) -> np.ndarray:
    """Return log odds of leaf pixels (h, w) with the noise of a real crown."""
    noise = np.random.default_rng(0).normal(0, 1.0, leaf.shape)
    return (np.where(leaf, 2.0, -2.0) + noise).astype(np.float32)


@pytest.mark.parametrize("share", [0.95, 0.9])
def test_foliage_just_beyond_the_line_belongs_to_the_tree(share: float) -> None:
    tree, inside = disc(120), disc(120 * share)
    whole = inside | cut_foliage(odds(tree), inside)
    assert (whole & tree).sum() / (whole | tree).sum() > 0.97


def test_a_line_around_the_foliage_stays() -> None:
    assert not cut_foliage(odds(disc(110)), disc(120)).any()


def test_a_neighbour_is_left_out_where_it_touches_the_crown() -> None:
    neighbour = disc(90, (360, 200)) & ~disc(120)
    found = cut_foliage(odds(disc(120) | neighbour), disc(114))
    assert found[:, :200].sum() > 0.8 * (disc(120) & ~disc(114))[:, :200].sum()
    assert (found & neighbour).sum() < 0.02 * neighbour.sum()


def test_a_lawn_below_the_crown_is_left_out() -> None:
    lawn = np.arange(SIZE)[:, None] >= np.full(SIZE, 300)
    found = cut_foliage(odds(disc(120) | lawn), disc(114))
    assert found[300:].sum() < 0.02 * disc(120).sum()


def test_nothing_is_beyond_a_crown_that_fills_the_photo() -> None:
    assert not cut_foliage(odds(disc(300)), np.ones((SIZE, SIZE), dtype=bool)).any()
