import numpy as np
import pytest
from tests.core.leaf.conftest import view_of

from treestroke.core.appearance import Appearance
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.grow.palm import PIECES, grow_palm
from treestroke.core.grow.replacement import CrownToFill
from treestroke.core.leaf.fronds import BARE_FOOT, set_fronds
from treestroke.core.leaf.leaf_crown import leaf_crown
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.leaf.placement import LeafParams, place_leaves
from treestroke.core.skeleton.skeleton import Skeleton


@pytest.fixture(scope="module")
def palm(mask, volume) -> Skeleton:
    y = np.linspace(0, volume.bounds[:, 1].mean(), 40)
    stem = Skeleton(np.column_stack([0 * y, y, 0 * y]), np.full(40, 0.15), np.arange(40) - 1)
    return grow_palm(stem, CrownToFill(volume, Silhouette(mask, volume.camera)), 40, np.random.default_rng(0)).skeleton


@pytest.fixture(scope="module")
def crown(mask, volume, photo, atlas):
    return leaf_crown(
        Appearance((view_of(photo, mask, volume.camera),), True), volume, atlas, 1.0, np.random.default_rng(0)
    )


@pytest.fixture(scope="module")
def leaves(palm, crown) -> Leaves:
    return set_fronds(palm, crown, 1.0, np.random.default_rng(0))


def test_leaflets_stand_aside_from_both_sides_of_their_midribs(palm: Skeleton, leaves: Leaves) -> None:
    assert (leaves.joints >= 40).all()
    way = palm.points[leaves.joints] - palm.points[palm.parents[leaves.joints]]
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    rights, ups = (side / np.linalg.norm(side, axis=1, keepdims=True) for side in (leaves.rights, leaves.ups))
    assert np.abs((way * rights).sum(axis=1)).min() > 0.99
    side = (np.cross(way, [0.0, 1.0, 0.0]) * ups).sum(axis=1)
    np.testing.assert_array_equal(leaves.flips, (way * rights).sum(axis=1) < 0)
    assert 0.4 < (side > 0).mean() < 0.6
    feet, ends = leaves.centres - leaves.ups, palm.points[leaves.joints]
    assert np.linalg.norm(np.cross(feet - ends, way), axis=1).max() < 1e-6


def test_leaflets_hang_from_level_midribs(palm: Skeleton, leaves: Leaves) -> None:
    way = palm.points[leaves.joints] - palm.points[palm.parents[leaves.joints]]
    level = np.abs(way[:, 1]) < 0.3 * np.linalg.norm(way, axis=1)
    ups = leaves.ups[level] / np.linalg.norm(leaves.ups[level], axis=1, keepdims=True)
    assert level.sum() > 100
    assert ups[:, 1].mean() < -0.15


def test_a_frond_has_one_colour_and_not_all_have_the_same(leaves: Leaves) -> None:
    frond = (leaves.joints - 40) // PIECES
    assert all(len(np.unique(leaves.tiles[frond == number])) == 1 for number in np.unique(frond))
    assert len(np.unique(leaves.tiles)) > 1


def test_leaflets_are_short_at_both_ends_of_a_frond(leaves: Leaves) -> None:
    place, size = (leaves.joints - 40) % PIECES, np.linalg.norm(leaves.ups, axis=1)
    middle = np.median(size[(place > 2) & (place < 7)])
    assert np.median(size[place == PIECES - 1]) < 0.75 * middle
    assert np.median(size[place == 1]) < middle
    assert 0 < BARE_FOOT < 0.25


def test_a_palm_bears_fronds_and_half_the_density_half_as_many(palm: Skeleton, crown, leaves: Leaves) -> None:
    half = place_leaves(palm, crown, LeafParams(0.5, kind="palm"), np.random.default_rng(0))
    assert len(half) == pytest.approx(len(leaves) / 2, rel=0.05)
