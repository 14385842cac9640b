import cv2
import numpy as np
import pytest
from tests.core.leaf.conftest import view_of

from treestroke.core.leaf.grid import foliage_grid
from treestroke.core.leaf.leaf_density import leaf_weights
from treestroke.core.skeleton.measure import edge_lengths

HEIGHT = 10.0


def borne(tree, photo, mask, volume, even=False) -> np.ndarray:
    """Leaves of each joint's edge."""
    grid = foliage_grid(view_of(photo, mask, volume.camera), volume.bounds.mean(axis=0))
    return leaf_weights(tree, [grid], volume, HEIGHT, even) * edge_lengths(tree)


def test_thick_wood_bears_nothing(tree, photo, mask, volume):
    leaves = borne(tree, photo, mask, volume)
    assert (leaves[tree.radii >= 0.1] == 0).all()
    assert (leaves >= 0).all()
    assert leaves.sum() > 0


def test_thin_foliage_bears_less_than_dense(tree, photo, mask, volume):
    sparse = mask.copy()
    sparse[:, :150] &= (np.indices(mask.shape).sum(axis=0) // 6 % 3 == 0)[:, :150]
    leaves, x = borne(tree, photo, sparse, volume), tree.points[:, 0]
    assert leaves[x < -0.5].sum() < 0.4 * leaves[x > 0.5].sum()


def test_crowded_branches_share_what_the_photo_shows(tree, photo, mask, volume):
    crowded = tree.points[:, 0] > 0
    crowded[:302] = False
    points = np.vstack([tree.points, tree.points[crowded] - np.array([0.0, 0.01, 0.0])])
    twice = type(tree)(
        points, np.append(tree.radii, tree.radii[crowded]), np.append(tree.parents, tree.parents[crowded])
    )
    leaves, x = borne(twice, photo, mask, volume), points[:, 0]
    assert leaves[x < 0].sum() == pytest.approx(leaves[x > 0].sum(), rel=0.25)


def test_an_even_crown_bears_at_its_narrow_top_more_than_its_area(tree, photo, mask, volume):
    high = tree.points[:, 1] > 8.5
    plain, even = (borne(tree, photo, mask, volume, even) for even in (False, True))
    assert even[high].sum() / even.sum() > 1.1 * plain[high].sum() / plain.sum()


def test_foliage_beside_all_branches_gives_no_weight_that_is_not_finite(tree, photo, volume):
    corner = cv2.rectangle(np.zeros(photo.shape[:2], np.uint8), (5, 5), (25, 25), 1, -1) > 0
    assert np.isfinite(borne(tree, photo, corner, volume)).all()
