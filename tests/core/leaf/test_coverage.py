"""What cards hide of a foliage: as much as they cover, at every size."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from tests.core.leaf.conftest import view_of

from treestroke.core.geometry.vectors import unit
from treestroke.core.leaf.cards import cards
from treestroke.core.leaf.coverage import Outlines, cover, newly_hidden, outlines_of, share_inside
from treestroke.core.leaf.grid import FoliageGrid, foliage_grid
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.paint.atlas import Atlas

MIDDLE = np.array([0.0, 6.65, 0.0])


@pytest.fixture(scope="module")
def grid(photo, mask, volume) -> FoliageGrid:
    return foliage_grid(view_of(photo, mask, volume.camera), volume.bounds.mean(axis=0))


@pytest.fixture(scope="module")
def outlines() -> Outlines:
    """Of two tiles: one whose right half is drawn, and one that is half transparent everywhere."""
    alphas = np.zeros((2, 64, 64), np.uint8)
    alphas[0, :, 32:], alphas[1] = 255, 128
    return outlines_of(alphas)


def card(half_m: float, at: np.ndarray = MIDDLE, turn: float = 0.6) -> Leaves:
    """A card that faces the viewer, turned in its plane, with the first tile."""
    right, up = np.array([np.cos(turn), np.sin(turn), 0.0]), np.array([-np.sin(turn), np.cos(turn), 0.0])
    one = np.zeros(1, np.int64)
    return Leaves(at[None], half_m * right[None], half_m * up[None], one, one > 0, np.ones(1), one)


def hidden(cards: Leaves, outlines: Outlines, grid: FoliageGrid) -> np.ndarray:
    nearest = np.full(grid.inside.size, np.inf, dtype=np.float32)
    cover(nearest, cards, outlines, grid)
    return np.isfinite(nearest)


@pytest.mark.parametrize("half_m", [0.02, 0.05, 0.15, 0.25])
def test_a_card_hides_the_area_that_is_drawn(half_m, outlines, grid):
    drawn_cells = 2 * half_m**2 / grid.cell_m**2
    assert hidden(card(half_m), outlines, grid).sum() == pytest.approx(drawn_cells, rel=0.3, abs=3)


def test_a_flipped_card_hides_the_other_half(outlines, grid):
    plain = card(0.3)
    both = hidden(plain, outlines, grid) & hidden(replace(plain, flips=~plain.flips), outlines, grid)
    assert both.sum() < 0.2 * hidden(plain, outlines, grid).sum()


def test_half_transparent_tiles_count_by_their_densest_parts(outlines):
    assert all(len(lattice[1]) > 0 for lattice in outlines.dots)


def test_shares_tell_cards_inside_from_those_at_the_edge_and_beside(outlines, grid):
    edge, beside = MIDDLE + np.array([[3.25, 0, 0], [6.0, 0, 0]])
    inside, half, none = (share_inside(card(0.2, at), outlines, grid)[0] for at in (MIDDLE, edge, beside))
    assert inside == 1
    assert 0.1 < half < 0.9
    assert none == 0


def test_what_is_covered_is_not_hidden_anew(outlines, grid):
    nearest = np.full(grid.inside.size, np.inf, dtype=np.float32)
    assert newly_hidden(nearest, card(0.2), outlines, grid)[0][0] == 1
    cover(nearest, card(0.2), outlines, grid)
    assert newly_hidden(nearest, card(0.2), outlines, grid)[0][0] < 0.2


def test_the_nearest_card_counts(outlines, grid):
    nearest = np.full(grid.inside.size, np.inf, dtype=np.float32)
    for away in (0.0, 0.5, -0.3):
        cover(nearest, card(0.2, MIDDLE + np.array([0.0, 0.0, away])), outlines, grid)
    depths = grid.camera.depth(np.array([MIDDLE, MIDDLE + np.array([0.0, 0.0, 0.5])]))
    assert nearest[np.isfinite(nearest)] == pytest.approx(depths.min())


def test_a_column_is_as_broad_as_a_square_of_its_area(photo, mask, volume, grid):
    column = np.zeros_like(mask)
    column[40:340, 140:160] = True
    narrow = foliage_grid(view_of(photo, column, volume.camera), volume.bounds.mean(axis=0))
    metres = volume.camera.metres_from_pixels
    assert narrow.breadth_m == pytest.approx(float(metres(np.sqrt(column.sum()))), rel=0.02)
    across = np.count_nonzero(mask.any(axis=0))
    assert grid.breadth_m == pytest.approx(float(metres(float(across))), rel=0.02)


def test_a_folded_card_is_seen_from_its_edge(outlines, grid):
    across = card(0.2)
    edge_on = replace(across, rights=0.2 * np.array([[0.0, 0.0, -1.0]]), ups=0.2 * np.array([[0.0, 1.0, 0.0]]))
    flat, folded = (hidden(edge_on, replace(outlines, fold=fold), grid).sum() for fold in (0.0, 0.5))
    assert folded > 4 * flat


@pytest.mark.parametrize("flip", [False, True])
def test_cells_of_a_folded_card_are_those_of_its_triangles(flip, grid):
    tilted = replace(card(0.3), flips=np.array([flip]), rights=np.array([[0.2, 0.1, 0.2]]))
    tilted = replace(tilted, ups=0.3 * unit(np.cross([[0.3, 0.2, 1.0]], tilted.rights)))
    full = outlines_of(np.full((1, 64, 64), 255, np.uint8), fold=0.5)
    flat_atlas = Atlas(np.zeros((2, 2, 4), np.uint8), np.array([[0.0, 0, 1, 1]]), np.zeros((1, 3)), fold=0.5)
    mesh = cards(tilted, flat_atlas)
    drawn = np.zeros(grid.inside.shape, np.uint8)
    for triangle in mesh.triangles:
        corners = grid.positions_of(mesh.positions[triangle].astype(float))
        cv2.fillPoly(drawn, [np.floor(corners).astype(np.int32)], 1)
    found = hidden(tilted, full, grid).reshape(drawn.shape)
    assert (found & (drawn > 0)).sum() > 0.85 * (found | (drawn > 0)).sum()
