import numpy as np
import pytest

from treestroke.core.segment.leaf_regions import leaf_regions

GREEN, YELLOW, DARK, BROWN = (80, 140, 60), (190, 170, 60), (30, 45, 30), (90, 70, 50)


@pytest.fixture(scope="module")
def leaves():
    """Dark foliage with ten green leaves and one long yellow one, of 12 by 6 px each."""
    picture = np.full((90, 120, 3), DARK, np.uint8)
    row, column = np.indices(picture.shape[:2])
    places = [(15 + 22 * (k % 5), 20 + 30 * (k // 5)) for k in range(10)]
    for x, y in places:
        picture[((column - x) / 7) ** 2 + ((row - y) / 4) ** 2 < 1] = GREEN
    picture[76:84, 30:90] = YELLOW
    foliage = np.ones(picture.shape[:2], bool)
    foliage[:5] = False
    return picture, foliage, np.array(places, dtype=float)


def region_at(regions, point):
    return regions.labels[int(point[1]), int(point[0])]


def test_each_leaf_is_a_region_with_its_ellipse(leaves):
    picture, foliage, places = leaves
    regions = leaf_regions(picture, foliage, 14.0)
    found = [region_at(regions, place) for place in places]
    assert len(set(found)) == 10
    assert np.abs(regions.centres_px[found] - places - 0.0).max() < 1.5
    assert regions.axes_px[found, 0] == pytest.approx(np.full(10, 7.0), abs=1.2)
    assert regions.axes_px[found, 1] == pytest.approx(np.full(10, 4.0), abs=1.2)
    assert np.abs(np.sin(regions.angles_rad[found])).max() < 0.2


def test_nothing_is_found_beside_the_foliage(leaves):
    picture, foliage, _ = leaves
    regions = leaf_regions(picture, foliage, 14.0)
    assert np.array_equal(regions.labels >= 0, foliage)
    assert regions.labels.max() == len(regions) - 1


def test_a_region_larger_than_a_leaf_is_split(leaves):
    picture, foliage, _ = leaves
    regions = leaf_regions(picture, foliage, 14.0)
    assert 3 <= len(np.unique(regions.labels[78:82, 32:88])) <= 12


def test_specks_join_what_surrounds_them(leaves):
    picture, foliage, places = leaves
    speckled = picture.copy()
    speckled[int(places[2][1]), int(places[2][0])] = BROWN
    regions = leaf_regions(speckled, foliage, 14.0)
    x, y = places[2].astype(int)
    assert region_at(regions, (x, y)) == region_at(regions, (x + 3, y))


def test_the_user_accepts_and_refuses_clusters_of_colour(leaves):
    picture, foliage, places = leaves
    refused = leaf_regions(picture, foliage, 14.0, refused_px=places[:1])
    assert not refused.leaves[region_at(refused, places[1])]
    accepted = leaf_regions(picture, foliage, 14.0, accepted_px=places[:1])
    assert accepted.leaves[region_at(accepted, places[1])]


def test_only_the_brightest_clusters_are_leaves():
    rng = np.random.default_rng(0)
    grey = np.kron(rng.integers(10, 240, (12, 12)), np.ones((10, 10), int)).astype(np.uint8)
    regions = leaf_regions(np.repeat(grey[..., None], 3, axis=2), np.ones(grey.shape, bool), 12.0)
    assert 0.2 < regions.leaves.mean() < 0.8
    assert regions.colours[regions.leaves, 0].min() > regions.colours[~regions.leaves, 0].max()


def test_a_photo_without_foliage_is_refused(leaves):
    with pytest.raises(ValueError, match="foliage"):
        leaf_regions(leaves[0], np.zeros(leaves[1].shape, bool), 14.0)
