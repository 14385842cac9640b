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

    @property
    def matrix(self) -> Floats:
        """(3, 4) what carries a point of the old frame, followed by a 1, into the new one."""
        turned = self.scale * self.turn
        return np.column_stack([turned, -turned @ self.origin])

    @property
    def inverse(self) -> "Similarity":
        """The way back: from the new frame to the old one."""
        return Similarity(-self.scale * self.turn @ self.origin, self.turn.T, 1 / self.scale)

    def then(self, other: "Similarity") -> "Similarity":
        """Return this change followed by another one."""
        origin = self.origin + self.turn.T @ other.origin / self.scale
        return Similarity(origin, other.turn @ self.turn, self.scale * other.scale)

    def camera(self, camera: PerspectiveCamera) -> PerspectiveCamera:
        """Return the same camera in the new frame: its picture shows the same."""
        turn, shift = camera.camera_from_world[:, :3], camera.camera_from_world[:, 3]
        moved = np.column_stack([turn @ self.turn.T, self.scale * (turn @ self.origin + shift)])
        return replace(camera, camera_from_world=moved)
