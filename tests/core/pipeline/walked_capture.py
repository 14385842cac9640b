"""A walk around a small tree as a capture: leafy balls on a post, with the cameras that took its photos."""

from collections.abc import Sequence

import numpy as np
from tests.core.segment.walked_tree import BALLS, TRUNK_HALF, TRUNK_TOP

from treestroke.core.capture import PointCloud, Shot, SolvedPhoto, Structure, UnusedPhoto
from treestroke.core.geometry.similarity import Similarity

HEIGHT = max(middle[1] + radius for middle, radius in BALLS)
SOLVED = Similarity(np.array([1.0, 0.5, -2.0]), np.eye(3), 0.2)
"""From metres to the frame in which the cameras were found."""
SHAKEN = UnusedPhoto("shaken.jpg", "blurred", "shaken.jpg is blurred: take it again")


def structure_of(shots: Sequence[Shot]) -> Structure:
    """Return the true cameras, and points on leaves and bark, each seen from its side, and on the ground."""
    rng = np.random.default_rng(6)
    outward = rng.normal(size=(len(BALLS), 300, 3))
    outward /= np.linalg.norm(outward, axis=2, keepdims=True)
    leaves = [np.array(middle) + radius * out for (middle, radius), out in zip(BALLS, outward, strict=True)]
    angle, height = rng.uniform(0, 2 * np.pi, 300), rng.uniform(0, TRUNK_TOP - 0.8, 300)
    around = np.column_stack([np.sin(angle), 0 * angle, np.cos(angle)])
    bark = TRUNK_HALF * around + height[:, None] * [0.0, 1.0, 0.0]
    x, z = rng.uniform(-4, 4, (2, 300))
    points = np.concatenate([*leaves, bark, np.column_stack([x, 0 * x, z])])
    normals = np.concatenate([outward.reshape(-1, 3), around, np.tile([0.0, 1.0, 0.0], (300, 1))])
    seen = np.column_stack([((shot.camera.centre - points) * normals).sum(axis=1) > 0 for shot in shots])
    cloud = PointCloud(SOLVED.points(points), np.full((len(points), 3), 90, np.uint8), seen)
    solved = tuple(SolvedPhoto(shot.name, SOLVED.camera(shot.camera), 0.0) for shot in shots)
    return Structure(solved, cloud, (SHAKEN,))
