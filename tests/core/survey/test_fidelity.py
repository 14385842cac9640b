import numpy as np
import pytest
from tests.sketched import Stroke, sketched

from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.survey.fidelity import Fidelity, fidelity

STEM = [(0.0, 400.0), (0.0, 500.0), (0.0, 1000.0)]
FRONT, SIDE = sketched(STEM, (0, 2, [(300.0, 500.0)])), sketched(STEM, (0, 2, [(200.0, 500.0)]))


def tree(*tips: tuple[float, float, float], radius: float = 0.0) -> Branched:
    """Build a stem with straight limbs that leave it at a height of 500; joint 4 and on are their tips."""
    stem = [(0.0, 0.0, 0.0), *((x, y, 0.0) for x, y in STEM)]
    parents = [-1, 0, 1, 2] + [2] * len(tips)
    skeleton = Skeleton(np.array([*stem, *tips]), np.full(len(parents), radius), np.array(parents))
    return Branched(skeleton, np.array([0, 0, 0, 0, *range(1, len(tips) + 1)]))


def compared(found: Branched, *strokes: Stroke, lone: tuple[int, ...] = ()) -> Fidelity:
    """Compare with the front and the side, with further strokes on the front; limbs of joints ``lone`` are unpaired."""
    front = sketched(STEM, (0, 2, [(300.0, 500.0)]), *strokes)
    return fidelity(front, SIDE, found, ~np.isin(np.arange(len(found)), lone))


def test_a_tree_that_looks_like_both_sketches_has_all_shares() -> None:
    shares = compared(tree((300.0, 500.0, 200.0)))
    assert [shares.front_covered, shares.side_covered, shares.front_true, shares.side_true, shares.paired] == [1.0] * 5
    # The limb leaves the plane at a depth of 20, a tenth of its way.
    assert shares.in_planes == pytest.approx(0.1, abs=0.005)


def test_a_missing_limb_lowers_what_is_covered() -> None:
    shares = compared(tree())
    assert shares.front_covered == pytest.approx(1000 / 1300, abs=0.01)
    assert shares.side_covered == pytest.approx(1000 / 1200, abs=0.01)
    assert shares.front_true == shares.side_true == 1.0
    assert shares.paired < 0.02


def test_a_stray_limb_lowers_what_is_true() -> None:
    shares = compared(tree((300.0, 500.0, 200.0), (-250.0, 500.0, 100.0)))
    limbs = np.hypot(300, 0), 250.0
    assert shares.front_true == pytest.approx((1000 + limbs[0]) / (1000 + sum(limbs)), abs=0.01)
    assert shares.side_true == shares.front_covered == shares.side_covered == 1.0


def test_only_pieces_that_pair_count_as_paired() -> None:
    found = tree((300.0, 500.0, 200.0), (-100.0, 500.0, 150.0))
    shares = compared(found, (0, 2, [(-100.0, 500.0)]), lone=(5,))
    assert shares.paired == pytest.approx(0.75, abs=0.01)
    assert compared(found, (0, 2, [(-100.0, 500.0)])).paired == 1.0


@pytest.mark.parametrize("tip", [(300.0, 500.0, 0.0), (0.0, 500.0, 200.0), (300.0, 900.0, 19.0)])
def test_a_tree_in_one_plane_lies_in_the_planes(tip: tuple[float, float, float]) -> None:
    assert compared(tree(tip)).in_planes == 1.0


def test_the_planes_follow_a_leaning_stem() -> None:
    points = np.array([(0.0, 0.0, 0.0), (0.0, 1000.0, 500.0), (300.0, 1000.0, 510.0), (300.0, 1000.0, 200.0)])
    found = Branched(Skeleton(points, np.zeros(4), np.array([-1, 0, 1, 1])), np.array([0, 0, 1, 2]))
    first, second = np.hypot(300, 10), np.hypot(300, 300)
    expected = (first + second * 20 / 300) / (first + second)
    assert compared(found).in_planes == pytest.approx(expected, abs=0.01)


def test_a_bare_stem_has_nothing_to_pair_and_nothing_in_depth() -> None:
    stem = sketched(STEM)
    shares = fidelity(stem, stem, tree(), np.ones(4, dtype=bool))
    assert shares == Fidelity(1.0, 1.0, 1.0, 1.0, 1.0, 1.0)


def test_brushes_are_compared_at_their_width() -> None:
    wide = sketched(STEM, radii=(10.0,))
    thin, thick = (fidelity(wide, wide, tree(radius=radius), np.ones(4, dtype=bool)) for radius in (0.0, 10.0))
    assert thick.front_covered == thick.side_covered == 1.0
    assert thin.front_covered == pytest.approx(5 / 21, abs=0.05)
    assert thin.front_true == 1.0
