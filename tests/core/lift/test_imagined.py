import numpy as np
import pytest
from tests.core.lift.test_clumps import CAMERA, broken_front, round_front

from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import turned_outline
from treestroke.core.lift.imagined import ImaginedCrown, imagined_crown


def imagined(mask: np.ndarray, seed: int = 0) -> ImaginedCrown:
    front = Silhouette(mask, CAMERA)
    return imagined_crown(turned_outline(front), front, np.random.default_rng(seed))


def gaps(mask: np.ndarray) -> float:
    """Share of a silhouette's rows, from its first to its last pixel, that is not covered."""
    spans = [np.flatnonzero(row) for row in mask if row.any()]
    return 1 - sum(map(len, spans)) / sum(span[-1] - span[0] + 1 for span in spans)


@pytest.mark.parametrize(("front", "least", "most"), [(broken_front, 0.7, 1.35), (round_front, 0.0, np.inf)])
def test_the_side_is_as_open_as_the_front(front, least: float, most: float) -> None:
    sides = [gaps(imagined(front(), seed).side) for seed in range(6)]
    whole = gaps(imagined(front()).front)
    assert np.mean(sides) < 0.01 if whole == 0 else least < np.mean(sides) / whole < most


def test_each_height_of_the_front_has_foliage_at_the_side() -> None:
    for seed in range(4):
        crown = imagined(broken_front(), seed)
        assert np.array_equal(crown.side.any(axis=1), crown.front.any(axis=1))


def test_the_hull_is_what_both_show() -> None:
    crown = imagined(broken_front())
    filled = crown.hull().clumps.filled
    assert np.array_equal(filled.any(axis=2).T, crown.front)
    assert np.array_equal(filled.any(axis=0), crown.side)


def test_the_side_shows_patches_of_what_the_front_shows() -> None:
    front = broken_front()
    crown = imagined(front)
    side = crown.side_of(front)
    assert side.camera.from_left
    assert side.mask.shape == (side.camera.height, side.camera.width)
    assert side.mask.sum() == pytest.approx(crown.side.sum() * crown.cell_px**2, rel=0.1)
    assert not crown.side_of(np.zeros_like(front)).mask.any()
    assert not side.mask[~front.any(axis=1)].any()


def test_the_side_stands_where_the_crown_is() -> None:
    """What the side's picture shows lies in the hull, and what lies in the hull is shown."""
    crown = imagined(broken_front())
    side, hull = crown.side_of(broken_front()), crown.hull()
    row, column = np.nonzero(side.mask)
    points = side.camera.world_from_pixels(np.stack([column, row], axis=1) + 0.5)
    across = np.linspace(-4, 4, 161)
    held = np.any([hull.admits(points + np.array([x, 0, 0])) for x in across], axis=0)
    assert held.mean() > 0.9


def test_another_seed_imagines_another_side() -> None:
    one, same, other = (imagined(broken_front(), seed).side for seed in (0, 0, 1))
    assert np.array_equal(one, same)
    assert one.shape != other.shape or not np.array_equal(one, other)
