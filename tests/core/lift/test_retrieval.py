from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.sketched import Pair, broadleaf, neat, sketched, tuning_pairs

from treestroke.core.lift.params import RetrievalParams
from treestroke.core.lift.retrieval import COMPLEMENTED, LONE, PAIRED, Retrieved, retrieve_depth
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.survey.fidelity import Fidelity, fidelity

PAIRS = tuning_pairs()
STEM = [(0.0, 300.0), (0.0, 500.0), (0.0, 1000.0)]
IN_PLANES = {
    # The front has half again as many limbs as the side, and higher ones, so that for some only the stem is left.
    "broad 9/6": 0.28,
    # Level boughs pass few heights: for two fifths of them the other sketch has nothing but its stem.
    "pine 24/18": 0.53,
    # Where most limbs of the side hang lower than the front's, they are aligned with several of them.
    "weeping 9/7": 0.2,
}
"""Share of the limbs' length in the two planes of view, of the pairs that do not keep to a quarter."""


@cache
def retrieved(name: str) -> Retrieved:
    return retrieve_depth(*PAIRS[name])


def judged(pair: Pair, found: Retrieved) -> Fidelity:
    return fidelity(*pair, found.tree, found.origin == PAIRED)


def limbs(found: Retrieved) -> list[np.ndarray]:
    """List the points of each of the tree's limbs, without the stem."""
    tree = found.tree
    return [tree.skeleton.points[tree.branch == number] for number in range(1, tree.branch.max() + 1)]


def is_one_tree(found: Retrieved) -> bool:
    parents = found.tree.skeleton.parents
    return parents[0] == -1 and bool((parents[1:] >= 0).all()) and not found.tree.skeleton.points[0].any()


@pytest.mark.parametrize("name", PAIRS)
def test_the_tree_shows_all_of_both_sketches_and_little_else(name: str) -> None:
    found = judged(PAIRS[name], retrieved(name))
    assert min(found.front_covered, found.side_covered) >= 0.98
    assert min(found.front_true, found.side_true) >= 0.95
    assert found.paired >= 0.6


@pytest.mark.parametrize("name", PAIRS)
def test_limbs_stand_out_of_the_two_planes_of_view(name: str) -> None:
    assert judged(PAIRS[name], retrieved(name)).in_planes <= IN_PLANES.get(name, 0.25)


@pytest.mark.parametrize("name", PAIRS)
def test_the_tree_is_in_one_piece_from_the_origin(name: str) -> None:
    assert is_one_tree(retrieved(name))


# The neat pair is drawn with long pieces, so that the nearest drawn joint is far.
@pytest.mark.parametrize("name", sorted(set(PAIRS) - {"neat"}))
def test_each_joint_names_the_drawn_joints_near_it(name: str) -> None:
    found, (front, side) = retrieved(name), PAIRS[name]
    points, known = found.tree.skeleton.points, found.origin != LONE
    for sketch, joints, axis in ((front, found.front, 0), (side, found.side, 2)):
        away = np.abs(sketch.skeleton.points[joints] - points[:, [axis, 1]])[known].max(axis=1)
        assert np.quantile(away, 0.95) < 12.0


def test_points_of_equal_height_pair_up() -> None:
    found = retrieve_depth(*neat())
    first, second = sorted(limbs(found), key=lambda limb: float(limb[-1, 1]))
    assert first[:, 0] == pytest.approx(np.interp(first[:, 1], [300, 600], [0, 250]), abs=1.0)
    assert first[:, 2] == pytest.approx(np.interp(first[:, 1], [300, 450, 600], [0, -150, -180]), abs=1.0)
    assert second[:, 0] == pytest.approx(np.interp(second[:, 1], [500, 800], [0, -200]), abs=1.0)
    assert second[:, 2] == pytest.approx(np.interp(second[:, 1], [500, 800], [0, 250]), abs=1.0)
    assert (found.origin == PAIRED).all()


