from dataclasses import replace

import numpy as np
import pytest
from tests.core.leaf.conftest import view_of

from treestroke.core.appearance import Appearance
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.leaf.leaf_crown import leaf_crown
from treestroke.core.leaf.placement import LeafParams, place_leaves
from treestroke.core.leaf.shown_limbs import ASIDE, shown_limbs
from treestroke.core.skeleton.skeleton import Skeleton

LIMBS = 40


@pytest.fixture(scope="module")
def spokes() -> Skeleton:
    """A stem with level limbs all around near the crown's surface, each reached from the stem by a bend."""
    turns = 2 * np.pi * np.arange(LIMBS) / LIMBS
    ring = np.stack([np.sin(turns), np.zeros(LIMBS), np.cos(turns)], axis=1)
    start, end = np.array([0.0, 6.0, 0.0]) + 2.0 * ring, np.array([0.0, 6.3, 0.0]) + 2.2 * np.roll(ring, 3, axis=0)
    points = np.vstack([[0.0, 0.0, 0.0], [0.0, 6.0, 0.0], start, end])
    radii = np.repeat([0.3, 0.2, 0.06, 0.05], [1, 1, LIMBS, LIMBS])
    return Skeleton(points, radii, np.concatenate([[-1, 0], np.full(LIMBS, 1), 2 + np.arange(LIMBS)]))


def crown_with_wood(mask, volume, photo, atlas, columns: slice):
    """The round crown, whose picture shows wood in some columns."""
    leaves_from = np.where(mask, -np.inf, np.inf)
    leaves_from[:, columns][mask[:, columns]] = 0.0
    view = view_of(photo, mask & np.isinf(leaves_from), volume.camera, leaves_from)
    return leaf_crown(Appearance((view,), True), volume, atlas, 1.0, np.random.default_rng(0))


def before(limbs, skeleton: Skeleton, joints: np.ndarray) -> np.ndarray:
    """Which edges have a place outside them, on the level ray from the axis, that is kept free."""
    middles = (skeleton.points[joints] + skeleton.points[skeleton.parents[joints]]) / 2
    return limbs.behind(middles * (1.2, 1.0, 1.2))


def test_limbs_show_at_the_sides_and_none_in_front(spokes, mask, volume, photo, atlas):
    limbs = shown_limbs(spokes, crown_with_wood(mask, volume, photo, atlas, slice(100, 200)))
    outer = np.arange(2 + LIMBS, 2 + 2 * LIMBS)
    middles = (spokes.points[outer] + spokes.points[spokes.parents[outer]]) / 2
    facing = middles[:, 2] / np.hypot(middles[:, 0], middles[:, 2])
    free = before(limbs, spokes, outer)
    assert free[facing < ASIDE - 0.1].all()
    assert not free[facing > ASIDE + 0.2].any()
    assert not limbs.behind(0.8 * middles + (0.0, 0.2 * 6.15, 0.0)).any()  # what is behind a limb stays


def test_more_wood_in_the_picture_shows_more_limbs(spokes, mask, volume, photo, atlas):
    free = [
        np.isfinite(shown_limbs(spokes, crown_with_wood(mask, volume, photo, atlas, slice(150, end))).distances).mean()
        for end in (150, 152, 158)
    ]
    assert free[0] == 0
    assert 0 < free[1] < free[2]


def test_a_crown_whose_depth_is_seen_keeps_all_its_leaves(spokes, mask, volume, photo, atlas):
    seen = volume.with_side(Silhouette(mask, replace(volume.camera, from_left=True)))
    assert seen.depth_seen
    crown = replace(crown_with_wood(mask, volume, photo, atlas, slice(100, 200)), volume=seen)
    assert not np.isfinite(shown_limbs(spokes, crown).distances).any()


def test_leaves_on_branches_keep_clear_of_them(spokes, mask, volume, photo, atlas):
    crown = crown_with_wood(mask, volume, photo, atlas, slice(145, 155))
    limbs = shown_limbs(spokes, crown)
    leaves = place_leaves(spokes, crown, LeafParams(max_cards=4000), np.random.default_rng(1))
    usual = np.linalg.norm(leaves.ups, axis=1) > 0.9 * 0.5 * 0.015 * crown.side
    free = np.isfinite(limbs.distances).mean()
    assert free > 0.01
    assert limbs.behind(leaves.centres[usual]).mean() < 0.2 * free
