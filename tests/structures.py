"""A structure that needs no photos: cameras on a ring around random points."""

from collections.abc import Sequence

import numpy as np

from treestroke.core.capture import PointCloud, SolvedPhoto, Structure, UnusedPhoto
from treestroke.core.geometry.camera import PerspectiveCamera


def small_structure(
    names: Sequence[str] = ("0.jpg", "1.jpg", "2.jpg"), unused: Sequence[str] = ("blurred.jpg",), points: int = 5
) -> Structure:
    """Give a structure of photos of these names, and of others that are not used."""
    rng = np.random.default_rng(1)
    photos = tuple(
        SolvedPhoto(name, _on_ring(2 * np.pi * index / len(names)), 0.01 * index) for index, name in enumerate(names)
    )
    cloud = PointCloud(
        rng.normal(size=(points, 3)),
        rng.integers(0, 256, (points, 3), dtype=np.uint8),
        rng.random((points, len(names))) < 0.7,
    )
    return Structure(photos, cloud, tuple(UnusedPhoto(name, "blurred", f"{name} is blurred") for name in unused))


def _on_ring(angle: float) -> PerspectiveCamera:
    """Give a camera that looks to the middle of a ring of radius 5, whose pictures are 64 by 48 px."""
    cos, sin = np.cos(angle), np.sin(angle)
    turn = np.array([[cos, 0.0, -sin], [0.0, -1.0, 0.0], [-sin, 0.0, -cos]])
    return PerspectiveCamera(64, 48, np.column_stack([turn, [0.0, 0.0, 5.0]]), 70.0 + angle, (32.0, 24.0))
