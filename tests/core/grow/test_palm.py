import cv2
import numpy as np
from tests.core.grow.crowns import Case, trunk_case

from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import turned_outline
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
    assert CASE.mask[cells[:, 1], cells[:, 0]].mean() > 0.97
    assert np.quantile(CASE.volume.reach(outer), 0.95) <= 1.0
    rows, columns = np.nonzero(CASE.mask[::8, ::8])
    joints = CASE.camera.pixels_from_world(found.reshape(-1, 3))
    away = np.linalg.norm(8 * np.stack([columns, rows], axis=1)[:, None] - joints, axis=2).min(axis=1)
    assert np.quantile(away, 0.9) < 25


def fingers(*rises_deg: float) -> Case:
    """A crown of straight fronds, 110 px long and 16 px broad, that leave a stem at row 180 and rise so."""
    mask = np.zeros(CASE.mask.shape, dtype=np.uint8)
    for rise in np.radians(rises_deg):
        tip = (round(160 + 110 * np.cos(rise)), round(180 - 110 * np.sin(rise)))
        cv2.line(mask, (160, 180), tip, 1, 16)
    shown = mask > 0
    return CASE._replace(mask=shown, volume=turned_outline(Silhouette(shown, CASE.camera)))


def test_fronds_lie_on_those_that_the_photo_shows() -> None:
    rises = np.array([80.0, 30.0, -20.0, 110.0, 150.0, 200.0])
    found = fronds(palm(fingers(*rises)))
    ends = found[: len(rises), -1] - CASE.skeleton.points[-1]
    turned = np.degrees(np.arctan2(ends[:, 1], ends[:, 0]))
    away = np.abs((turned[:, None] - rises + 180) % 360 - 180)
    assert away.min(axis=1).max() < 12
    assert len(np.unique(away.argmin(axis=1))) >= 5
    np.testing.assert_allclose(np.hypot(ends[:, 0], ends[:, 1]), 110 * 0.02, rtol=0.2)


def test_measured_fronds_point_toward_the_viewer_and_away_too() -> None:
    depth = fronds(palm())[:, -1, 2]
    assert depth.max() > 1.0
    assert depth.min() < -1.0


def test_fronds_leave_a_stem_that_was_drawn_too_far_where_they_meet() -> None:
    case = fingers(80.0, 30.0, -20.0, -60.0, 110.0, 150.0, 200.0, 240.0)
    tall = trunk_case(top=80.0).skeleton
    tree = palm(case._replace(skeleton=tall)).skeleton
    foot = int(np.argmax(child_counts(tree)))
    row = case.camera.pixels_from_world(tree.points[[foot]])[0, 1]
    assert abs(row - 180) < 15
    np.testing.assert_array_equal(tree.points[: len(tall)], tall.points)
    assert tree.radii[foot + 1 : len(tall)].max() < 0.3 * tree.radii[foot]


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
