"""A drawn tree: a stem, an arm to the left and one to the right, dark on a light ground."""

from collections.abc import Sequence

import numpy as np
import pytest
from scipy.spatial import cKDTree
from tests.pictures import GROUND, wood_mask, wood_photo

from treestroke.core.geometry.polyline import resample
from treestroke.core.imaging.mixture import Mixture
from treestroke.core.imaging.outline import fill_outline
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Stroke, Strokes
from treestroke.core.trace.appearance import Surroundings
from treestroke.core.trace.crown_picture import see_crown
from treestroke.core.trace.tracing import Traced, TraceParams, trace_branches

SIZE, HEIGHT = 450, 400.0
STEM = [(220.0, 430.0), (220.0, 240.0)]
LEFT, RIGHT = [(220.0, 240.0), (90.0, 100.0)], [(220.0, 240.0), (350.0, 100.0)]
TREE = wood_mask([(STEM, 11.0), (LEFT, 7.0), (RIGHT, 7.0)], SIZE, SIZE)
CROWN = Stroke(np.array([[60.0, 40.0], [380.0, 40.0], [380.0, 250.0], [60.0, 250.0]]))
INSIDE = fill_outline(CROWN.points, SIZE, SIZE)
BranchLine = Sequence[Sequence[float]]


def around(colour: tuple[int, int, int], deviation: float) -> Mixture:
    return Mixture(np.ones(1), np.array([colour], float), np.eye(3)[None] * deviation**2)


LEAVES = around((70, 120, 40), 15.0)
BEHIND = around(GROUND, 8.0)


def stroked(*lines: BranchLine, erase: Sequence[BranchLine] = (), width: float | None = None) -> Strokes:
    branches = tuple(Stroke(np.array(line, float), width) for line in lines)
    return Strokes(CROWN, branches, tuple(Stroke(np.array(line, float)) for line in erase))


def trace(strokes: Strokes, wood: np.ndarray = TREE) -> Traced:
    photo, around = wood_photo(wood), Surroundings(LEAVES, BEHIND, INSIDE, INSIDE)
    return trace_branches(photo, strokes, around, see_crown(photo, around, HEIGHT))


def drawn(skeleton: Skeleton, edges: np.ndarray) -> np.ndarray:
    """Walk the edges that end in the given joints, a point each px."""
    ends = [(skeleton.points[skeleton.parents[j]], skeleton.points[j]) for j in edges if skeleton.parents[j] >= 0]
    return np.concatenate([resample(np.stack(pair), 1.0) for pair in ends] or [np.full((1, 2), np.inf)])


def covered(line: BranchLine, traced: Traced, found_only: bool = True, within: float = 6.0) -> float:
    """Share of a line that runs near a traced edge."""
    edges = np.flatnonzero(traced.stroke < 0) if found_only else np.arange(len(traced.stroke))
    near = drawn(traced.skeleton, edges)
    away = cKDTree(near[np.isfinite(near).all(axis=1)].reshape(-1, 2)).query(resample(np.array(line, float), 2.0))[0]
    return float((away <= within).mean())


@pytest.mark.parametrize("beside", [0.0, -3.0, 4.0])
def test_the_root_is_the_trunk_s_middle_where_the_first_stroke_begins(beside: float) -> None:
    traced = trace(stroked([(STEM[0][0] + beside, STEM[0][1]), STEM[1]]))
    assert traced.skeleton.points[0, 0] == pytest.approx(STEM[0][0], abs=1.0)
    assert traced.skeleton.points[0, 1] == STEM[0][1]
    assert (traced.stroke[0], traced.skeleton.parents[0]) == (0, -1)


@pytest.mark.parametrize("beside", [-2.0, 2.0])
def test_a_trunk_leads_to_its_root_without_a_bend(beside: float) -> None:
    traced = trace(stroked([(STEM[0][0] + beside, STEM[0][1]), STEM[1]]))
    away = traced.skeleton.points[(traced.stroke == 0) & (traced.skeleton.points[:, 1] > 400)] - STEM[0]
    bends = np.abs(np.diff(away[:, 0])) / np.abs(np.diff(away[:, 1]))
    assert away[0] == pytest.approx([beside, 0.0])
    assert bends.max() < 0.6


@pytest.mark.parametrize("arm", [LEFT, RIGHT], ids=["left", "right"])
def test_an_arm_without_stroke_is_found(arm: BranchLine) -> None:
    assert covered(arm, trace(stroked(STEM))) > 0.8


