import numpy as np
from tests.core.grow.crowns import Case, trunk_case

from treestroke.core.grow.grown import Grown
from treestroke.core.grow.palm import FRONDS, PIECES, grow_palm, is_forked
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import child_counts
from treestroke.core.types import Floats

CASE = trunk_case(top=180.0)


def palm(case: Case = CASE, rounds: int = 300, seed: int = 0) -> Grown:
    return grow_palm(case.skeleton, case.crown, rounds, np.random.default_rng(seed))


def fronds(tree: Grown, skeleton: Skeleton = CASE.skeleton) -> Floats:
    """The fronds' joints (f, PIECES, 3), from the stem's top on."""
    return tree.skeleton.points[len(skeleton) :].reshape(-1, PIECES, 3)


def forked() -> Skeleton:
    """The stem, which forks at half its height into two of the same length."""
    stem = CASE.skeleton
    half = len(stem) // 2
    arm = stem.points[half + 1 :] + np.linspace(0, 1, len(stem) - half - 1)[:, None] * np.array([1.2, -0.3, 0.0])
    parents = np.append(half, np.arange(len(stem), len(stem) + len(arm) - 1))
    radii = np.append(stem.radii, stem.radii[half + 1 :])
    return Skeleton(np.vstack([stem.points, arm]), radii, np.append(stem.parents, parents))


def test_a_palm_has_one_stem_and_every_frond_leaves_its_top() -> None:
    tree = palm().skeleton
    counts = child_counts(tree)
    assert np.flatnonzero(counts > 1).tolist() == [len(CASE.skeleton) - 1]
    assert 0.9 * FRONDS <= counts.max() <= FRONDS
    np.testing.assert_array_equal(tree.points[: len(CASE.skeleton)], CASE.skeleton.points)


def test_fronds_point_to_all_sides_and_bend_down() -> None:
    found = fronds(palm())
    way = found[:, -1] - CASE.skeleton.points[-1]
    sectors = np.histogram(np.arctan2(way[:, 2], way[:, 0]), 6, (-np.pi, np.pi))[0]
    assert sectors.min() >= 3
    first, last = found[:, 1] - found[:, 0], found[:, -1] - found[:, -2]
    assert (last[:, 1] <= first[:, 1] + 1e-9).all()


def test_fronds_fill_the_outline_and_stay_in_the_crown() -> None:
    found = fronds(palm())
    outer = found[:, PIECES // 2 :].reshape(-1, 3)
    cells = np.floor(CASE.camera.pixels_from_world(outer)).astype(int)
    assert CASE.mask[cells[:, 1], cells[:, 0]].all()
    assert CASE.volume.reach(outer).max() <= 1.0
    rows, columns = np.nonzero(CASE.mask[::8, ::8])
    joints = CASE.camera.pixels_from_world(found.reshape(-1, 3))
    away = np.linalg.norm(8 * np.stack([columns, rows], axis=1)[:, None] - joints, axis=2).min(axis=1)
    assert np.quantile(away, 0.9) < 25


def test_a_frond_grows_in_each_round() -> None:
    assert len(fronds(palm(rounds=7))) == 7
    assert len(palm(rounds=0).skeleton) == len(CASE.skeleton)


def test_midribs_taper_and_are_thinner_than_the_stem() -> None:
    tree = palm().skeleton
    radii = tree.radii[len(CASE.skeleton) :].reshape(-1, PIECES)
    assert (np.diff(radii, axis=1) < 0).all()
    assert radii.max() < 0.5 * CASE.skeleton.radii[-1]


def test_the_same_seed_grows_the_same_palm_and_another_seed_another() -> None:
    first, second, other = (palm(seed=seed).skeleton.points for seed in (0, 0, 1))
    assert first.tobytes() == second.tobytes() != other.tobytes()


def test_a_stem_of_unknown_radius_takes_that_of_its_parent() -> None:
    stem = CASE.skeleton
    unknown = Skeleton(stem.points, np.where(np.arange(len(stem)) > 9, 0.0, stem.radii), stem.parents)
    assert palm(CASE._replace(skeleton=unknown)).skeleton.radii[len(stem) - 1] == stem.radii[9]


def test_stems_that_fork_bear_a_crown_each_and_count_as_forked() -> None:
    skeleton = forked()
    tree = palm(CASE._replace(skeleton=skeleton))
    assert np.flatnonzero(child_counts(tree.skeleton) > 5).tolist() == [len(CASE.skeleton) - 1, len(skeleton) - 1]
    assert is_forked(tree)
    assert not is_forked(palm())
