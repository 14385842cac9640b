import numpy as np
from tests.core.lift.test_spread import SPRAY

from treestroke.core.lift.hidden_limbs import THINNER, with_hidden_limbs

STROKE = np.where(np.arange(len(SPRAY)) < 5, 0, -1)


def test_every_limb_is_there_twice_at_the_same_place_and_the_stem_once() -> None:
    whole, joints = with_hidden_limbs(SPRAY, STROKE)
    hidden = joints[len(SPRAY) :]
    assert len(whole) == len(joints) == len(SPRAY) + (STROKE < 0).sum()
    assert np.array_equal(whole.points, SPRAY.points[joints])
    assert np.array_equal(np.sort(hidden), np.flatnonzero(STROKE < 0))
    assert np.allclose(whole.radii[len(SPRAY) :], THINNER * SPRAY.radii[hidden])


def test_a_hidden_limb_is_its_own_from_the_stem_on() -> None:
    whole, joints = with_hidden_limbs(SPRAY, STROKE)
    parents = whole.parents[len(SPRAY) :]
    on_stem = STROKE[SPRAY.parents[joints[len(SPRAY) :]]] == 0
    assert (parents[on_stem] < 5).all()
    assert (parents[~on_stem] >= len(SPRAY)).all()
    assert np.array_equal(joints[parents], SPRAY.parents[joints[len(SPRAY) :]])
