from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
from tests.core.grow.crowns import Case, limbed_case, trunk_case

from treestroke.core.grow.grown import Grown
from treestroke.core.grow.library import TYPE_1, TYPE_2, choose_library, visible_subtrees
from treestroke.core.grow.params import GrowthParams, growth_for
from treestroke.core.grow.replacement import Replacement, grow
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.traverse import child_counts
from treestroke.core.types import Floats, FoliageKind

USUAL = Replacement(TYPE_1, GrowthParams())


def grown(case: Case, params: GrowthParams | None = None, kind: FoliageKind = "leaves", seed: int = 0) -> Grown:
    library = choose_library("auto", kind, case.skeleton)
    params = params or growth_for(kind, 60)
    return grow(case.skeleton, case.crown, Replacement(library, params), np.random.default_rng(seed))


def new_points(case: Case, tree: Grown) -> Floats:
    return tree.skeleton.points[tree.born > 0]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("case", [trunk_case(), limbed_case()], ids=["trunk", "limbs"])
def test_every_new_joint_projects_into_the_foliage_and_lies_in_the_volume(case: Case, seed: int) -> None:
    points = new_points(case, grown(case, seed=seed))
    cells = np.floor(case.camera.pixels_from_world(points)).astype(int)
    assert case.mask[cells[:, 1], cells[:, 0]].all()
    assert np.quantile(case.volume.reach(points), 0.999) <= 1.0
    assert case.volume.reach(points).max() <= 1.05


def test_the_same_seed_grows_the_same_bytes() -> None:
    first, second = (grown(limbed_case(), seed=7) for _ in range(2))
    assert first.skeleton.points.tobytes() == second.skeleton.points.tobytes()
    assert first.skeleton.radii.tobytes() == second.skeleton.radii.tobytes()
    assert (first.choices == second.choices).all()


def test_another_seed_grows_another_tree() -> None:
    first, second = (grown(limbed_case(), seed=seed) for seed in (0, 1))
    assert first.choices.tolist() != second.choices.tolist()


def test_visible_joints_stay_where_they_are() -> None:
    case = limbed_case()
    rows = {tuple(point) for point in grown(case).skeleton.points.round(9).tolist()}
    assert all(tuple(point) in rows for point in case.skeleton.points.round(9).tolist())


def test_no_iterations_keep_the_visible_tree() -> None:
    case = limbed_case()
    tree = grown(case, GrowthParams(0))
    np.testing.assert_allclose(tree.skeleton.points, case.skeleton.points, atol=1e-12)
    assert tree.choices.shape == (0, 3)
    assert (tree.born == 0).all()


def test_each_branch_is_replaced_once() -> None:
    branches = grown(trunk_case(), GrowthParams(150)).choices[:, 0]
    assert len(branches) > 100
    assert len(np.unique(branches)) == len(branches)


def test_a_trunk_alone_fills_the_crown_from_all_sides() -> None:
    tree = grown(trunk_case(), GrowthParams(300))
    x, _, z = new_points(trunk_case(), tree).T
    spread = [np.ptp(np.quantile(axis, [0.02, 0.98])) for axis in (x, z)]
    sectors = np.histogram(np.arctan2(z, x), 8, (-np.pi, np.pi))[0]
    assert tree.attractors_reached >= 0.9
    assert 0.85 <= spread[1] / spread[0] <= 1.1
    assert sectors.min() / sectors.max() >= 0.35


def depth_over_width(case: Case, mode: Literal["image", "alternating"]) -> float:
    """Grow with nothing but the visible tree's own subtrees, free to point anywhere: mean spread of four seeds."""
    library, found = visible_subtrees(case.skeleton), []
    params = GrowthParams(60, mode=mode, stem_piece=0.2, inward_cosine=0.0)
    for seed in range(4):
        rng = np.random.default_rng(seed)
        tree = grow(case.skeleton, case.crown, Replacement(library, params), rng)
        found.append(new_points(case, tree)[:, 2].std() / new_points(case, tree)[:, 0].std())
    return float(np.mean(found))


