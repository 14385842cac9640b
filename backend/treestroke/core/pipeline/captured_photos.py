"""Photos of a capture at the size that they are solved, modelled or traced at, and their cameras at that size."""

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np

from treestroke.core.capture import CapturedPhoto, SolvedPhoto, Structure
from treestroke.core.errors import CaptureError
from treestroke.core.types import Picture

CAPTURED_SIDE = 1280
"""Longest side, px, at which a capture's photos are solved and modelled."""

TRACED_SIDE = 640
"""Longest side, px, at which they are traced: soon, and as well (an oak that was read so scored as at 1280 px)."""
_ROUNDED_PX = 2.0
"""Most px by which the height of a picture may differ from that of its camera, after rounding."""


def captured_photo(name: str, photo: Picture, focal_px: float | None) -> CapturedPhoto:
    """Reduce an upright photo (h, w, 3), sRGB, where it is large.

    ``focal_px`` is its lens's focal length, px of the photo, where that is known.
    """
    return reduced(CapturedPhoto(name, photo, focal_px), CAPTURED_SIDE)


def reduced(photo: CapturedPhoto, side: int) -> CapturedPhoto:
    """Return a captured photo whose picture's longest side has at most ``side`` px."""
    height, width = photo.picture.shape[:2]
    scale = min(1.0, side / max(width, height))
    if scale == 1:
        return photo
    size = max(1, round(width * scale)), max(1, round(height * scale))
    picture = np.asarray(cv2.resize(photo.picture, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
    focal_px = None if photo.focal_px is None else photo.focal_px * size[0] / width
    return CapturedPhoto(photo.name, picture, focal_px, photo.size_px)


def fitted(structure: Structure, photos: Sequence[CapturedPhoto]) -> Structure:
    """Return a structure with its cameras at the sizes of the captured pictures.

    Raises
    ------
    CaptureError
        It is of no photo, of one that is not there, or of one of another shape.
    """
    by_name = {photo.name: photo for photo in photos}
    if not structure.photos:
        raise _of_others("it has no photo")
    return replace(structure, photos=tuple(_fitted(solved, by_name.get(solved.name)) for solved in structure.photos))


def _fitted(solved: SolvedPhoto, photo: CapturedPhoto | None) -> SolvedPhoto:
    camera = solved.camera
    if photo is None:
        raise _of_others(f"it names {solved.name}, which is not among the photos")
    height, width = photo.picture.shape[:2]
    if (width, height) == (camera.width, camera.height):
        return solved
    if abs(height - camera.height * width / camera.width) > _ROUNDED_PX:
        raise _of_others(f"its {solved.name} has another shape than the photo")
    return replace(solved, camera=camera.resized(width, height))


def _of_others(fault: str) -> CaptureError:
    mend = "put back the photos that it was found from, or leave it out, and cameras are found anew"
    return CaptureError.at(("structure",), f"{fault}; {mend}", "structure_of_other_photos")
