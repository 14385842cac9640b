import numpy as np
import pytest

from treestroke.core.leaf.arrangement import Poses, seats_along
from treestroke.core.leaf.conifer_sprays import POSTURES, pose_conifer_sprays
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import FoliageKind

LIMB = Skeleton(np.array([[0.0, 5, 0], [4, 5, 0]]), np.array([0.1, 0.05]), np.array([-1, 0]))


def posed(kind: FoliageKind) -> Poses:
    """Sprays of half size 0.2 on a level limb that points to the right."""
    rng = np.random.default_rng(0)
    seats = seats_along(LIMB, np.ones(2), 500, rng)
    return pose_conifer_sprays(seats, np.full(500, 0.2), np.array([0.0, 4.0, 0.0]), POSTURES[kind], rng)


def faces(poses: Poses) -> np.ndarray:
    """How level the cards lie: the vertical part (n,) of their normals, 0 to 1."""
    normals = np.cross(poses.rights, poses.ups)
    return np.abs(normals[:, 1]) / np.linalg.norm(normals, axis=1)


def test_needles_lie_in_flat_layers_and_scales_stand() -> None:
    needles, scales = posed("needles"), posed("scales")
    assert np.median(faces(needles)) > 0.75
    assert np.median(faces(scales)) < 0.6
    assert np.abs(needles.ups[:, 1]).mean() < 0.06
    assert scales.ups[:, 1].mean() > 0.08


@pytest.mark.parametrize("kind", POSTURES)
def test_sprays_point_outward_along_their_limb_near_it(kind: FoliageKind) -> None:
    poses = posed(kind)
    assert (poses.ups[:, 0] > 0).mean() > 0.95
    np.testing.assert_allclose(np.linalg.norm(poses.ups, axis=1), 0.2)
    np.testing.assert_allclose((poses.ups * poses.rights).sum(axis=1), 0, atol=1e-12)
    assert np.hypot(poses.centres[:, 1] - 5, poses.centres[:, 2]).max() < 0.35