def test_an_arm_with_a_stroke_is_not_found_again() -> None:
    traced = trace(stroked(STEM, LEFT))
    assert covered(LEFT, traced) < 0.2
    assert covered(RIGHT, traced) > 0.8
    assert set(traced.stroke.tolist()) == {-1, 0, 1}


@pytest.mark.parametrize("lines", [(STEM,), (STEM, LEFT), (STEM, RIGHT, LEFT), ([*STEM, LEFT[1]], RIGHT)])
def test_every_stroke_is_followed_over_its_whole_length(lines: tuple[BranchLine, ...]) -> None:
    traced = trace(stroked(*lines))
    assert [covered(line, traced, found_only=False, within=0.02 * HEIGHT) for line in lines] == [1.0] * len(lines)


def test_a_stroke_over_nothing_is_followed_too() -> None:
    lost = [(220.0, 300.0), (300.0, 280.0), (400.0, 300.0)]
    traced = trace(stroked(STEM, lost))
    assert covered(lost, traced, found_only=False, within=0.02 * HEIGHT) == 1.0
    assert not traced.measured[np.flatnonzero(traced.stroke == 1)[-1]]


def test_an_erase_stroke_drops_a_found_branch_with_its_descendants() -> None:
    twig = [(150.0, 165.0), (160.0, 50.0)]
    wood = TREE | wood_mask([(twig, 6.0)], SIZE, SIZE)
    across_left = [(160.0, 220.0), (210.0, 180.0)]
    before, after = trace(stroked(STEM), wood), trace(stroked(STEM, erase=[across_left]), wood)
    assert min(covered(LEFT, before), covered(RIGHT, before), covered(twig, before, within=9.0)) > 0.6
    assert covered(LEFT, after) < 0.35
    assert covered(twig, after, within=9.0) == 0.0
    assert covered(RIGHT, after) > 0.8


def test_an_erase_stroke_does_not_drop_a_stroked_branch() -> None:
    across_left = [(160.0, 220.0), (210.0, 180.0)]
    kept, crossed = (trace(stroked(STEM, LEFT, erase=erase)) for erase in ([], [across_left]))
    assert np.array_equal(kept.skeleton.points[kept.stroke >= 0], crossed.skeleton.points[crossed.stroke >= 0])


def test_a_foot_at_the_lower_edge_is_looked_at_only_where_the_tree_was_cut_out() -> None:
    wood = TREE[:430].copy()
    wood[421:, 210:231] = True
    photo, crown, radius = wood_photo(wood), INSIDE[:430], []
    for cut_out in (False, True):
        around = Surroundings(LEAVES, BEHIND, crown, crown, cut_out=cut_out)
        traced = trace_branches(photo, stroked(STEM), around, see_crown(photo, around, HEIGHT))
        radius.append(traced.skeleton.radii[0])
    assert radius[0] < 7.0
    assert radius[1] > 8.5


@pytest.mark.parametrize("below", [0.5, 1.5, 2.5, 4.0])
def test_a_trunk_whose_stroke_begins_just_below_the_crown_is_traced(below: float) -> None:
    assert trace(stroked([(220.0, 250.0 + below), (220.0, 100.0)])).skeleton.points[0, 1] == 250.0 + below


def test_thickness_is_measured_where_the_photo_shows_it() -> None:
    traced = trace(stroked(STEM, LEFT))
    foot = [traced.skeleton.radii[traced.stroke == number][0] for number in (0, 1)]
    assert foot == pytest.approx([6.0, 3.75], abs=0.75)


def test_slivers_of_wood_among_leaves_do_not_thin_the_trunk_below_them() -> None:
    wood = TREE & ~INSIDE | wood_mask([([(220.0, 250.0), (220.0, 60.0)], 3.0)], SIZE, SIZE)
    traced = trace(stroked([STEM[0], (220.0, 60.0)]), wood)
    below = (traced.stroke == 0) & (traced.skeleton.points[:, 1] > 260)
    assert traced.skeleton.radii[below] == pytest.approx(6.0, abs=0.75)


def test_a_given_width_is_used() -> None:
    traced = trace(stroked(STEM, width=40.0))
    radii = traced.skeleton.radii[traced.stroke == 0]
    assert radii[0] == 20.0
    assert (np.diff(radii) <= 0).all()


