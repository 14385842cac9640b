import numpy as np
from tests.core.grow.crowns import limbed_case, trunk_case

from treestroke.core.grow.branches import split_chains, successors_by_wood
from treestroke.core.grow.growth_space import in_mask
from treestroke.core.grow.stem import foot_of, stem_of, with_leader
from treestroke.core.skeleton.skeleton import Skeleton


def test_chains_hold_every_edge_once() -> None:
    case = limbed_case()
    px = case.visible
    chains = split_chains(px, in_mask(px.points, case.mask), (48.0, 48.0))
    edges = sorted((a, b) for chain in chains for a, b in zip(chain.joints[:-1], chain.joints[1:], strict=True))
    assert edges == sorted((p, j) for j, p in enumerate(px.parents) if p >= 0)


def test_no_chain_in_the_crown_is_longer_than_asked() -> None:
    case = trunk_case()
    px = case.visible
    inside = in_mask(px.points, case.mask)
    for chain in split_chains(px, inside, (48.0, 48.0)):
        length = np.linalg.norm(px.points[chain.joints[-1]] - px.points[chain.joints[0]])
        assert length <= 48 + 5 or not inside[chain.joints[1]]


def test_a_chain_ends_where_the_stem_enters_the_crown() -> None:
    case = trunk_case()
    px = case.visible
    inside = in_mask(px.points, case.mask)
    ends = {int(chain.joints[-1]) for chain in split_chains(px, inside, (48.0, 48.0))}
    assert int(np.argmax(inside)) in ends


def test_a_sharp_turn_ends_a_chain() -> None:
    points = np.array([[0.0, 100 - 10 * k, 0] for k in range(6)] + [[10.0 * k, 50, 0] for k in range(1, 6)])
    bent = Skeleton(points, np.ones(11), np.arange(11) - 1)
    ends = [int(chain.joints[-1]) for chain in split_chains(bent, np.zeros(11, dtype=bool), (90.0, 90.0))]
    assert ends == [5, 10]


def test_stems_are_first_and_their_limbs_second() -> None:
    case = limbed_case()
    px = case.visible
    chains = split_chains(px, in_mask(px.points, case.mask), (48.0, 48.0))
    assert {chain.generation for chain in chains} == {1, 2}
    assert chains[0].generation == 1


def test_the_stem_goes_to_the_highest_joint_past_a_heavy_limb() -> None:
    trunk = [[0.0, -10.0 * k, 0.0] for k in range(6)]
    limb = [[30.0 * k, -20.0, 0.0] for k in range(1, 9)]
    px = Skeleton(np.array(trunk + limb), np.r_[np.full(6, 2.0), np.full(8, 9.0)], np.r_[-1, 0:5, 2, 6:13])
    assert stem_of(px).tolist() == [0, 1, 2, 3, 4, 5]
    assert successors_by_wood(px)[2] == 3


def test_a_low_stem_is_carried_on_inside_the_foliage() -> None:
    case = trunk_case(top=250.0)
    px = case.visible
    longer = with_leader(px, case.mask, case.sections, 0.65)
    assert longer.points[-1, 1] <= 280 - 0.6 * 240
    assert in_mask(longer.points[len(px) :], case.mask).all()
    np.testing.assert_array_equal(longer.points[: len(px)], px.points)


def test_a_high_stem_stays_as_it_is() -> None:
    case = trunk_case()
    px = case.visible
    assert with_leader(px, case.mask, case.sections, 0.65) is px


def test_the_foot_is_where_the_stem_enters_the_foliage() -> None:
    case = trunk_case()
    assert foot_of(case.visible, case.mask).tolist() == [160.0, 275.0, 0.0]
