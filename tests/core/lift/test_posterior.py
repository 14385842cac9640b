"""Tests of lifting by the posterior."""

import numpy as np
import pytest
from tests.builders import oak

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import turned_outline
from treestroke.core.lift.posterior import PosteriorParams, lift_by_posterior
from treestroke.core.lift.spread import FrontCrown, FrontTree
from treestroke.core.pipeline.crowns import seen_from_front
from treestroke.core.skeleton.skeleton import Skeleton

TREE = oak(orders=3, seed=5)
HEIGHT = float(np.ptp(TREE.points[:, 1]))
CAMERA = OrthographicCamera(240, 200, HEIGHT / 170, (120.0, 190.0))


def crown() -> FrontCrown:
    rows, columns = np.mgrid[:200, :240]
    mask = np.hypot((columns - 120) / 110, (rows - 90) / 85) <= 1
    return FrontCrown(turned_outline(Silhouette(mask, CAMERA)), CAMERA)


def front(before_leaves: bool = False) -> FrontTree:
    flat = seen_from_front(TREE, CAMERA)
    return FrontTree(flat, np.arange(len(flat)), np.full(len(flat), before_leaves))


def lifted(seed: int = 0, before_leaves: bool = False, farthest: float = 0.2) -> Skeleton:
    params = PosteriorParams(farthest=farthest)
    return lift_by_posterior(front(before_leaves), crown(), np.random.default_rng(seed), params)


def test_every_joint_keeps_its_pixel() -> None:
    assert CAMERA.pixels_from_world(lifted().points) == pytest.approx(front().skeleton.points)


def test_limbs_leave_the_picture_s_plane_to_both_sides_and_stay_in_the_crown() -> None:
    depth = lifted().points[:, 2]
    assert depth.min() < -0.05 * HEIGHT
    assert depth.max() > 0.05 * HEIGHT
    assert np.abs(depth).max() <= crown().volume.widest


def test_what_is_seen_before_leaves_does_not_go_back() -> None:
    assert (lifted(before_leaves=True).points[:, 2] >= -1e-9).all()


def test_without_a_push_the_tree_stays_flat() -> None:
    assert np.abs(lifted(farthest=0.0).points[:, 2]).max() == 0


def test_parameters_out_of_range_are_refused() -> None:
    with pytest.raises(ValueError, match="share of the depth"):
        PosteriorParams(inside=2.0)


def test_lifting_is_the_same_for_the_same_seed() -> None:
    assert np.array_equal(lifted(3).points, lifted(3).points)
