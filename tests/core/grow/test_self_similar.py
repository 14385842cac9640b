from dataclasses import replace

import numpy as np
import pytest
from tests.core.grow.sketched import crown, everywhere, tree

from treestroke.core.geometry.vectors import unit
from treestroke.core.grow.crown_cells import crown_cells
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.self_similar import SelfSimilarParams, grow_small
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.traverse import child_counts

USUAL = SelfSimilarParams()
PLAIN = SelfSimilarParams(rise=0.0, levels=1, most=60, spacing=0.001, crowded=100.0)


def grown(params: SelfSimilarParams = USUAL, main: Branched | None = None, seed: int = 0) -> Grown:
    return grow_small(tree() if main is None else main, crown(), params, np.random.default_rng(seed))


def shoots_of(one: Grown) -> list[np.ndarray]:
    """The joints of each small branch of the first level, its bud first."""
    parents, starts = one.skeleton.parents, np.flatnonzero((one.born == 1) & (one.born[one.skeleton.parents] == 0))
    ends = np.append(starts[1:], np.flatnonzero(one.born == 1)[-1] + 1)
    return [np.append(parents[first], np.arange(first, end)) for first, end in zip(starts, ends, strict=True)]


def directions(one: Grown) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Chord of each small branch and direction of its parent branch, and the place of its bud."""
    shoots, points = shoots_of(one), one.skeleton.points
    buds = np.array([shoot[0] for shoot in shoots])
    chords = unit(np.array([points[shoot[-1]] - points[shoot[0]] for shoot in shoots]))
    return chords, unit(points[buds] - points[one.skeleton.parents[buds]]), buds


def test_angles_with_the_parent_are_within_the_range() -> None:
    main = tree()
    chords, along, _ = directions(grow_small(main, everywhere(), PLAIN, np.random.default_rng(0)))
    cosines = (chords * along).sum(axis=1)
    assert len(cosines) > 40
    assert cosines.min() >= 0.5 - 1e-9
    assert cosines.max() <= 0.9 + 1e-9


def test_angles_between_siblings_are_within_the_range() -> None:
    main = tree()
    chords, along, buds = directions(grow_small(main, everywhere(), PLAIN, np.random.default_rng(0)))
    square = unit(chords - (chords * along).sum(axis=1, keepdims=True) * along)
    order = np.argsort(buds)
    siblings = np.diff(main.branch[buds[order]]) == 0
    cosines = (square[order][1:] * square[order][:-1]).sum(axis=1)[siblings]
    assert len(cosines) > 30
    assert np.abs(cosines).max() <= 0.5 + 1e-9


def test_drawn_joints_stay_and_come_first() -> None:
    main, one = tree(), grown()
    assert np.array_equal(one.skeleton.points[: len(main)], main.skeleton.points)
    assert np.array_equal(one.skeleton.parents[: len(main)], main.skeleton.parents)
    assert np.array_equal(one.born == 0, np.arange(len(one.skeleton)) < len(main))


def test_small_branches_are_connected_and_of_levels_one_and_two() -> None:
    one = grown()
    parent_born = one.born[one.skeleton.parents[len(tree()) :]]
    own = one.born[len(tree()) :]
    assert set(own.tolist()) == {1, 2}
    assert np.isin(own - parent_born, (0, 1)).all()


@pytest.mark.parametrize("off", [0.0, 15.0])
def test_what_grew_lies_inside_both_silhouettes(off: float) -> None:
    volume = crown(off=off)
    one = grow_small(tree(), volume, USUAL, np.random.default_rng(0))
    assert volume.shown(one.skeleton.points[one.born > 0]).all()


@pytest.mark.parametrize("most", [0, 1, 50, 2000])
def test_no_more_small_branches_than_were_asked_for_grow(most: int) -> None:
    one = grown(SelfSimilarParams(most=most))
    born, parents = one.born, one.skeleton.parents
    before = np.arange(len(parents)) - 1
    starts = (born > 0) & ((parents != before) | (born[parents] != born))
    assert 0.8 * most <= starts.sum() <= most


def test_small_branches_fill_the_crown_more_evenly_than_drawn_ones_do() -> None:
    one, lengths = grown(), edge_lengths(grown().skeleton)

    def unevenness(shown: np.ndarray) -> float:
        cells = crown_cells(crown())
        cells.add_wood(one.skeleton.points[shown], lengths[shown])
        middles = cells.corner + cells.side * (np.indices(cells.shape).reshape(3, -1).T + 0.5)
        wood = cells.around()[cells.inside(middles)]
        return float(wood.std() / wood.mean())

    assert unevenness(one.born >= 0) < 0.9
    assert unevenness(one.born >= 0) < 0.6 * unevenness(one.born == 0)


def test_eighths_of_the_crown_hold_about_as_much_wood() -> None:
    one = grown()
    small = one.born > 0
    eighth = (one.skeleton.points[small] > np.array([0.0, 5.6, 0.0])) @ np.array([1, 2, 4])
    wood = np.bincount(eighth, edge_lengths(one.skeleton)[small], 8)
    assert wood.std() < 0.3 * wood.mean()


def test_the_foot_of_the_trunk_is_bare() -> None:
    one = grow_small(tree(), everywhere(), USUAL, np.random.default_rng(0))
    buds = one.skeleton.parents[(one.born == 1) & (one.born[one.skeleton.parents] == 0)]
    assert buds.min() >= 35


def test_the_same_numbers_give_the_same_tree() -> None:
    first, again, other = grown(), grown(), grown(seed=1)
    assert np.array_equal(first.skeleton.points, again.skeleton.points)
    assert np.array_equal(first.skeleton.radii, again.skeleton.radii)
    assert not np.array_equal(first.skeleton.points, other.skeleton.points)


def test_a_trunk_without_width_is_three_to_four_hundredths_of_the_height_thick() -> None:
    one = grown()
    height = float(np.ptp(one.skeleton.points[:, 1]))
    assert 0.03 <= 2 * one.skeleton.radii[0] / height <= 0.04


def test_wood_gets_thinner_outward_and_ends_thin() -> None:
    skeleton = grown().skeleton
    radii, parents = skeleton.radii, skeleton.parents
    assert (radii[1:] <= radii[parents[1:]]).all()
    assert radii[child_counts(skeleton) == 0].max() < 0.05 * radii[0]


def test_a_fork_carries_the_sections_of_its_branches() -> None:
    skeleton = grown().skeleton
    area = np.bincount(skeleton.parents[1:], skeleton.radii[1:] ** 2, len(skeleton))
    forks = child_counts(skeleton) > 1
    assert np.median(area[forks] / skeleton.radii[forks] ** 2) == pytest.approx(1.0, abs=0.15)


def brushed(end: float) -> Grown:
    """A trunk that a brush of 0.3 m radius at the root has drawn."""
    main = tree()
    radii = np.append(np.linspace(0.3, end, 71), np.zeros(len(main) - 71))
    return grown(main=Branched(replace(main.skeleton, radii=radii), main.branch))


def test_radii_of_the_brush_stay_on_the_trunk() -> None:
    assert np.allclose(brushed(0.03).skeleton.radii[:40], np.linspace(0.3, 0.03, 71)[:40], rtol=0.01)


def test_a_brush_that_ends_broad_leaves_no_club() -> None:
    radii = brushed(0.2).skeleton.radii[:71]
    assert radii[10] > 0.25
    assert (radii[65:] < 0.35 * 0.2).all()
    assert np.diff(radii).min() > -0.05


def test_a_lone_trunk_bears_too() -> None:
    one = grown(main=tree(limbs=0))
    assert (one.born == 2).sum() > 100


def test_nothing_grows_where_the_views_share_no_crown() -> None:
    volume = crown()
    front, side = volume.silhouettes
    nowhere = replace(volume, silhouettes=(replace(front, mask=np.zeros_like(front.mask)), side))
    one = grow_small(tree(), nowhere, USUAL, np.random.default_rng(0))
    assert len(one.skeleton) == len(tree())


@pytest.mark.parametrize("wrong", [{"share": 0.0}, {"cos_angle": (0.9, 0.5)}, {"most": -1}, {"spacing": 0.0}])
def test_params_out_of_range_are_refused(wrong: dict) -> None:
    with pytest.raises(ValueError, match="must"):
        SelfSimilarParams(**wrong)
