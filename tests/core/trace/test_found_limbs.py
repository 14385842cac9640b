"""A drawn Y, of which just the stem is known: the arms are found, and limbs behind leaves go on."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.pictures import disc, wood_mask

from treestroke.core.geometry.polyline import resample
from treestroke.core.trace.crown_picture import CrownPicture, Window
from treestroke.core.trace.found_limbs import find_limbs
from treestroke.core.trace.skeleton_builder import SkeletonBuilder

STEM = [(200.0, 390.0), (200.0, 220.0)]
LEFT, RIGHT = [(200.0, 220.0), (110.0, 60.0)], [(200.0, 220.0), (290.0, 60.0)]
EVERYWHERE = np.ones((400, 400), dtype=bool)
Line = list[tuple[float, float]]


def traced(wood: np.ndarray, foliage: np.ndarray = EVERYWHERE, crown: np.ndarray = EVERYWHERE) -> SkeletonBuilder:
    """Follow the stem and look for limbs."""
    builder = SkeletonBuilder()
    builder.add_chain(-1, resample(np.array(STEM), 4.0), 8.0, stroke=0)
    odds = np.where(wood, 3.0, -3.0).astype(np.float32)
    smooth = np.asarray(cv2.GaussianBlur(odds, (0, 0), 0.7))
    picture = CrownPicture(Window((0, 0), (400, 400), 1.0), crown, foliage, 380.0, None)
    seen = find_limbs(builder, picture, odds, smooth, 0.5)
    assert not (seen & (cv2.dilate(wood.astype(np.uint8), np.ones((3, 3))) == 0)).any()
    return builder


def covered(line: Line, builder: SkeletonBuilder, within: float = 3.0) -> float:
    """Share of a line with a found joint's edge near it."""
    found = [resample(np.stack([builder.points[p], builder.points[j]]), 1.0) for j, p in enumerate(builder.parents)]
    near = np.concatenate(
        [piece for piece, stroke in zip(found, builder.stroke, strict=True) if stroke < 0] or [[[0, 0]]]
    )
    places = resample(np.array(line), 2.0)
    return float((np.linalg.norm(places[:, None] - near, axis=-1).min(axis=1) <= within).mean())


@pytest.mark.parametrize("arm", [LEFT, RIGHT], ids=["left", "right"])
def test_an_arm_without_stroke_is_found(arm: Line) -> None:
    assert covered(arm, traced(wood_mask([(STEM, 16.0), (arm, 11.0)], 400, 400))) > 0.85


def test_both_arms_of_a_fork_are_found_with_their_thickness() -> None:
    builder = traced(wood_mask([(STEM, 16.0), (LEFT, 11.0), (RIGHT, 11.0)], 400, 400))
    found = np.array(builder.radii)[np.array(builder.stroke) < 0]
    assert min(covered(LEFT, builder), covered(RIGHT, builder)) > 0.85
    assert np.median(found) == pytest.approx(5.5, abs=1.0)


def test_a_fork_behind_a_fork_is_found() -> None:
    twig = [(145.0, 122.0), (150.0, 30.0)]
    builder = traced(wood_mask([(STEM, 16.0), (LEFT, 11.0), (twig, 3.0)], 400, 400))
    assert covered(twig, builder) > 0.85


def test_found_limbs_grow_from_the_stem_and_get_no_thicker_outward() -> None:
    twig = [(145.0, 122.0), (150.0, 30.0)]
    tree = traced(wood_mask([(STEM, 16.0), (LEFT, 11.0), (RIGHT, 9.0), (twig, 5.0)], 400, 400)).skeleton()
    assert np.count_nonzero(tree.parents < 0) == 1
    assert (tree.radii[1:] <= tree.radii[tree.parents[1:]] + 1e-9).all()


@pytest.mark.parametrize("centre", [(200.0, 180.0), (240.0, 260.0)])
def test_a_blob_like_dark_leaves_is_not_a_branch(centre: tuple[float, float]) -> None:
    wood = wood_mask([(STEM, 16.0)], 400, 400) | disc(400, 50, centre)
    assert min(traced(wood).stroke) == 0


def test_a_bump_of_the_bark_is_no_branch() -> None:
    assert min(traced(wood_mask([(STEM, 16.0), ([(200.0, 300.0), (213.0, 297.0)], 8.0)], 400, 400)).stroke) == 0


