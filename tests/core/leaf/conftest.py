"""The round tree of `tests/core/conftest.py` as a tree 10 m high."""

import numpy as np
import pytest

from treestroke.core.appearance import StemPixels, View
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import TurnedOutline, turned_outline
from treestroke.core.skeleton.skeleton import Skeleton


def view_of(
    photo: np.ndarray, mask: np.ndarray, camera: OrthographicCamera, leaves_from: np.ndarray | None = None
) -> View:
    """The view that shows foliage in a mask, and wood where ``leaves_from`` has a depth."""
    depth = np.where(mask, -np.inf, np.inf) if leaves_from is None else leaves_from
    stem = StemPixels(np.zeros((2, 2)), np.zeros(2))
    return View(camera, photo, depth.astype(np.float32), mask.astype(np.float32), mask, mask, stem)


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
