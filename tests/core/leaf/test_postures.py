import numpy as np
import pytest

from treestroke.core.geometry.vectors import unit
from treestroke.core.leaf.arrangement import Poses, seats_along
from treestroke.core.leaf.postures import BOUGH, BRUSH, HANGING, PAD, PLUME, Posture, pose_by_posture, posture_of
from treestroke.core.skeleton.skeleton import Skeleton

LIMB = Skeleton(np.array([[0.0, 5, 0], [4, 5, 0]]), np.array([0.1, 0.05]), np.array([-1, 0]))


def posed(posture: Posture) -> Poses:
    """Sprays of half size 0.2 on a level limb that points to the right."""
    rng = np.random.default_rng(0)
    seats = seats_along(LIMB, np.ones(2), 500, rng)
    return pose_by_posture(seats, np.full(500, 0.2), np.array([0.0, 4.0, 0.0]), posture, rng)


def faces(poses: Poses) -> np.ndarray:
    """How level the cards lie: the vertical part (n,) of their normals, 0 to 1."""
    normals = np.cross(poses.rights, poses.ups)
    return np.abs(normals[:, 1]) / np.linalg.norm(normals, axis=1)


def test_short_needles_lie_in_flat_layers_and_scales_stand() -> None:
    boughs, plumes = posed(BOUGH), posed(PLUME)
    assert np.median(faces(boughs)) > 0.65  # twigs hang from a bough too: seen from the side, flat ones are gaps
    assert np.median(faces(plumes)) < 0.6
    assert boughs.ups[:, 1].mean() < -0.02
    assert np.median(np.abs(unit(boughs.ups)[:, 1])) < 0.5
    assert plumes.ups[:, 1].mean() > 0.08


def test_hanging_sprays_are_long_and_point_down() -> None:
    hanging = posed(HANGING)
    lengths, widths = (np.linalg.norm(half, axis=1) for half in (hanging.ups, hanging.rights))
    assert (hanging.ups[:, 1] < -0.7 * lengths).mean() > 0.95
    np.testing.assert_allclose(lengths * widths, 0.2**2)
    assert (lengths > 4 * widths).all()


def test_a_pad_is_broader_than_high() -> None:
    offsets = np.std(posed(PAD).centres, axis=0)
    assert offsets[2] > 1.5 * offsets[1]


def test_a_form_has_its_own_posture_and_broad_leaves_have_none() -> None:
    assert posture_of("needles", "spire") == BOUGH
    assert posture_of("needles", "umbrella") == BRUSH
    assert posture_of("scales", "spire") == PLUME
    assert posture_of("scales", "round") == PAD
    assert posture_of("leaves", "weeping") == HANGING
    assert posture_of("leaves", "round") is None


@pytest.mark.parametrize("posture", [BOUGH, BRUSH, PLUME])
def test_sprays_point_outward_along_their_limb_near_it(posture: Posture) -> None:
    poses = posed(posture)
    assert (poses.ups[:, 0] > 0).mean() > 0.95
    np.testing.assert_allclose(np.linalg.norm(poses.ups, axis=1), 0.2 * np.sqrt(posture.slimness))
    np.testing.assert_allclose((poses.ups * poses.rights).sum(axis=1), 0, atol=1e-12)
    assert np.hypot(poses.centres[:, 1] - 5, poses.centres[:, 2]).max() < 0.35 * np.sqrt(posture.slimness)
