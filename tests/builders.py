"""Small trees by hand, in metres: upright along +Y with the root at the origin."""

import numpy as np

from treestroke.core.skeleton.skeleton import Skeleton


def stick(joints: int = 5, height: float = 4.0, radius: float = 0.1, tip_radius: float = 0.05) -> Skeleton:
    """Build a straight trunk."""
    up = np.linspace(0.0, height, joints)
    points = np.stack([np.zeros(joints), up, np.zeros(joints)], axis=1)
    return Skeleton(points, np.linspace(radius, tip_radius, joints), np.arange(joints) - 1)


def fork(angle_rad: float = 0.7, trunk_radius: float = 0.2, child_radius: float = 0.12) -> Skeleton:
    """Build a trunk of 2 m that forks into a limb going on (joints 3, 4) and a thinner one aside (joints 5, 6)."""
    aside = np.array([np.sin(angle_rad), np.cos(angle_rad), 0.0])
    end = np.array([0.0, 2.0, 0.0])
    points = [[0, 0, 0], [0, 1, 0], end, [0, 2.8, 0], [0, 3.6, 0], end + 0.8 * aside, end + 1.6 * aside]
    keeps, thins = 0.85 * trunk_radius, child_radius
    radii = [trunk_radius, trunk_radius, trunk_radius, keeps, 0.5 * keeps, thins, 0.5 * thins]
    return Skeleton(np.array(points, dtype=np.float64), np.array(radii), np.array([-1, 0, 1, 2, 3, 2, 5]))


def oak(orders: int = 4, seed: int = 0) -> Skeleton:
    """Build a regular small tree, 3 joints a limb: each limb bears 3 others, down to ``orders`` (121 joints for 4)."""
    rng = np.random.default_rng(seed)
    points, radii, parents = [np.zeros(3)], [0.25], [-1]

    def grow(parent: int, direction: np.ndarray, length: float, radius: float, order: int) -> None:
        for _ in range(3):
            points.append(points[parent] + direction * length / 3)
            radii.append(radius)
            parents.append(parent)
            parent = len(points) - 1
        for _ in range(3 if order > 1 else 0):
            turned = direction + rng.normal(0.0, 0.6, 3)
            grow(parent, turned / np.linalg.norm(turned), 0.7 * length, 0.6 * radius, order - 1)

    grow(0, np.array([0.0, 1.0, 0.0]), 2.5, 0.22, orders)
    return Skeleton(np.array(points), np.array(radii), np.array(parents))
