"""A video of one tree, decoded: its frames at an even rate, and the frame that is drawn on."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.strokes import StrokeWarning
from treestroke.core.types import Picture


@dataclass(frozen=True, eq=False)
class Video:
    """The frames of one tree that moves, without cuts between them.

    Attributes
    ----------
    frames
        (f, h, w) uint8 grey, at most 640 px a side.
    frames_per_second
        The even rate of the frames.
    chosen
        Index of the frame that strokes are drawn on.
    picture
        (H, W, 3) uint8 sRGB, the chosen frame at its own size, at most 4096 px a side.
    notes
        What was left out or changed when the file was read.
    """

    frames: NDArray[np.uint8]
    frames_per_second: float
    chosen: int
    picture: Picture
    notes: tuple[StrokeWarning, ...]

    @property
    def enlarged(self) -> float:
        """Pixels of the picture for each pixel of the frames."""
        return float(self.picture.shape[1] / self.frames.shape[2])