def test_a_limb_that_reaches_higher_than_its_partner_goes_on_with_another() -> None:
    front = sketched(STEM, (0, 1, [(300.0, 700.0)]))
    side = sketched(STEM, (0, 1, [(200.0, 500.0)]), (0, 2, [(150.0, 520.0), (250.0, 800.0)]))
    found = retrieve_depth(front, side)
    points = found.tree.skeleton.points
    low, high = (points[np.hypot(points[:, 0] - x, points[:, 1] - y) < 6.0, 2] for x, y in ((150, 500), (300, 700)))
    assert low.max() == pytest.approx(200, abs=6)
    assert high == pytest.approx(np.interp(700, [520, 800], [150, 250]), abs=1)


def test_where_buds_differ_a_limb_leaves_the_tree_at_the_lower_one() -> None:
    front = sketched(STEM, (0, 2, [(300.0, 700.0)]), radii=(20.0, 10.0))
    side = sketched(STEM, (0, 1, [(200.0, 700.0)]), radii=(16.0, 6.0))
    found = retrieve_depth(front, side)
    (limb,) = limbs(found)
    assert limb[0, 1] < 310
    low = limb[:, 1] < 490
    assert limb[low, 0] == pytest.approx(0.0)
    assert limb[-1] == pytest.approx([300, 700, 200], abs=1.0)


def test_on_the_other_sketch_s_stem_a_limb_keeps_its_own_radius() -> None:
    front = sketched(STEM, (0, 2, [(300.0, 700.0)]), radii=(20.0, 10.0))
    side = sketched(STEM, (0, 1, [(200.0, 700.0)]), radii=(16.0, 6.0))
    tree = retrieve_depth(front, side).tree
    height = tree.skeleton.points[:, 1]
    extension = (tree.branch == 1) & (height > 301) & (height <= 500)
    assert extension.any()
    assert tree.skeleton.radii[extension] == pytest.approx(np.interp(height[extension], [300, 700], [16, 6]), abs=0.3)


def test_brushes_radii_are_averaged_but_leave_no_ink_uncovered_and_a_single_radius_counts_fully() -> None:
    front = sketched(STEM, (0, 1, [(300.0, 700.0)]), radii=(20.0, 10.0))
    both = retrieve_depth(front, sketched(STEM, (0, 1, [(200.0, 700.0)]), radii=(18.0, 4.0))).tree
    assert both.skeleton.radii[0] == 19
    assert both.skeleton.radii[-1] == pytest.approx(8.5)
    one = retrieve_depth(front, sketched(STEM, (0, 1, [(200.0, 700.0)]), radii=(16.0, 0.0))).tree
    assert one.skeleton.radii[-1] == pytest.approx(10)


def test_a_brush_s_partner_is_as_thick() -> None:
    front = sketched(STEM, (0, 1, [(1.0, 301.0), (300.0, 700.0)]), radii=(20.0, 12.0))
    twins = (0, 1, [(1.0, 301.0), (200.0, 700.0)]), (0, 1, [(-1.0, 301.0), (-200.0, 700.0)])
    for radii, depth in (((20.0, 12.0, 3.0), 200.0), ((20.0, 3.0, 12.0), -200.0)):
        found = retrieve_depth(front, sketched(STEM, *twins, radii=radii))
        first = found.tree.skeleton.points[found.tree.branch == 1]
        assert np.sign(first[-1, 2]) == np.sign(depth)


def test_limbs_of_the_side_that_no_limb_of_the_front_used_complement_the_tree() -> None:
    side = sketched(STEM, (0, 1, [(200.0, 700.0)]), (0, 1, [(-200.0, 700.0)]))
    found = retrieve_depth(sketched(STEM, (0, 1, [(300.0, 700.0)])), side)
    paired, complemented = (found.tree.skeleton.points[found.origin == origin] for origin in (PAIRED, COMPLEMENTED))
    assert paired[:, 2].min() > -1.0
    assert paired[:, 2].max() > 190.0
    assert complemented[:, 2].max() < 1.0
    assert complemented[-1] == pytest.approx([300, 700, -200])


