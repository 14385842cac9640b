from dataclasses import fields, replace

import cv2
import numpy as np
import pytest
from scipy.spatial import cKDTree
from tests.core.leaf.conftest import view_of

from treestroke.core.appearance import Appearance
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.leaf.leaf_crown import leaf_crown
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.leaf.placement import LeafParams, place_leaves
from treestroke.core.paint.atlas import tile_alphas
from treestroke.core.skeleton.traverse import child_counts

HEIGHT = 10.0


def place(scene, params=None, seed=0, leaves_from=None, size=1.0):
    tree, mask, volume, photo, atlas = scene
    view, rng = view_of(photo, mask, volume.camera, leaves_from), np.random.default_rng(seed)
    return place_leaves(
        tree, leaf_crown(Appearance((view,), True), volume, atlas, size, rng), params or LeafParams(), rng
    )


@pytest.fixture(scope="module")
def scene(tree, mask, volume, photo, atlas):
    return tree, mask, volume, photo, atlas


@pytest.fixture(scope="module")
def leaves(scene) -> Leaves:
    return place(scene)


def without_buds(leaves: Leaves, mask: np.ndarray, camera) -> Leaves:
    """Leave out the tiny cards that end a twig where no other fits."""
    return leaves.select(np.linalg.norm(leaves.ups, axis=1) > 0.002 * width_of(mask, camera))


def width_of(mask: np.ndarray, camera) -> float:
    return float(np.ptp(np.flatnonzero(mask.any(axis=0))) + 1) * camera.metres_per_pixel


def shown(leaves, atlas, camera) -> np.ndarray:
    """Draw the cards' opaque texels, 24 x 24 a tile, at twice the photo's resolution; halve by majority."""
    canvas = np.zeros((2 * camera.height, 2 * camera.width), np.uint8)
    for tile, alpha in enumerate(tile_alphas(atlas)):
        row, column = np.nonzero(cv2.resize(alpha, (24, 24), interpolation=cv2.INTER_AREA) > 127)
        part = leaves.select(leaves.tiles == tile)
        x = ((column + 0.5) / 12 - 1)[:, None] * np.where(part.flips, -1, 1)
        y = (1 - (row + 0.5) / 12)[:, None]
        points = part.centres + x[..., None] * part.rights + y[..., None] * part.ups
        pixels = (2 * camera.pixels_from_world(points.reshape(-1, 3))).astype(int)
        canvas[pixels[:, 1], pixels[:, 0]] = 1
    return cv2.resize(canvas * 255, (camera.width, camera.height), interpolation=cv2.INTER_AREA) > 127


def test_every_centre_projects_into_the_foliage(leaves, mask, camera):
    pixels = np.floor(camera.pixels_from_world(without_buds(leaves, mask, camera).centres)).astype(int)
    assert mask[pixels[:, 1], pixels[:, 0]].all()


def test_the_foliage_is_covered_and_little_else(leaves, mask, atlas, camera):
    drawn = shown(leaves, atlas, camera)
    assert (drawn & mask).sum() >= 0.95 * mask.sum()
    assert (drawn & ~mask).sum() <= 0.02 * drawn.sum()


def test_wood_that_is_seen_has_leaves_behind_it_and_none_before(scene, camera):
    leaves_from = np.where(scene[1], -np.inf, np.inf)
    leaves_from[:, 145:155][scene[1][:, 145:155]] = 0.0
    placed = without_buds(place(scene, leaves_from=leaves_from), scene[1], camera)
    column = camera.pixels_from_world(placed.centres)[:, 0]
    beside = (column > 146) & (column < 154)
    assert beside.sum() > 50
    assert (placed.centres[beside, 2] < 0).all()


def test_a_big_gap_stays_open(tree, mask, volume, photo, atlas, camera):
    gap = cv2.circle(np.zeros(mask.shape, np.uint8), (190, 130), 35, 1, -1) > 0
    drawn = shown(place((tree, mask & ~gap, volume, photo, atlas)), atlas, camera)
    assert (drawn & gap).sum() <= 0.06 * gap.sum()


def test_thin_foliage_is_covered_and_does_not_swell(tree, mask, volume, photo, atlas, camera):
    spots = cv2.GaussianBlur(np.random.default_rng(5).standard_normal(mask.shape), (0, 0), 3)
    thin = mask & (spots > np.median(spots))
    drawn = shown(place((tree, thin, volume, photo, atlas)), atlas, camera)
    assert (drawn & thin).sum() >= 0.85 * thin.sum()
    assert drawn.sum() <= 1.15 * thin.sum()