def test_image_attractors_alone_leave_a_flat_tree_half_as_deep() -> None:
    case = limbed_case(depth_deg=0.0)
    assert depth_over_width(case, "image") < 0.6 * depth_over_width(case, "alternating")


def test_a_bare_tree_bears_several_times_more_twigs() -> None:
    counts = [
        int((child_counts(grown(limbed_case(), growth_for(kind, 40), kind).skeleton) == 0).sum())
        for kind in ("leaves", "bare")
    ]
    assert counts[1] > 3 * counts[0]


def test_a_conifer_keeps_one_leader_up_to_the_top() -> None:
    case = trunk_case(top=200.0)
    tree = grown(case, growth_for("needles", 120), "needles")
    top = case.camera.world_from_pixels(np.array([[160.0, 40.0]]))[0, 1]
    high = tree.skeleton.points[:, 1] > top - 0.1
    assert tree.skeleton.points[:, 1].max() >= top - 0.25
    stem = np.hypot(*tree.skeleton.points[:, [0, 2]].T) < 1e-6
    assert tree.skeleton.points[stem, 1].max() >= top - 0.25
    assert tree.skeleton.radii[stem].min() > 0
    assert not (high & ~stem).any() or np.hypot(*tree.skeleton.points[high][:, [0, 2]].T).max() < 1.5


def test_a_bare_tree_gets_finer_twigs() -> None:
    case = limbed_case()
    bare, leafy = (grown(case, growth_for(kind, 150), kind) for kind in ("bare", "leaves"))
    assert bare.skeleton.radii.min() < 0.8 * leafy.skeleton.radii.min()


def test_the_tree_is_one_piece_without_edges_of_no_length() -> None:
    tree = grown(limbed_case(), GrowthParams(150)).skeleton
    assert (tree.parents < 0).sum() == 1
    assert edge_lengths(tree)[1:].min() > 1e-6
    assert child_counts(tree).max() <= 8


def test_progress_ends_at_one() -> None:
    case, told = trunk_case(), []
    grow(
        case.skeleton, case.crown, Replacement(TYPE_1 + TYPE_2, GrowthParams(5)), np.random.default_rng(0),
        lambda stage, fraction: told.append((stage, fraction)),
    )  # fmt: skip
    assert told == [("grow", k / 5) for k in range(1, 6)]


def test_a_second_stem_grows_too() -> None:
    case = trunk_case()
    single = case.skeleton
    twin = type(single)(
        np.vstack([single.points, single.points + np.array([0.6, 0, 0.3])]),
        np.tile(single.radii, 2),
        np.concatenate([single.parents, np.where(single.parents < 0, -1, single.parents + len(single))]),
    )
    tree = grow(twin, case.crown, Replacement(TYPE_2, GrowthParams(40)), np.random.default_rng(0)).skeleton
    root = np.arange(len(tree))
    for joint, parent in enumerate(tree.parents.tolist()):
        root[joint] = root[parent] if parent >= 0 else joint
    assert np.unique(root, return_counts=True)[1].min() > 2 * len(single)


def test_growth_refuses_a_mask_of_another_size() -> None:
    case = trunk_case()
    cut = replace(case.crown, front=replace(case.crown.front, mask=case.mask[1:]))
    with pytest.raises(ValueError, match="does not fit the camera"):
        grow(case.skeleton, cut, USUAL, np.random.default_rng(0))


def test_growth_refuses_an_empty_crown_or_library() -> None:
    case = trunk_case()
    with pytest.raises(ValueError, match=r"a subtree, got \d+ px and 0$"):
        grow(case.skeleton, case.crown, Replacement((), GrowthParams()), np.random.default_rng(0))
    empty = replace(case.crown, front=replace(case.crown.front, mask=case.mask & False))
    with pytest.raises(ValueError, match="needs foliage .* got 0 px"):
        grow(case.skeleton, empty, USUAL, np.random.default_rng(0))


@pytest.mark.parametrize(
    "wrong", [{"iterations": -1}, {"angles": 0}, {"mode": "both"}, {"keep_share": 0.0}, {"tip_px": 0}]
)
def test_params_out_of_range_are_refused(wrong: dict) -> None:
    with pytest.raises(ValueError, match=r".+"):
        GrowthParams(**wrong)
