import numpy as np
import pytest

from treestroke.core.imaging.analogy import Analogy, analogy


def depths_within(width: int, middle: float, radius: float, height: int = 80) -> np.ndarray:
    """A drum: how far each pixel lies within the columns about a middle."""
    across = radius - np.abs(np.arange(width) + 0.5 - middle)
    return np.tile(across, (height, 1))


def striped(width: int, middle: float, radius: float) -> np.ndarray:
    """A drum of level bars, 4 px high, with gaps of 4 px, that reach out of it by 2 px."""
    mask = np.abs(np.arange(width) + 0.5 - middle) <= radius + 2
    return mask & (np.arange(80)[:, None] // 4 % 2 == 0)


def new_picture(seed: int = 0) -> tuple[Analogy, np.ndarray]:
    picture = striped(60, 30, 18)
    made = analogy(picture, depths_within(60, 30, 18), depths_within(90, 40, 28), np.random.default_rng(seed))
    return made, made.of(picture)


def test_it_fills_the_new_outline_as_the_old_one_was_filled() -> None:
    picture = new_picture()[1]
    assert picture.shape == (80, 90)
    assert picture[:, 15:65].mean() == pytest.approx(0.5, abs=0.05)
    assert not picture[:, np.r_[:6, 74:90]].any()
    ends = [(np.flatnonzero(row)[0], np.flatnonzero(row)[-1] + 1) for row in picture if row.any()]
    assert np.mean(ends, axis=0) == pytest.approx([10, 70], abs=3)


def test_patches_go_on_as_their_neighbours_began() -> None:
    """Bars of a picture whose bars are at random heights for each patch would be broken at most borders."""
    picture = new_picture()[1][:, 20:60]
    assert (picture[:, 1:] != picture[:, :-1]).mean() < 0.06


def test_a_pixel_is_a_copy_of_the_pixel_that_it_names() -> None:
    made = new_picture()[0]
    levels = np.tile(np.arange(80)[:, None], (1, 60))
    rows, columns = np.nonzero(made.row >= 0)
    assert np.abs(levels[made.row[rows, columns], 0] - rows).max() <= 0.1 * 80 + 8
    assert {True, False} == set(made.mirrored[rows, columns].tolist())
    assert (made.column[made.row >= 0] >= 0).all()


def test_what_lies_far_outside_is_blank() -> None:
    picture = striped(60, 30, 18)
    made = analogy(picture, depths_within(60, 30, 18), depths_within(300, 30, 18), np.random.default_rng(0))
    assert (made.row[:, 80:] == -1).all()
    assert not made.of(picture)[:, 80:].any()


def test_the_same_seed_gives_the_same_and_another_another() -> None:
    assert np.array_equal(new_picture(1)[1], new_picture(1)[1])
    assert not np.array_equal(new_picture(1)[1], new_picture(2)[1])


@pytest.mark.parametrize("size", [(1, 1), (3, 40), (60, 2)])
def test_the_smallest_pictures_are_continued(size: tuple[int, int]) -> None:
    picture, depths = np.ones(size, dtype=bool), np.full(size, 0.5)
    assert analogy(picture, depths, depths, np.random.default_rng(0)).of(picture).shape == size
