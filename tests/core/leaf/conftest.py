"""The round tree of `tests/core/conftest.py` as a tree 10 m high."""

import numpy as np
import pytest

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.envelope import Envelope, envelope_of_mask
from treestroke.core.skeleton.skeleton import Skeleton


@pytest.fixture(scope="session")
def camera() -> Camera:
    return Camera(300, 400, 10 / 360, (150.0, 390.0))


@pytest.fixture(scope="session")
def envelope(mask: np.ndarray, camera: Camera) -> Envelope:
    return envelope_of_mask(mask, camera)


@pytest.fixture(scope="session")
def tree() -> Skeleton:
    """A stem to the crown's middle and 300 limbs from there through the whole ball, thin in their outer half."""
    rng, fork = np.random.default_rng(2), np.array([0.0, 6.65, 0.0])
    ends = rng.normal(size=(300, 3))
    ends *= 3.25 * rng.random((300, 1)) ** (1 / 3) / np.linalg.norm(ends, axis=1, keepdims=True)
    points = np.vstack([np.zeros(3), fork, fork + 0.6 * ends, fork + ends])
    radii = np.repeat([0.3, 0.2, 0.1, 0.01], [1, 1, 300, 300])
    return Skeleton(points, radii, np.concatenate([[-1, 0], np.full(300, 1), np.arange(2, 302)]))
