"""What the pool's processes are told to do in its tests."""

import ctypes
import os
import time
from pathlib import Path

import cv2
import numpy as np

from treestroke.core.errors import PhotoError


def process() -> int:
    """Name the process."""
    return os.getpid()


def segfault() -> None:
    """Read where nothing is."""
    ctypes.string_at(0)


def leave() -> None:
    """End the process as a library that gives up does."""
    os._exit(3)


def hang() -> None:
    """Do nothing for longer than anybody waits."""
    time.sleep(60)


def wait_for_file(path: Path) -> int:
    """Wait until a file is there."""
    while not path.exists():
        time.sleep(0.01)
    return 1


def devour() -> int:
    """Ask for more memory than there may be."""
    return len(bytearray(8 * 2**30))


def devour_pixels() -> int:
    """Ask OpenCV for as much."""
    return int(cv2.resize(np.zeros((9, 9), np.uint8), (60_000, 60_000)).size)


def refuse() -> None:
    """Find fault with the input."""
    raise PhotoError("photo: no photo", pointer="/photo")
