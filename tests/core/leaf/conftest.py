"""A round green tree before a blue sky, seen in 300 x 400 px, 10 m high."""

import cv2
import numpy as np
import pytest

from treestroke.core.appearance import StemPixels, View
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import TurnedOutline, turned_outline
from treestroke.core.paint.atlas import Atlas, leaf_atlas
from treestroke.core.skeleton.skeleton import Skeleton

SKY, GREEN = (110, 160, 230), (70, 110, 40)


def view_of(
    photo: np.ndarray, mask: np.ndarray, camera: OrthographicCamera, leaves_from: np.ndarray | None = None
) -> View:
    """The view that shows foliage in a mask, and wood where ``leaves_from`` has a depth."""
    depth = np.where(mask, -np.inf, np.inf) if leaves_from is None else leaves_from
    return View(camera, photo, depth.astype(np.float32), mask, mask, StemPixels(np.zeros((2, 2)), np.zeros(2)))


@pytest.fixture(scope="session")
def mask() -> np.ndarray:
    disc = cv2.circle(np.zeros((400, 300), np.uint8), (150, 150), 120, 1, -1)
    return disc > 0


@pytest.fixture(scope="session")
def photo(mask: np.ndarray) -> np.ndarray:
    picture = np.where(mask[..., None], np.uint8(GREEN), np.uint8(SKY))
    noise = np.random.default_rng(1).normal(0, 14, mask.shape)[..., None]
    return np.clip(picture + noise, 0, 255).astype(np.uint8)


@pytest.fixture(scope="session")
def camera() -> OrthographicCamera:
    return OrthographicCamera(300, 400, 10 / 360, (150.0, 390.0))


@pytest.fixture(scope="session")
def volume(mask: np.ndarray, camera: OrthographicCamera) -> TurnedOutline:
    return turned_outline(Silhouette(mask, camera))


@pytest.fixture(scope="session")
def tree() -> Skeleton:
    """A stem to the crown's middle and 300 limbs from there through the whole ball, thin in their outer half."""
    rng, fork = np.random.default_rng(2), np.array([0.0, 6.65, 0.0])
    ends = rng.normal(size=(300, 3))
    ends *= 3.25 * rng.random((300, 1)) ** (1 / 3) / np.linalg.norm(ends, axis=1, keepdims=True)
    points = np.vstack([np.zeros(3), fork, fork + 0.6 * ends, fork + ends])
    radii = np.repeat([0.3, 0.2, 0.1, 0.01], [1, 1, 300, 300])
    return Skeleton(points, radii, np.concatenate([[-1, 0], np.full(300, 1), np.arange(2, 302)]))


@pytest.fixture(scope="session")
def atlas(photo: np.ndarray, mask: np.ndarray) -> Atlas:
    return leaf_atlas(photo, mask, "leaves", np.random.default_rng(0))
