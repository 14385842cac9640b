import numpy as np
import pycolmap
import pytest
from tests.engines.rendered_set import photos_of, ring

from treestroke.engines.contradictions import contradicts, without_weak
from treestroke.engines.features import find_features
from treestroke.engines.mapping import Matched, cache_of, cameras_of, reconstruct, verified, view_of
from treestroke.engines.matching import match_descriptors


@pytest.fixture(scope="module")
def matched() -> Matched:
    photos = photos_of(ring(4, 36.0))
    features = [find_features(photo.picture) for photo in photos]
    views = [view_of(*pair) for pair in zip(photos, features, strict=True)]
    cameras, pairs = cameras_of(views), {}
    for pair in [(0, 1), (1, 2), (2, 3), (0, 2), (1, 3)]:
        found = match_descriptors(*(features[index].descriptors for index in pair))
        geometry = verified(views, cameras, pair, found)
        assert geometry is not None
        pairs[pair] = geometry
    return Matched(photos, features, views, cameras, pairs)


def test_a_photo_elsewhere_than_its_matches_say_is_noticed(matched: Matched) -> None:
    model = reconstruct(cache_of(matched.views, matched.cameras, matched.pairs), lambda: None)[0]
    assert model.num_reg_images() == 4
    assert not contradicts(model, matched)
    other = model.image(2).cam_from_world()
    aside = pycolmap.Rigid3d(other.rotation, other.translation + np.array([0.0, 3.0, 0.0]))
    model.image(1).frame.rig_from_world = aside
    assert contradicts(model, matched)


def test_pairs_with_next_to_no_matches_are_left_out() -> None:
    def pair(count: int) -> pycolmap.TwoViewGeometry:
        geometry = pycolmap.TwoViewGeometry()
        geometry.inlier_matches = np.zeros((count, 2), np.uint32)
        return geometry

    pairs = {(0, 1): pair(900), (1, 2): pair(40), (2, 3): pair(700), (3, 4): pair(60)}
    assert list(without_weak(pairs)) == [(0, 1), (2, 3), (3, 4)]
