"""Photos that do not help to find where a capture's photos were taken, each with a sentence that names it."""

from collections.abc import Mapping, Sequence

import cv2
import numpy as np

from treestroke.core.capture import CapturedPhoto, UnusedPhoto
from treestroke.core.errors import CaptureError
from treestroke.core.types import Floats, Indices
from treestroke.engines.features import Features
from treestroke.engines.mapping import Pair
from treestroke.limits import MAX_PHOTOS, MIN_PHOTOS

_BLURRED = 0.5
"""Share of the median sharpness of a set below which a photo of it is blurred.

Photos of the tuning sets differ by 10 %; one blurred by 2 to 6 px of 1280 and saved as JPEG has 12 to 44 %."""
_ENOUGH_ALIKE = 3
"""Photos of one size, so of one camera, that tell how sharp it is."""
_SAME_SIDE = 48
_SAME_LEVELS = 4.0
"""Greatest mean difference of two thumbnails' levels that may be of one photo."""
_SAME_SHIFT = 0.001
"""Greatest median shift of the matches between two copies of a photo, over its longest side."""


def repeated(
    photos: Sequence[CapturedPhoto], features: Sequence[Features], matches: Mapping[Pair, Indices]
) -> dict[int, UnusedPhoto]:
    """Return the photos that show what an earlier one shows, pixel by pixel or nearly, by their indices."""
    thumbnails = [_thumbnail(photo) for photo in photos]
    places = [one.points_px / max(photo.picture.shape[:2]) for photo, one in zip(photos, features, strict=True)]
    found: dict[int, UnusedPhoto] = {}
    for (first, second), pairs in sorted(matches.items()):
        if (
            first in found
            or second in found
            or float(np.abs(thumbnails[first] - thumbnails[second]).mean()) > _SAME_LEVELS
        ):
            continue
        shift = places[first][pairs[:, 0]] - places[second][pairs[:, 1]]
        if len(shift) and np.median(np.linalg.norm(shift, axis=1)) < _SAME_SHIFT:
            name, other = photos[second].name, photos[first].name
            detail = f"{name} was taken from the same place as {other}: take a step to the side between photos"
            found[second] = UnusedPhoto(name, "same_photo", detail)
    return found


def _thumbnail(photo: CapturedPhoto) -> Floats:
    small = cv2.resize(photo.picture, (_SAME_SIDE, _SAME_SIDE), interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.float64)


def blurred(photos: Sequence[CapturedPhoto], features: Sequence[Features]) -> dict[int, UnusedPhoto]:
    """Return the photos that are far less sharp than the others of their camera, by their indices."""
    sharpness = np.array([one.sharpness for one in features])
    sizes = [tuple(sorted(photo.picture.shape[:2])) for photo in photos]
    found: dict[int, UnusedPhoto] = {}
    for index, photo in enumerate(photos):
        alike = [one == sizes[index] for one in sizes]
        usual = np.median(sharpness[alike] if sum(alike) >= _ENOUGH_ALIKE else sharpness)
        if sharpness[index] < _BLURRED * usual:
            detail = f"{photo.name} is blurred: take it again from the same place and hold still"
            found[index] = UnusedPhoto(photo.name, "blurred", detail)
    return found


def without_camera(name: str, group: Sequence[str]) -> UnusedPhoto:
    """Say why a photo has no camera; ``group`` are the other photos that it fits together with."""
    if group:
        detail = (
            f"{name} fits together with {listed(group)} but not with the photos that are used: take photos in between, "
            "or make a capture of its own of another tree"
        )
        return UnusedPhoto(name, "other_group", detail)
    detail = (
        f"{name} has too little in common with the other photos: take photos in between, or leave it out if it shows "
        "another place"
    )
    return UnusedPhoto(name, "no_overlap", detail)


def check_count(photos: Sequence[str], unused: Sequence[UnusedPhoto]) -> None:
    """Refuse too many photos, and fewer than 5, those left out not counted.

    Raises
    ------
    CaptureError
        There are more or fewer.
    """
    if len(photos) > MAX_PHOTOS:
        fault = f"there are {len(photos)} photos, at most {MAX_PHOTOS} are read; leave some out"
        raise CaptureError(fault, code="too_many_photos")
    left_out = {one.name for one in unused}
    used = [name for name in photos if name not in left_out]
    if len(used) >= MIN_PHOTOS:
        return
    why = "".join(f"; {one.detail}" for one in unused[:3])
    have = f"only {listed(used)}" if used else "none"
    need = f"at least {MIN_PHOTOS} photos from different places around the tree are needed"
    raise CaptureError(
        f"{need}, usable: {have}{why}; take more",
        code="too_few_photos",
    )


def no_parallax(names: Sequence[str]) -> CaptureError:
    """Return the error of photos that were taken from one place."""
    return CaptureError(
        f"{listed(names)} were taken from one place, only turned: walk around the tree, a few steps between photos",
        code="no_parallax",
    )


def too_little_overlap(names: Sequence[str], together: Sequence[str]) -> CaptureError:
    """Return the error of photos of which too few, ``together``, show the same things."""
    fit = (
        f"of {listed(names)}, only {listed(together)} fit together"
        if together
        else f"{listed(names)} do not fit together"
    )
    return CaptureError(
        f"{fit}: take a photo every 10 to 20 degrees around the tree, each showing most of what the last one showed",
        code="too_little_overlap",
    )


def listed(names: Sequence[str], most: int = 6) -> str:
    """Return file names as part of a sentence, a few of many."""
    if len(names) > most:
        return f"{', '.join(names[: most - 1])} and {len(names) - most + 1} more"
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
