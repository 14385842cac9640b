"""Animated GIFs that tests write."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image


def write_gif(path: Path, frames: Sequence[NDArray[np.uint8]], times_ms: Sequence[int]) -> None:
    """Write frames (h, w, 3), BGR, each shown for its time, milliseconds."""
    first, *others = (Image.fromarray(frame[..., ::-1]) for frame in frames)
    first.save(path, save_all=True, append_images=others, duration=list(times_ms), loop=0)