def test_a_limb_goes_on_behind_leaves_between_two_places_where_it_is_seen() -> None:
    wood = wood_mask([(STEM, 16.0), (LEFT, 11.0)], 400, 400)
    wood[120:160] = False
    builder = traced(wood)
    assert covered(LEFT, builder, within=5.0) > 0.85
    assert np.count_nonzero(builder.skeleton().parents < 0) == 1


@given(st.floats(-130, 130), st.floats(0.3, 0.6), st.floats(8, 16), st.floats(6, 12))
@settings(max_examples=50, deadline=None)
def test_a_limb_that_a_clump_of_leaves_hides_in_its_middle_is_one_limb_and_not_two(
    aside: float, where: float, radius: float, width: float
) -> None:
    limb = [(200.0, 220.0), (200.0 + aside, 60.0)]
    clump = disc(400, radius, (200.0 + where * aside, 220.0 - 160 * where))
    tree = traced(wood_mask([(STEM, 16.0), (limb, width)], 400, 400) & ~clump).skeleton()
    line = resample(np.array(limb), 1.0)
    way = [int(np.linalg.norm(tree.points - limb[1], axis=1).argmin())]
    while tree.parents[way[-1]] >= 0:
        way.append(int(tree.parents[way[-1]]))
    assert tree.points[way[0], 1] < 75
    crown = tree.points[tree.points[:, 1] < 215]  # every joint there lies on that limb
    assert np.linalg.norm(crown[:, None] - line, axis=2).min(axis=1).max() < 10.0
    assert np.count_nonzero(np.diff(tree.points[way, 1]) < -3) == 0  # and the limb nowhere turns back


def test_no_limb_goes_far_beyond_leaves_to_a_mere_speck() -> None:
    wood = wood_mask([(STEM, 16.0), ([(165.0, 190.0), (160.0, 181.0)], 3.0)], 400, 400)
    assert min(traced(wood).stroke) == 0


@pytest.mark.parametrize("before_sky", [True, False])
def test_a_gap_of_sky_is_gone_round_where_leaves_hide_a_way(before_sky: bool) -> None:
    beyond = [(238.0, 207.0), (340.0, 130.0)]
    wood = wood_mask([(STEM, 16.0), (LEFT, 11.0), (RIGHT, 11.0), (beyond, 6.0)], 400, 400)
    sky = np.zeros_like(wood)
    sky[206:330, 212:400] = before_sky
    builder = traced(wood, foliage=~sky | wood)
    assert covered(beyond, builder) > 0.8
    hidden = [y for x, y in builder.points if 212 < x < 234 and y > 180]
    assert max(hidden) < 206 if before_sky else max(hidden) > 210


def test_limbs_far_from_all_that_is_traced_are_not_reached() -> None:
    wood = wood_mask([(STEM, 16.0), ([(300.0, 250.0), (390.0, 100.0)], 10.0)], 400, 400)
    assert min(traced(wood).stroke) == 0


def test_nothing_is_found_below_the_crown() -> None:
    crown = EVERYWHERE.copy()
    crown[200:] = False
    root, limb = [(200.0, 380.0), (320.0, 385.0)], [(200.0, 250.0), (300.0, 120.0)]
    builder = traced(wood_mask([(STEM, 16.0), (root, 9.0), (limb, 9.0)], 400, 400), crown=crown)
    assert covered(root, builder) == 0.0
    assert covered(limb, builder) > 0.55


@pytest.mark.parametrize("wood", [np.zeros((400, 400), dtype=bool), EVERYWHERE])
def test_nothing_is_found_where_all_is_alike(wood: np.ndarray) -> None:
    assert min(traced(wood).stroke) == 0


def test_a_crown_at_the_photo_s_edge_is_cut_there() -> None:
    limb = [(200.0, 220.0), (0.0, 20.0)]
    assert covered(limb, traced(wood_mask([(STEM, 16.0), (limb, 9.0)], 400, 400))) > 0.85


def test_a_limb_leaves_the_stem_forward() -> None:
    away = [(230.0, 330.0), (300.0, 270.0)]
    tree = traced(wood_mask([(STEM, 16.0), (away, 7.0)], 400, 400)).skeleton()
    leaves = int(np.flatnonzero((np.array(tree.parents) >= 0) & (tree.points[:, 0] > 203))[0])
    assert tree.points[tree.parents[leaves], 1] > 325
