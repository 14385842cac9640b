import io
import math

import numpy as np
import pytest
from PIL import Image, TiffImagePlugin
from tests.api.corpora import saved

from treestroke.codec.exif import exif_focal_px

FILM = 0xA405


def photo(kind: str, entries: dict[int, object], size: tuple[int, int] = (96, 64)) -> bytes:
    """Save a photo whose camera wrote these EXIF entries."""
    exif = Image.Exif()
    exif[0x0110] = "a camera"
    exif.get_ifd(0x8769).update(entries)
    picture = Image.fromarray(np.zeros((size[1], size[0], 3), np.uint8))
    if kind == "HEIF":
        return saved(picture, kind, exif=exif.tobytes())
    out = io.BytesIO()
    picture.save(out, kind, exif=exif)
    return out.getvalue()


@pytest.mark.parametrize("kind", ["JPEG", "PNG", "WEBP", "HEIF"])
def test_the_length_on_film_is_read_whatever_the_format(kind: str) -> None:
    assert exif_focal_px(photo(kind, {FILM: 36})) == pytest.approx(96.0)  # three to two as film: its 36 mm are 96 px


def test_frames_of_other_shapes_are_compared_by_their_diagonals() -> None:
    assert exif_focal_px(photo("JPEG", {FILM: 26}, (80, 60))) == pytest.approx(100 * 26 / math.hypot(36, 24))
    assert exif_focal_px(photo("JPEG", {FILM: 26}, (60, 80))) == exif_focal_px(photo("JPEG", {FILM: 26}, (80, 60)))


@pytest.mark.parametrize(
    "entries",
    [{}, {FILM: 0}, {0x920A: TiffImagePlugin.IFDRational(50, 1)}, {FILM: "wide"}, {FILM: 65535}],
    ids=["none", "unknown", "of the lens alone", "a word", "beyond any lens"],
)
def test_without_a_usable_length_there_is_none(entries: dict[int, object]) -> None:
    assert exif_focal_px(photo("JPEG", entries)) is None


def test_what_is_no_photo_or_has_broken_exif_has_none() -> None:
    assert exif_focal_px(b"no photo") is None
    whole = photo("JPEG", {FILM: 36})
    assert exif_focal_px(whole.replace(b"MM\0*", b"MM\xff*", 1).replace(b"II*\0", b"II*\xff", 1)) is None
    assert exif_focal_px(whole[:100]) is None