def test_no_branch_swells_outward_along_its_stroke() -> None:
    traced = trace(stroked(STEM, LEFT, RIGHT))
    for number in range(3):
        assert (np.diff(traced.skeleton.radii[traced.stroke == number]) <= 1e-9).all()


def test_a_later_stroke_beside_the_root_is_a_second_stem() -> None:
    second = [(229.0, 431.0), (300.0, 240.0)]
    traced = trace(stroked(STEM, second), TREE | wood_mask([(second, 8.0)], SIZE, SIZE))
    roots = np.flatnonzero(traced.skeleton.parents < 0)
    assert traced.stroke[roots].tolist() == [0, 1]


def test_the_stroked_branches_can_be_had_without_those_that_were_found() -> None:
    traced = trace(stroked(STEM, LEFT))
    alone = traced.stroked
    assert set(alone.stroke.tolist()) == {0, 1}
    assert len(alone.skeleton) == len(alone.measured) == (traced.stroke >= 0).sum()
    assert alone.skeleton.points == pytest.approx(traced.skeleton.points[traced.stroke >= 0])
    assert covered(LEFT, alone, found_only=False) > 0.8


def test_a_stroke_from_the_ground_away_from_all_others_has_a_root_of_its_own() -> None:
    second = [(290.0, 428.0), (320.0, 240.0)]
    traced = trace(stroked(STEM, second), TREE | wood_mask([(second, 8.0)], SIZE, SIZE))
    roots = np.flatnonzero(traced.skeleton.parents < 0)
    assert traced.stroke[roots].tolist() == [0, 1]
    assert traced.skeleton.points[roots[1]] == pytest.approx(second[0], abs=2.0)


@pytest.mark.parametrize("thickness", [9.0, 40.0, 150.0])
def test_a_trunk_s_thickness_is_measured_however_thick_it_is(thickness: float) -> None:
    wood = wood_mask([(STEM, thickness)], SIZE, SIZE)
    wood &= np.arange(SIZE)[:, None] < STEM[0][1]
    traced = trace(stroked(STEM), wood)
    above_ground = np.abs(traced.skeleton.points[:, 1] - 330).argmin()
    assert traced.skeleton.radii[above_ground] == pytest.approx(thickness / 2, rel=0.2)


def test_a_trunk_before_wood_of_its_colour_stays_thin() -> None:
    wood = np.zeros((SIZE, SIZE), dtype=bool)
    wood[260:430] = True
    assert trace(stroked(STEM), wood).skeleton.radii.max() < 30


def test_thickness_below_the_crown_is_not_judged_by_the_branch_s_tip_beyond_it() -> None:
    over = [(220.0, 240.0), (400.0, 150.0)]
    wood = wood_mask([(STEM, 11.0), (over, 8.0)], SIZE, SIZE)
    wood[:, 384:] &= wood_mask([(over, 3.0)], SIZE, SIZE)[:, 384:]
    traced = trace(stroked(STEM, over), wood)
    middle = np.flatnonzero((traced.stroke == 1) & (traced.skeleton.points[:, 0] < 330))
    assert traced.skeleton.radii[middle].max() == pytest.approx(4.0, abs=1.0)


def test_a_later_stroke_away_from_the_root_is_joined_to_its_parent() -> None:
    traced = trace(stroked(STEM, LEFT, [(140.0, 152.0), (50.0, 150.0)]))
    assert np.count_nonzero(traced.skeleton.parents < 0) == 1
    first = np.flatnonzero(traced.stroke == 2)[0]
    assert traced.stroke[traced.skeleton.parents[first]] == 1


def test_radii_and_strokes_match_the_joints() -> None:
    traced = trace(stroked(STEM, LEFT))
    assert len(traced.skeleton) == len(traced.stroke) == len(traced.measured)
    assert (traced.skeleton.radii >= TraceParams().thinnest_px * HEIGHT / 1500 * 0.999).all()


def test_the_same_photo_gives_the_same_trace() -> None:
    first, second = (trace(stroked(STEM)) for _ in range(2))
    assert np.array_equal(first.skeleton.points, second.skeleton.points)
    assert np.array_equal(first.skeleton.radii, second.skeleton.radii)


@pytest.mark.parametrize(
    "changes", [{"trunk_share": 0.0}, {"snap_share": -0.1}, {"thinnest_px": 0.0}, {"tolerance_share": -1.0}]
)
def test_parameters_out_of_range_are_refused(changes: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must be positive"):
        TraceParams(**changes)