def test_foliage_that_covers_little_of_its_pixels_bears_no_leaves(tree, mask, volume, photo, atlas, camera):
    view, rng = view_of(photo, mask, camera), np.random.default_rng(0)
    faint = mask & (np.arange(300) > 150)
    view = replace(view, opacity=np.where(faint, 0.3, view.opacity).astype(np.float32))
    crown = leaf_crown(Appearance((view,), True), volume, atlas, 1.0, rng)
    drawn = shown(place_leaves(tree, crown, LeafParams(), rng), atlas, camera)
    assert (drawn & faint).sum() <= 0.03 * faint.sum()


def test_rights_and_ups_are_at_right_angles(leaves):
    assert np.abs((leaves.rights * leaves.ups).sum(axis=1)).max() < 1e-9


def test_most_sides_are_1_5_to_3_per_cent_of_the_crowns_width(leaves, mask, camera):
    share = 2 * np.linalg.norm(leaves.ups, axis=1) / width_of(mask, camera)
    assert share.max() <= 0.03
    assert (share >= 0.015).mean() >= 0.75


def test_cards_keep_to_their_branches(leaves, tree):
    steps = np.linspace(0, 1, 60)[:, None, None]
    along = tree.points[tree.parents[1:]] + steps * (tree.points[1:] - tree.points[tree.parents[1:]])
    distance = cKDTree(along.reshape(-1, 3)).query(leaves.centres)[0]
    assert np.quantile(distance, 0.95) <= 0.05 * HEIGHT
    assert distance.max() <= 0.1 * HEIGHT


def test_the_crown_is_as_deep_as_wide(leaves):
    # By area: the many small cards at the front's outline weigh little.
    area = (leaves.ups**2).sum(axis=1)
    low, high = np.percentile(leaves.centres, [2, 98], axis=0, weights=area, method="inverted_cdf")
    assert 0.8 <= (high - low)[2] / (high - low)[0] <= 1.1


def test_cards_face_out_of_the_crown(leaves):
    facing = np.cross(leaves.rights, leaves.ups)
    outward = leaves.centres - leaves.centres.mean(axis=0)
    assert ((facing * outward).sum(axis=1) > 0).mean() > 0.8


def test_the_inside_is_darker_than_the_outside(leaves, volume):
    reach = volume.reach(leaves.centres)
    assert leaves.shades[reach < 0.3].mean() < leaves.shades[reach > 0.8].mean() - 0.15
    assert leaves.shades.min() >= 0.55
    assert leaves.shades.max() <= 1


