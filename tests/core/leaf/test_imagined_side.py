"""Leaves know the side that no picture shows, as it is imagined."""

import cv2
import numpy as np
import pytest
from tests.core.leaf.conftest import view_of

from treestroke.core.appearance import Appearance
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.leaf.grid import foliage_grid, side_grid
from treestroke.core.leaf.leaf_crown import LeafCrown, leaf_crown
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.leaf.placement import LeafParams, place_leaves

GAP_PX = (190, 130)


@pytest.fixture(scope="module")
def side(mask, camera) -> Silhouette:
    """The front's outline, as the side's, with a gap beside the stem."""
    left = camera.to_the_left(camera.width / 2)
    gap = cv2.circle(np.zeros(mask.shape, np.uint8), GAP_PX, 30, 1, -1) > 0
    return Silhouette(mask & ~gap, left)


@pytest.fixture(scope="module")
def with_side(tree, mask, volume, photo, atlas, side) -> tuple[LeafCrown, Leaves]:
    view, rng = view_of(photo, mask, volume.camera), np.random.default_rng(0)
    crown = leaf_crown(Appearance((view,), True, (side,)), volume, atlas, 1.0, rng)
    return crown, place_leaves(tree, crown, LeafParams(), rng)


def covered(crown: LeafCrown, leaves: Leaves) -> np.ndarray:
    grid = crown.imagined_sides[0]
    nearest = np.full(grid.inside.size, np.inf, dtype=np.float32)
    crown.hide(nearest, leaves, grid)
    return np.isfinite(nearest).reshape(grid.inside.shape)


def test_what_the_side_shows_is_covered(with_side) -> None:
    crown, leaves = with_side
    inside = crown.imagined_sides[0].inside
    assert covered(crown, leaves)[inside].mean() > 0.85


def test_leaves_keep_out_of_its_gaps(tree, mask, volume, photo, atlas, with_side) -> None:
    crown, leaves = with_side
    grid = crown.imagined_sides[0]
    middles_px = grid.pixels_of(np.arange(grid.inside.size), np.full((grid.inside.size, 2), 0.5))
    gap = (np.hypot(*(middles_px - GAP_PX).T) < 25).reshape(grid.inside.shape)
    view, rng = view_of(photo, mask, volume.camera), np.random.default_rng(0)
    without = place_leaves(tree, leaf_crown(Appearance((view,), True), volume, atlas, 1.0, rng), LeafParams(), rng)
    assert covered(crown, leaves)[gap].mean() < 0.3 * covered(crown, without)[gap].mean()


def test_the_front_stays_covered(with_side) -> None:
    crown, leaves = with_side
    nearest = np.full(crown.grids[0].inside.size, np.inf, dtype=np.float32)
    crown.hide(nearest, leaves, crown.grids[0])
    assert np.isfinite(nearest)[crown.grids[0].inside.ravel()].mean() > 0.93


def test_its_grid_has_the_fronts_cells_and_no_colours(mask, volume, photo, side) -> None:
    front = foliage_grid(view_of(photo, mask, volume.camera), volume.bounds.mean(axis=0))
    grid = side_grid(side, front)
    assert (grid.step_px, grid.cell_m, len(grid.labs)) == (front.step_px, front.cell_m, 0)
    points = side.camera.world_from_pixels(np.argwhere(side.mask)[:, ::-1] + 0.5)
    assert grid.inside.ravel()[grid.cells_of(points)].mean() > 0.99


def test_an_empty_side_has_no_grid(mask, volume, photo, side) -> None:
    front = foliage_grid(view_of(photo, mask, volume.camera), volume.bounds.mean(axis=0))
    with pytest.raises(ValueError, match="shows foliage"):
        side_grid(Silhouette(np.zeros_like(side.mask), side.camera), front)
