"""Changes of frame that keep shapes: a turn, a scale and a shift."""

from dataclasses import dataclass, replace

import numpy as np

from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.types import Floats


@dataclass(frozen=True, eq=False)
class Similarity:
    """A change of frame: a point p becomes ``scale * turn @ (p - origin)``.

    Attributes
    ----------
    origin
        (3,) the point of the old frame that becomes the new origin.
    turn
        (3, 3) rotation.
    scale
        Lengths of the new frame over those of the old one.
    """

    origin: Floats
    turn: Floats
    scale: float

    def __post_init__(self) -> None:
        if not np.allclose(self.turn @ self.turn.T, np.eye(3), atol=1e-6) or not self.scale > 0:
            raise ValueError(f"a change of frame needs a rotation and a positive scale, got {self}")

    def points(self, points: Floats) -> Floats:
        """Carry points (n, 3) of the old frame into the new one."""
        return np.asarray(self.scale * (points - self.origin) @ self.turn.T)

    def camera(self, camera: PerspectiveCamera) -> PerspectiveCamera:
        """Return the same camera in the new frame: its picture shows the same."""
        turn, shift = camera.camera_from_world[:, :3], camera.camera_from_world[:, 3]
        moved = np.column_stack([turn @ self.turn.T, self.scale * (turn @ self.origin + shift)])
        return replace(camera, camera_from_world=moved)
