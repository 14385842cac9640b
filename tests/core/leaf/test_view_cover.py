"""A tree of two balls of leaves, as four views from all around show it."""

from dataclasses import dataclass, fields

import numpy as np
import pytest

from treestroke.core.appearance import Appearance, StemPixels, View
from treestroke.core.geometry.camera import PerspectiveCamera, in_picture
from treestroke.core.geometry.outline_volume import TurnedOutline
from treestroke.core.leaf.coverage import share_inside
from treestroke.core.leaf.leaf_crown import LeafCrown, leaf_crown
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.leaf.placement import LeafParams, place_leaves
from treestroke.core.paint.atlas import leaf_atlas
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Mask

WIDTH, HEIGHT = 110, 115
BALLS = np.array([[-1.6, 4.0, 0.0], [1.6, 5.0, 0.6]])
RADIUS = 1.2


@dataclass(frozen=True, eq=False)
class TwoBalls(TurnedOutline):
    """A crown that is measured: two balls, the left one with most of the leaves."""

    @property
    def depth_seen(self) -> bool:
        return True

    def admits(self, points_world: Floats) -> Mask:
        return np.asarray((np.linalg.norm(points_world[:, None] - BALLS, axis=2) < RADIUS).any(axis=1))

    def density_at(self, points_world: Floats) -> Floats:
        return np.where(points_world[:, 0] < 0, 10.0, 0.1) * self.admits(points_world)


def view_from(azimuth: float) -> View:
    """Green before the sun's side and red on the other, from 14 m away."""
    back = np.array([np.sin(azimuth), 0.0, np.cos(azimuth)])
    turn = np.stack([np.array([back[2], 0.0, -back[0]]), [0.0, -1.0, 0.0], -back])
    pose = np.column_stack([turn, -turn @ (14 * back + [0.0, 3.5, 0.0])])
    camera = PerspectiveCamera(WIDTH, HEIGHT, pose, 220.0, (WIDTH / 2, HEIGHT / 2))
    middles, pixel = camera.pixels_from_world(BALLS), camera.pixel_size(BALLS)
    row, column = np.indices((HEIGHT, WIDTH)) + 0.5
    balls = [np.hypot(column - x, row - y) < RADIUS / size for (x, y), size in zip(middles, pixel, strict=True)]
    mask = balls[0] | balls[1]
    picture = np.full((HEIGHT, WIDTH, 3), (70, 130, 60) if back[2] > 0 else (150, 70, 50), np.uint8)
    depth = np.where(mask, -np.inf, np.inf).astype(np.float32)
    stem = StemPixels(np.zeros((2, 2)), np.zeros(2))
    return View(camera, picture, depth, mask.astype(np.float32), mask, mask, stem)


@pytest.fixture(scope="module")
def views() -> tuple[View, ...]:
    return tuple(view_from(azimuth) for azimuth in np.deg2rad(np.arange(45, 405, 90)))


@pytest.fixture(scope="module")
def tree() -> Skeleton:
    """A limb into each ball, and forty twigs there."""
    rng = np.random.default_rng(1)
    ways = rng.normal(size=(2, 40, 3))
    ends = BALLS[:, None] + 0.9 * RADIUS * ways / np.linalg.norm(ways, axis=2, keepdims=True)
    points = np.vstack([np.zeros(3), [0, 3, 0], BALLS, ends.reshape(-1, 3)])
    radii = np.repeat([0.2, 0.15, 0.06, 0.01], [1, 1, 2, 80])
    return Skeleton(points, radii, np.concatenate([[-1, 0, 1, 1], np.repeat([2, 3], 40)]))


@pytest.fixture(scope="module")
def crown(views: tuple[View, ...], volume: TurnedOutline) -> LeafCrown:
    pictures = np.hstack([view.picture for view in views])
    atlas = leaf_atlas(pictures, np.hstack([view.opacity for view in views]), "leaves", np.random.default_rng(3))
    held = TwoBalls(**{part.name: getattr(volume, part.name) for part in fields(volume)})
    return leaf_crown(Appearance(views, True), held, atlas, 3.0, np.random.default_rng(0))


@pytest.fixture(scope="module")
def leaves(crown: LeafCrown, tree: Skeleton) -> Leaves:
    return place_leaves(tree, crown, LeafParams(max_cards=2500), np.random.default_rng(0))


def test_cards_cover_the_foliage_of_every_view(crown, leaves):
    for grid in crown.grids:
        nearest = np.full(grid.inside.size, np.inf, dtype=np.float32)
        crown.hide(nearest, leaves, grid)
        covered = np.isfinite(nearest)
        assert covered[grid.inside.ravel()].mean() > 0.9
        assert covered[~grid.inside.ravel()].mean() < 0.05


def test_cards_lie_in_the_crown_and_mostly_in_the_foliage_of_every_view(crown, leaves):
    assert crown.volume.admits(leaves.centres).mean() > 0.98
    for grid in crown.grids:
        inside = share_inside(leaves, crown.outlines, grid)[in_picture(grid.camera, leaves.centres)]
        assert np.quantile(inside, 0.02) >= 0.4
        assert inside.mean() > 0.9


def test_each_side_has_the_colour_of_the_views_that_see_it(crown, leaves):
    green = crown.colouring.tile_labs[leaves.tiles, 1] < 0
    outward = leaves.centres - BALLS[(leaves.centres[:, 0] > 0).astype(int)]
    front, back = outward[:, 2] > 0.8 * RADIUS, outward[:, 2] < -0.8 * RADIUS
    assert front.sum() > 15
    assert back.sum() > 15
    assert green[front].mean() > 0.9
    assert green[back].mean() < 0.3


def test_they_hang_from_the_branches_of_their_part_of_the_crown(leaves, tree):
    ends = tree.points[leaves.joints]
    assert (np.linalg.norm(ends - leaves.centres, axis=1) < 1.8 * RADIUS).mean() > 0.98


def test_the_same_numbers_give_the_same_cards(crown, leaves, tree):
    again = place_leaves(tree, crown, LeafParams(max_cards=2500), np.random.default_rng(0))
    assert np.array_equal(again.centres, leaves.centres)
    assert np.array_equal(again.tiles, leaves.tiles)


def test_no_more_cards_are_set_than_allowed(crown, tree):
    few = place_leaves(tree, crown, LeafParams(max_cards=300), np.random.default_rng(0))
    assert len(few) <= 300 + 80
