"""What a photo's camera wrote beside its pixels."""

import warnings

from treestroke.codec.focal_length import focal_px
from treestroke.codec.image import UNREADABLE, opened
from treestroke.codec.photo_kinds import kind_of
from treestroke.core.errors import PhotoError

_CAMERA, _FOCAL_ON_FILM = 0x8769, 0xA405
"""EXIF tags: the camera's own entries, and among these FocalLengthIn35mmFilm."""


def exif_focal_px(data: bytes) -> float | None:
    """Return the focal length, px, that a photo's EXIF tells; None where it tells none that can be used.

    The lens's own focal length, which EXIF has more often, says nothing without the size of the sensor.
    """
    kind = kind_of(data)
    if kind is None:
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            image = opened(data, kind, "photo")
            return focal_px(image.size, float(image.getexif().get_ifd(_CAMERA).get(_FOCAL_ON_FILM, 0)))
        except (*UNREADABLE, PhotoError):
            return None
