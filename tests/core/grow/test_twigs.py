import numpy as np
import pytest
from tests.core.grow.crowns import trunk_case

from treestroke.core.grow.form import Form
from treestroke.core.grow.growth_space import GrowthSpace
from treestroke.core.grow.twigs import with_twigs


@pytest.fixture
def crown() -> GrowthSpace:
    case = trunk_case()
    return case.space()


def branch() -> Form:
    """A seen trunk of two joints with a grown branch of 19, level in the middle of the crown."""
    points = [[160.0, 400.0, 0.0], [160.0, 160.0, 0.0]] + [[160.0 + 4 * k, 160.0, 0.0] for k in range(1, 20)]
    return Form(np.array(points), np.arange(21) - 1, np.r_[0, 0, np.full(19, 3)], np.r_[8.0, 4.0, np.zeros(19)])


def grown(crown: GrowthSpace, most: int = 100, seed: int = 0) -> Form:
    return with_twigs(branch(), crown, most, np.random.default_rng(seed))


def test_what_is_there_stays(crown: GrowthSpace) -> None:
    for before, after in zip(branch(), grown(crown), strict=True):
        np.testing.assert_array_equal(before, after[:21])


def test_twigs_stand_on_thin_wood_within_the_crown(crown: GrowthSpace) -> None:
    form = grown(crown)
    seats = form.parents[21::2]
    assert len(seats) >= 15
    assert seats.min() >= 2
    assert crown.inside(form.points[21:]).all()
    assert (form.parents[22::2] == np.arange(21, len(form.points), 2)).all()


def test_twigs_stand_evenly_along_their_branch_however_close_its_joints_are(crown: GrowthSpace) -> None:
    form = branch()
    form.points[2:, 0] = np.r_[np.linspace(161, 175, 12), np.linspace(180, 236, 7)]
    seats = with_twigs(form, crown, 15, np.random.default_rng(0)).parents[21::2]
    near = form.points[seats[seats < 21], 0] <= 176
    assert near.mean() == pytest.approx(15 / 76, abs=0.1)


def test_no_more_twigs_than_asked(crown: GrowthSpace) -> None:
    assert len(grown(crown, 5).points) <= 21 + 2 * 5
    assert len(grown(crown, 0).points) == 21


def test_twigs_lean_forward_and_turn_around_their_branch(crown: GrowthSpace) -> None:
    form = grown(crown)
    way = form.points[21::2] - form.points[form.parents[21::2]]
    assert (way[:, 0] > 0.5 * np.linalg.norm(way, axis=1)).all()
    assert way[:, 1].min() < 0 < way[:, 1].max()
    assert way[:, 2].min() < 0 < way[:, 2].max()


def test_the_same_lot_gives_the_same_twigs(crown: GrowthSpace) -> None:
    np.testing.assert_array_equal(grown(crown, seed=4).points, grown(crown, seed=4).points)
