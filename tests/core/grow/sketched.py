"""Small 3D trees as two sketches give them, and crowns that both sides bound."""

import numpy as np

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import TurnedOutline, TwoOutlines, turned_outline
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.skeleton import Skeleton

CAMERA = OrthographicCamera(320, 480, 0.02, (160.0, 460.0))
FROM_LEFT = OrthographicCamera(320, 480, 0.02, (160.0, 460.0), from_left=True)


def oval(across: float, up: float, middle_x: float = 160.0) -> np.ndarray:
    """An oval of so many px about row 180 (5.6 m up)."""
    rows, columns = np.mgrid[0:480, 0:320] + 0.5
    return ((columns - middle_x) / across) ** 2 + ((rows - 180) / up) ** 2 <= 1


def crown(side: float = 75.0, off: float = 0.0) -> TwoOutlines:
    """A crown 3.6 m wide, 4.6 m high and 3 m deep about a middle that lies ``off`` px before the root."""
    front, left = oval(90, 115), oval(side, 115, 160 + off)
    return turned_outline(Silhouette(front, CAMERA)).with_side(Silhouette(left, FROM_LEFT))


def everywhere() -> TurnedOutline:
    """A crown that cuts nothing of the tree below: a box of 32 m by 40 m."""
    wide = OrthographicCamera(800, 1000, 0.04, (400.0, 800.0))
    return turned_outline(Silhouette(np.ones((1000, 800), dtype=bool), wide))


def tree(radius: float = 0.0, limbs: int = 8) -> Branched:
    """A trunk of 7 m with straight limbs of 1.5 m all around from 3.5 m on, joints 0.1 m apart."""
    points, parents, branch = [np.array([0.0, 0.1 * k, 0.0]) for k in range(71)], list(range(-1, 70)), [0] * 71
    for limb in range(limbs):
        bud, turn = 35 + 4 * limb, 2.4 * limb
        step = 0.1 * np.array([0.8 * np.cos(turn), 0.6, 0.6 * np.sin(turn)])
        for k in range(15):
            parents.append(bud if k == 0 else len(points) - 1)
            points.append(points[parents[-1]] + step)
            branch.append(limb + 1)
    return Branched(Skeleton(np.array(points), np.full(len(points), radius), np.array(parents)), np.array(branch))
