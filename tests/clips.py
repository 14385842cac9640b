"""Small clips that tests film themselves: blobs that sway before a light sky, as a tree's crown does."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

Frame = NDArray[np.uint8]
SYNTHETIC_ASH = Path(__file__).parent / "data" / "synthetic_ash.mp4"
STROKES: dict[str, Any] = {
    "crown": {"points": [[60, 20], [110, 30], [125, 70], [95, 100], [55, 100], [35, 65]]},
    "branches": [{"points": [[80, 118], [80, 90], [80, 60]]}],
}
"""Strokes over any frame of `swaying`."""


def swaying(count: int = 45, size: tuple[int, int] = (160, 120), rate: float = 30.0, px: float = 5.0) -> list[Frame]:
    """Return frames (h, w, 3), BGR, of a crown that sways ``px`` to both sides once a second."""
    width, height = size
    rng = np.random.default_rng(3)
    blobs = [(rng.uniform(0.3, 0.7), rng.uniform(0.2, 0.75), rng.uniform(0.02, 0.07)) for _ in range(60)]
    frames = []
    for number in range(count):
        frame = np.full((height, width, 3), (235, 215, 190), dtype=np.uint8)
        cv2.line(frame, (width // 2, height - 2), (width // 2, height // 2), (50, 70, 90), max(width // 32, 1))
        for index, (x, y, radius) in enumerate(blobs):
            away = px * np.sin(2 * np.pi * number / rate + index) * (1 - y)
            at = round(x * width + away), round(y * height)
            cv2.circle(frame, at, round(radius * width), (40, 90 + index, 60), -1, cv2.LINE_AA)
        frames.append(frame)
    return frames


def film(path: Path, frames: Iterable[Frame], rate: float = 30.0, codec: str = "MJPG") -> Path:
    """Write frames to a file, an AVI by its ending or an MP4 with codec ``mp4v``."""
    writer = None
    for frame in frames:
        if writer is None:
            fourcc = cv2.VideoWriter.fourcc(*codec)
            writer = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, fourcc, rate, (frame.shape[1], frame.shape[0]))
            assert writer.isOpened()
        writer.write(frame)
    assert writer is not None
    writer.release()
    return path


def clip_bytes(folder: Path, **options: Any) -> bytes:
    """Return the bytes of an AVI of `swaying`."""
    return film(folder / "swaying.avi", swaying(**options)).read_bytes()
