import numpy as np
import pytest
from tests.core.leaf.conftest import view_of

from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.grow.palm import grow_palm
from treestroke.core.grow.replacement import CrownToFill
from treestroke.core.leaf.fronds import BARE_FOOT, HALF_SIDE, set_fronds
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
    return leaf_crown([view_of(photo, mask, volume.camera)], volume, atlas, 1.0, np.random.default_rng(0))


@pytest.fixture(scope="module")
def leaves(palm, crown) -> Leaves:
    return set_fronds(palm, crown, 1.0, np.random.default_rng(0))


def test_pieces_lie_on_the_midribs_along_them(palm: Skeleton, leaves: Leaves) -> None:
    assert (leaves.joints >= 40).all()
    way = palm.points[leaves.joints] - palm.points[palm.parents[leaves.joints]]
    cosines = (way * leaves.ups).sum(axis=1) / np.linalg.norm(way, axis=1) / np.linalg.norm(leaves.ups, axis=1)
    assert cosines.min() > 0.99


def test_each_frond_bears_pieces_of_one_tile(palm: Skeleton, leaves: Leaves) -> None:
    frond = (leaves.joints - 40) // 12
    assert len(np.unique(frond)) == (len(palm) - 40) // 12
    assert all(len(np.unique(leaves.tiles[frond == number])) == 1 for number in np.unique(frond))
    assert len(np.unique(leaves.tiles)) > 3


def test_pieces_are_small_at_both_ends_of_a_frond(leaves: Leaves) -> None:
    place, size = (leaves.joints - 40) % 12, np.linalg.norm(leaves.ups, axis=1)
    middle = np.median(size[(place > 2) & (place < 7)])
    assert np.median(size[place == 11]) < 0.75 * middle
    assert 0 < BARE_FOOT < HALF_SIDE < 0.25


def test_a_palm_bears_fronds_and_half_the_density_half_as_many(palm: Skeleton, crown, leaves: Leaves) -> None:
    half = place_leaves(palm, crown, LeafParams(0.5, kind="palm"), np.random.default_rng(0))
    assert len(half) == pytest.approx(len(leaves) / 2, rel=0.05)