def test_a_part_at_heights_that_the_other_sketch_lacks_is_lone() -> None:
    front = sketched(STEM, (0, 1, [(100.0, 200.0), (200.0, -200.0)]))
    found = retrieve_depth(front, sketched(STEM, (0, 1, [(200.0, 700.0)])))
    lone = found.tree.skeleton.points[found.origin == LONE]
    assert lone[-1, :2] == pytest.approx([200, -200])
    assert (lone[:, 1] < 0).all()
    assert is_one_tree(found)


def test_hanging_limbs_pair_although_their_buds_are_not_equally_high() -> None:
    stem = [(0.0, 600.0), (0.0, 850.0), (0.0, 1000.0)]
    front = sketched(stem, (0, 2, [(150.0, 900.0), (250.0, 200.0)]))
    side = sketched(stem, (0, 1, [(150.0, 650.0), (250.0, 200.0)]))
    found = retrieve_depth(front, side)
    assert [250.0, 200.0, 250.0] in found.tree.skeleton.points.round(1).tolist()
    assert judged((front, side), found).in_planes < 0.5


def test_a_sketch_against_itself_pairs_every_limb_with_itself() -> None:
    found = retrieved("same")
    points = found.tree.skeleton.points
    apart = np.abs(points[:, 0] - points[:, 2])
    # Hardly more than a step along a level piece, where heights do not tell.
    assert apart.max() < 8.0
    assert apart.mean() < 2.0
    assert judged(PAIRS["same"], found).paired >= 0.99


def test_two_bare_stems_make_a_bare_stem() -> None:
    found = retrieve_depth(sketched(STEM), sketched([(40.0, 500.0), (0.0, 1000.0)]))
    assert not found.tree.branch.any()
    points = found.tree.skeleton.points
    assert points[:, 2] == pytest.approx(np.interp(points[:, 1], [0, 500, 1000], [0, 40, 0]), abs=0.6)


def test_limbs_against_a_bare_stem_stay_in_the_picture_s_plane() -> None:
    front = broadleaf(4, 3)
    found = retrieve_depth(front, sketched(STEM))
    assert (found.tree.skeleton.points[:, 2] == 0).all()
    assert is_one_tree(found)
    assert judged((front, sketched(STEM)), found).front_covered >= 0.98


def test_the_same_sketches_give_the_same_bytes() -> None:
    again, found = retrieve_depth(*PAIRS["broad 7/7"]), retrieved("broad 7/7")
    assert again.tree.skeleton.points.tobytes() == found.tree.skeleton.points.tobytes()
    assert np.array_equal(again.origin, found.origin)
    assert np.array_equal(again.tree.branch, found.tree.branch)


@pytest.mark.parametrize(
    "wrong", [{"step": 0.5}, {"step": 21.0}, {"tries": 0}, {"radius_weight": -1.0}, {"flat_cost": -0.1}]
)
def test_params_refuse_nonsense(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="retrieval needs"):
        RetrievalParams(**wrong)


def scrawl(picks: Sequence[int], seed: int) -> Branched:
    """Draw any tree: the parent of each further joint is any before it, its place is anywhere."""
    parents = [-1] + [pick % joint for joint, pick in enumerate(picks, start=1)]
    points = np.random.default_rng(seed).uniform(-400, 400, (len(parents), 2))
    points -= points[0]
    points[:, 1] *= 1000.0 / points[:, 1].max() if points[:, 1].max() > 100 else 1.0
    branch, gone_on = [0], set()
    for parent in parents[1:]:
        branch.append(max(branch) + 1 if parent in gone_on else branch[parent])
        gone_on.add(parent)
    return Branched(Skeleton(points, np.zeros(len(parents)), np.array(parents)), np.array(branch))


SCRAWLS = st.builds(scrawl, st.lists(st.integers(0, 59), min_size=1, max_size=4), st.integers(0, 999))


@given(SCRAWLS, SCRAWLS)
@settings(max_examples=25, deadline=None)
def test_whatever_is_drawn_becomes_one_tree_that_covers_it(front: Branched, side: Branched) -> None:
    found = retrieve_depth(front, side)
    assert is_one_tree(found)
    shares = judged((front, side), found)
    assert min(shares.front_covered, shares.side_covered) >= 0.95