def test_the_front_takes_the_photos_colour_and_the_back_is_no_mirror(tree, mask, volume, atlas, photo):
    stripes = photo.copy()
    stripes[mask & ((np.arange(300) // 40 % 2) == 0)] = (200, 60, 30)
    two = np.where(np.arange(16)[:, None] % 2, (200.0, 60.0, 30.0), (70.0, 110.0, 40.0))
    coloured = type(atlas)(atlas.image, atlas.boxes, two)
    leaves = place((tree, mask, volume, stripes, coloured))
    pixels = volume.camera.pixels_from_world(leaves.centres).astype(int)
    agrees = (stripes[pixels[:, 1], pixels[:, 0], 0] > 140) == (leaves.tiles % 2 == 1)
    depth = leaves.centres[:, 2] / np.maximum(volume.half_depth(leaves.centres), 1e-9)
    assert agrees[depth > 0.5].mean() > 0.9
    assert agrees[depth < -0.3].mean() < 0.75


@pytest.mark.parametrize("params", [LeafParams(kind="bare"), LeafParams(density=0), LeafParams(max_cards=0)])
def test_some_trees_bear_nothing(scene, params):
    assert len(place(scene, params)) == 0


def test_a_view_without_foliage_is_refused(tree, mask, volume, photo, atlas):
    with pytest.raises(ValueError, match="shows foliage"):
        place((tree, np.zeros_like(mask), volume, photo, atlas))


@pytest.mark.parametrize("size", [0.3, 3.0])
@pytest.mark.parametrize("density", [0.3, 3.0])
def test_cards_stay_within_the_budget(scene, size, density):
    leaves = place(scene, LeafParams(density=density, max_cards=3000), size=size)
    assert 0 < len(leaves) <= 3000 + (child_counts(scene[0]) == 0).sum()


def seen_first(leaves: Leaves, across: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Indices of the cards whose middles are nearest to someone who sees ``across`` to the right."""
    toward = np.cross(across, up)
    cells = np.floor(np.stack([leaves.centres @ across, leaves.centres @ up], axis=1) / 0.25).astype(int)
    order = np.argsort(-(leaves.centres @ toward), kind="stable")
    _, first = np.unique(cells[order], axis=0, return_index=True)
    return order[first]


def test_unseen_leaves_are_light_where_the_sky_is_whatever_row_of_the_photo_is_dark(tree, mask, volume, atlas, photo):
    rows = np.flatnonzero(mask.any(axis=1))
    lower = photo.copy()
    lower[int(rows.mean()) :] = (40, 60, 20)
    lower[: int(rows.mean())] = (150, 190, 110)
    two = np.where(np.arange(16)[:, None] % 2, (190.0, 230.0, 150.0), (70.0, 100.0, 40.0))
    leaves = place((tree, mask, volume, lower, type(atlas)(atlas.image, atlas.boxes, two)))
    light = leaves.tiles % 2 == 1
    x, y, z = np.eye(3)
    front, back, above = (light[seen_first(leaves, *axes)].mean() for axes in ((x, y), (-x, y), (x, -z)))
    assert 0.4 < front < 0.7
    assert back == pytest.approx(front, abs=0.12)
    assert above > 0.75


@pytest.mark.parametrize(
    "params", [LeafParams(), LeafParams(kind="needles"), LeafParams(density=0.3), LeafParams(density=0.01)]
)
def test_every_twig_ends_in_a_leaf_or_a_bud(scene, params):
    tree, leaves = scene[0], place(scene, params)
    tips = np.flatnonzero(child_counts(tree) == 0)
    own = [leaves.select(leaves.joints == tip) for tip in tips]
    half = [np.linalg.norm(cards.ups, axis=1) for cards in own]
    away = [np.linalg.norm(cards.centres - tree.points[tip], axis=1) for cards, tip in zip(own, tips, strict=True)]
    assert all((distance <= 1.7 * side).any() for distance, side in zip(away, half, strict=True))


def test_the_fewer_the_leaves_the_more_twigs_end_in_a_bud(scene, mask, camera):
    few, many = place(scene, LeafParams(density=0.1)), place(scene)
    buds = [len(leaves) - len(without_buds(leaves, mask, camera)) for leaves in (few, many)]
    assert buds[0] > 1.5 * buds[1]


def test_density_scales_the_number_of_cards(scene, leaves):
    assert len(place(scene, LeafParams(density=0.3))) < 0.5 * len(leaves)


def test_the_same_seed_places_the_same_leaves(scene, leaves):
    again = place(scene)
    assert all(np.array_equal(getattr(again, f.name), getattr(leaves, f.name)) for f in fields(Leaves))


@pytest.mark.parametrize("size", [0.2, 3.1])
def test_sizes_out_of_range_are_refused(scene, size):
    with pytest.raises(ValueError, match="size must be 0.3 to 3"):
        place(scene, size=size)


@pytest.mark.parametrize("wrong", [{"density": 3.1}, {"max_cards": -1}, {"kind": "fruit"}])
def test_params_out_of_range_are_refused(wrong):
    with pytest.raises(ValueError, match="must"):
        LeafParams(**wrong)


@pytest.mark.parametrize("off", [0, 40])
def test_no_card_s_centre_lies_outside_a_side_that_was_drawn(scene, camera, off):
    tree, mask, volume, photo, atlas = scene
    side = np.roll(cv2.ellipse(np.zeros((400, 300), np.uint8), (150, 150), (60, 120), 0, 0, 360, 1, -1) > 0, off, 1)
    slim = volume.with_side(Silhouette(side, replace(camera, from_left=True)))
    centres = without_buds(place((tree, mask, slim, photo, atlas)), mask, camera).centres
    assert slim.admits(centres).all()
    assert np.percentile(centres[:, 2], [1, 99]) == pytest.approx([(off - 60) / 36, min(off + 60, 117) / 36], abs=0.35)


def test_no_wood_is_seen_before_the_foliage(scene, mask, volume, photo, atlas, camera):
    tree, crown = (
        scene[0],
        leaf_crown(Appearance((view_of(photo, mask, camera),), True), volume, atlas, 1.0, np.random.default_rng(0)),
    )
    grid, leaves = crown.grids[0], place(scene)
    nearest = np.full(grid.inside.size, np.inf, dtype=np.float32)
    crown.hide(nearest, leaves, grid)
    limbs = tree.points[tree.parents] + np.linspace(0, 1, 50)[:, None, None] * (tree.points - tree.points[tree.parents])
    wood, radii = limbs[:, 2:].reshape(-1, 3), np.tile(tree.radii[2:], 50)
    cells = grid.cells_of(wood)
    seen = grid.inside.ravel()[cells] & (camera.depth(wood) - radii < nearest[cells])
    assert seen.mean() < 0.1
